//! Derivatives of the outputs against differences of the outputs.

use grouser_fmu::{INPUTS, Model, OUTPUTS};
use grouser_terra::{GrouserRule, Grousers, RigidWheel, SolveStatus, catalogue};

fn model(soil: &str, lugs: bool) -> Model {
    let soil = catalogue::find(soil).unwrap().soil().unwrap();
    let soil = soil.with_rebound(0.1).unwrap();
    let mut wheel = RigidWheel::new(0.125, 0.1).unwrap();
    if lugs {
        let rule = GrouserRule::Lugs {
            count: 24.0,
            thickness: 0.002,
        };
        let height = 0.01;
        wheel = wheel.with_grousers(Grousers { height, rule }).unwrap();
    }
    Model::new(wheel, soil, [80.0, 0.2, 0.0]).unwrap()
}

#[test]
fn derivatives_are_the_slopes_of_the_outputs() {
    let steps = [1e-3, 1e-6, 1e-4];
    let mut checked = 0;
    for (soil, lugs) in [("dry-sand", false), ("lunar", true), ("sandy-loam", false)] {
        let model = model(soil, lugs);
        for load in [20.0, 80.0] {
            for slip in [-0.3, 0.05, 0.2, 0.7] {
                for degrees in [-30.0, -5.0, 0.0, 12.0] {
                    let inputs = [load, slip, degrees];
                    let Some(rows) = model.derivatives(&inputs) else {
                        continue;
                    };
                    let scale = [0.01, load, load, load * 0.125];
                    for input in 0..INPUTS {
                        let at = |sign: f64| {
                            let mut moved = inputs;
                            moved[input] += sign * steps[input];
                            model.outputs(&moved)
                        };
                        let (ahead, behind) = (at(1.0), at(-1.0));
                        assert_eq!(ahead.status, SolveStatus::Solved);
                        for output in 0..OUTPUTS {
                            let slope = (ahead.numbers[output] - behind.numbers[output])
                                / (2.0 * steps[input]);
                            let off = (rows[output][input] - slope).abs();
                            // forces to 1e-9 of the load over a step, and the difference's own error
                            let rounding = 1e-9 * scale[output] / steps[input];
                            let allowed = 3.0 * rounding + 2e-4 * slope.abs();
                            assert!(
                                off <= allowed,
                                "{soil} {inputs:?}: d{output}/d{input} is {}, but {slope}",
                                rows[output][input]
                            );
                            checked += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(checked > 700, "{checked}");
}

#[test]
fn where_there_is_no_solution_there_are_no_numbers() {
    let model = model("dry-sand", false);
    for inputs in [[1e9, 0.2, 0.0], [80.0, 1.5, 0.0], [80.0, 0.2, 90.0]] {
        let outputs = model.outputs(&inputs);
        assert_ne!(outputs.status, SolveStatus::Solved);
        assert!(outputs.numbers.iter().all(|number| number.is_nan()));
        assert!(model.derivatives(&inputs).is_none());
    }
    // a load of 0 has outputs without derivatives
    assert_eq!(model.outputs(&[0.0, 0.2, 0.0]).status, SolveStatus::Solved);
    assert!(model.derivatives(&[0.0, 0.2, 0.0]).is_none());
}
