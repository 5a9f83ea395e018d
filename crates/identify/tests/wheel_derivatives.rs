//! Derivatives of the wheel's residuals against difference quotients, in all parameters at once: more than one run has directions.

use grouser_identify::Parameter;
use grouser_identify::wheel::{Fixed, Scatter, Support, WheelModel, WheelTest};
use grouser_opt::{Jacobian, Model};
use grouser_terra::{Angle, Kinematics, OpenSoil, RigidWheel, ShearLaw, Slip, catalogue};

#[test]
fn derivatives_in_many_parameters_are_those_of_the_values() {
    let sand = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let mut soil = OpenSoil::from(*sand.params());
    soil.laws.shear = Some(ShearLaw::Independent);
    let fixed = Fixed {
        wheel: RigidWheel::new(0.125, 0.1).unwrap(),
        soil,
        scatter: Scatter::default(),
    };
    let tests: Vec<WheelTest> = [(-0.2, 10.0), (0.1, -5.0), (0.4, -20.0), (0.1, 75.0)]
        .into_iter()
        .map(|(slip, degrees)| WheelTest {
            kinematics: Kinematics::with_slip_angle(
                Slip::new(slip).unwrap(),
                Angle::from_deg(degrees),
            )
            .unwrap(),
            support: Support::Load(60.0),
            pull: Some(1.0),
            side: Some(2.0),
            torque: Some(0.5),
            sinkage: Some(0.01),
        })
        .collect();
    let parameters: Vec<Parameter> = Parameter::all().collect();
    assert!(parameters.len() > 9);
    let x: Vec<f64> = parameters.iter().map(|p| p.bounded(&soil).start).collect();
    let model = WheelModel::new(fixed, &tests, &parameters);
    let rows = model.count();
    let (mut values, mut jacobian) = (vec![0.0; rows], Jacobian::zeros(rows, x.len()));
    model.derivatives(&x, &mut values, &mut jacobian);
    let (mut above, mut below) = (vec![0.0; rows], vec![0.0; rows]);
    for (column, parameter) in parameters.iter().enumerate() {
        let step = 1e-5 * x[column].abs().max(1e-3);
        let moved = |by: f64| {
            let mut moved = x.clone();
            moved[column] += by;
            moved
        };
        model.values(&moved(step), &mut above);
        model.values(&moved(-step), &mut below);
        for row in 0..rows {
            let quotient = (above[row] - below[row]) / (2.0 * step);
            let exact = jacobian.row(row)[column];
            let off = (exact - quotient).abs();
            assert!(
                off <= 1e-4 * exact.abs() + 1e-9 / step,
                "{} row {row}: {exact:e} {quotient:e}",
                parameter.key()
            );
        }
    }
}
