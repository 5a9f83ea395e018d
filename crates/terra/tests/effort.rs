//! How much work a solve takes, without a clock: a change here is a change of the algorithm.

use grouser_terra::{
    Kinematics, LoadOutcome, RigidWheel, Settings, Slip, SoilParams, WheelOnSoil, catalogue,
};

use super::simulation_accuracy::Random;

/// Cases and evaluations in all: of the search itself, and where eleven samples guard it.
const PLAIN: (usize, u32) = (22, 96);
const GUARDED: (usize, u32) = (8, 61);

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
    // otherwise eleven rough samples guard against a lower branch
    let guarded: Vec<u32> = all
        .iter()
        .filter(|(rebound, slip, _)| *rebound != 0.0 || *slip < 0.0)
        .map(|c| c.2)
        .collect();
    assert_eq!((plain.len(), plain.iter().sum::<u32>()), PLAIN);
    assert_eq!((guarded.len(), guarded.iter().sum::<u32>()), GUARDED);
    assert!(plain.iter().all(|n| (2..=6).contains(n)), "{plain:?}");
}

/// Random wheels, slips and loads on the soils of the catalogue: searches that found a sinkage, those that found none, evaluations,
/// and searches that found several sinkages.
#[test]
fn what_random_searches_take() {
    /// Of driven wheels, of wheels on soil that springs back, and of braked ones.
    const WORK: [[u32; 4]; 3] = [[88, 12, 394, 0], [87, 13, 889, 0], [85, 15, 869, 0]];
    let mut random = Random(7);
    let mut work = [[0; 4]; 3];
    for i in 0..300 {
        let key = ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"][i % 5];
        let kind = i / 5 % 3;
        let radius = random.log(0.03, 0.6);
        let wheel = RigidWheel::new(radius, radius * random.between(0.2, 1.0)).unwrap();
        let rebound = random.between(0.05, 1.5) * f64::from(u8::from(kind == 1));
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let soil = soil.with_rebound(rebound).unwrap();
        let SoilParams { n, .. } = *soil.params();
        let slip = random.between(0.0, 0.9) * if kind == 2 { -1.0 } else { 1.0 };
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let depth = radius * random.log(1e-4, 1.2);
        let load = 3e5 * radius * radius * (depth / radius).powf(n + 0.5);
        let solution = on_soil.sinkage_under(load, &motion).unwrap();
        let [found, none, evaluations, several] = &mut work[kind];
        *evaluations += solution.evaluations;
        match solution.outcome {
            LoadOutcome::Solved(sinkage) => {
                *found += 1;
                *several += u32::from(sinkage.several);
            }
            _ => *none += 1,
        }
    }
    assert_eq!(work, WORK);
}
