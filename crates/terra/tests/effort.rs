//! How much work a solve takes, without a clock: a change here is a change of the algorithm.

use grouser_terra::{Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};

/// Cases and evaluations in all: of the search itself, and where eleven samples guard it.
const PLAIN: (usize, u32) = (22, 96);
const GUARDED: (usize, u32) = (8, 123);

/// Evaluations of the stress integrals for each sinkage case of the reference table.
fn evaluations() -> Vec<(f64, f64, u32)> {
    include_str!("oracle/wheel_cases.csv")
        .lines()
        .filter(|line| line.starts_with("sinkage"))
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |i: usize| cells[i].parse::<f64>().unwrap();
            let soil = catalogue::find(cells[1]).unwrap().soil().unwrap();
            let soil = soil.with_rebound(number(4)).unwrap();
            let wheel = RigidWheel::new(number(2), number(3)).unwrap();
            let contact = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
            let motion = Kinematics::straight(Slip::new(number(5)).unwrap());
            (
                number(4),
                number(5),
                contact
                    .sinkage_under(number(7), &motion)
                    .unwrap()
                    .evaluations,
            )
        })
        .collect()
}

#[test]
fn the_search_takes_four_to_six_evaluations() {
    let all = evaluations();
    // driving on soil that does not rise: the search itself
    let plain: Vec<u32> = all
        .iter()
        .filter(|(rebound, slip, _)| *rebound == 0.0 && *slip >= 0.0)
        .map(|c| c.2)
        .collect();
    // otherwise eleven samples guard against a lower branch
    let guarded: Vec<u32> = all
        .iter()
        .filter(|(rebound, slip, _)| *rebound != 0.0 || *slip < 0.0)
        .map(|c| c.2)
        .collect();
    assert_eq!((plain.len(), plain.iter().sum::<u32>()), PLAIN);
    assert_eq!((guarded.len(), guarded.iter().sum::<u32>()), GUARDED);
    assert!(plain.iter().all(|n| (2..=6).contains(n)), "{plain:?}");
}
