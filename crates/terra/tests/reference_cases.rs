//! Every law together against 30-digit quadrature of the same formulas (`oracle/wheel_cases.csv`: split
//! at θ_m and at every sign change of j, checked against a second implementation to 1e-16).

use grouser_terra::{Accuracy, Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};

struct Case {
    solve: bool,
    contact: WheelOnSoil,
    motion: Kinematics,
    sinkage: f64,
    /// W, DP, T
    expected: [f64; 3],
    name: String,
}

fn cases(accuracy: Accuracy) -> Vec<Case> {
    let table = include_str!("oracle/wheel_cases.csv");
    let cases: Vec<Case> = table
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |i: usize| cells[i].parse::<f64>().unwrap();
            let soil = catalogue::find(cells[1]).unwrap().soil().unwrap();
            let wheel = RigidWheel::new(number(2), number(3)).unwrap();
            let settings = Settings {
                accuracy,
                ..Settings::default()
            };
            let contact =
                WheelOnSoil::new(wheel, soil.with_rebound(number(4)).unwrap(), settings).unwrap();
            Case {
                solve: cells[0] == "sinkage",
                contact,
                motion: Kinematics::straight(Slip::new(number(5)).unwrap()),
                sinkage: number(6),
                expected: [number(7), number(8), number(9)],
                name: line.to_owned(),
            }
        })
        .collect();
    assert_eq!(cases.len(), 221);
    cases
}

/// Worst error of W, DP and T/r over max(|W|, |DP|, |T|/r).
fn error(case: &Case, got: [f64; 3]) -> f64 {
    let r = case.contact.wheel().radius();
    let scaled = |f: [f64; 3]| [f[0], f[1], f[2] / r];
    let (got, expected) = (scaled(got), scaled(case.expected));
    let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    got.iter()
        .zip(expected)
        .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
        / size
}

fn worst_over_cases(accuracy: Accuracy) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for case in cases(accuracy).iter().filter(|case| !case.solve) {
        let f = case.contact.forces_at(case.sinkage, &case.motion).unwrap();
        let error = error(case, [f.vertical_force, f.drawbar_pull, f.torque]);
        assert!(!error.is_nan(), "{}", case.name);
        if error > worst.0 {
            worst = (error, case.name.clone());
        }
    }
    worst
}

#[test]
fn standard_forces_to_1e_9() {
    let (worst, at) = worst_over_cases(Accuracy::Standard);
    assert!(worst <= 1e-9, "{worst:e} at {at}");
}

#[test]
fn reference_forces_to_1e_13() {
    let (worst, at) = worst_over_cases(Accuracy::Reference);
    assert!(worst <= 1e-13, "{worst:e} at {at}");
}

#[test]
fn sinkage_under_load_to_the_same_accuracy() {
    for (accuracy, limit) in [(Accuracy::Standard, 1e-9), (Accuracy::Reference, 1e-13)] {
        for case in cases(accuracy).iter().filter(|case| case.solve) {
            let solution = case
                .contact
                .under_load(case.expected[0], &case.motion)
                .unwrap();
            let point = solution.point().expect("every case has a solution");
            let off = (point.sinkage - case.sinkage).abs() / case.sinkage;
            assert!(off <= limit, "{off:e} at {}", case.name);
            let f = point.forces;
            let error = error(case, [f.vertical_force, f.drawbar_pull, f.torque]);
            assert!(error <= limit, "{error:e} at {}", case.name);
        }
    }
}

#[test]
fn the_error_estimate_is_of_the_errors_size() {
    for case in cases(Accuracy::Standard).iter().filter(|case| !case.solve) {
        let point = case.contact.at_sinkage(case.sinkage, &case.motion).unwrap();
        let f = point.forces;
        let size = f.vertical_force.abs().max(f.drawbar_pull.abs());
        let true_error = (f.vertical_force - case.expected[0])
            .abs()
            .max((f.drawbar_pull - case.expected[1]).abs());
        // the finer rule's own error and rounding stay below 1e-13 of the forces
        assert!(
            true_error <= 1.1 * point.error_estimate() + 1e-13 * size,
            "{}",
            case.name
        );
    }
}
