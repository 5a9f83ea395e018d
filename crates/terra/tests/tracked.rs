//! The wheel in a control loop against one at a time, and what it may not do: allocate.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use grouser_terra::{
    Accuracy, BatchForces, Kinematics, LoadStatus, RigidWheel, Settings, Slip, TrackedWheel,
    WheelOnSoil, catalogue,
};
use proptest::prelude::*;

const SOILS: [&str; 5] = ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"];

fn pair(key: &str, radius: f64, width: f64, rebound: f64, accuracy: Accuracy) -> WheelOnSoil {
    let soil = catalogue::find(key).unwrap().soil().unwrap();
    let settings = Settings {
        accuracy,
        ..Settings::default()
    };
    let wheel = RigidWheel::new(radius, width).unwrap();
    WheelOnSoil::new(wheel, soil.with_rebound(rebound).unwrap(), settings).unwrap()
}

/// Greatest difference over max(|W|, |DP|, |T|/r).
fn off(exact: &WheelOnSoil, slip: Slip, got: &BatchForces) -> f64 {
    let f = exact
        .forces_at(got.sinkage, &Kinematics::straight(slip))
        .unwrap();
    let r = exact.wheel().radius();
    let size = f
        .vertical_force
        .abs()
        .max(f.drawbar_pull.abs())
        .max(f.torque.abs() / r);
    (f.vertical_force - got.vertical_force)
        .abs()
        .max((f.drawbar_pull - got.drawbar_pull).abs())
        .max((f.torque - got.torque).abs() / r)
        / size
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn forces_are_good_to_1e_9(
        key in 0..5_usize, radius in 0.03..0.5_f64, width in 0.03..0.5_f64,
        rebound in prop_oneof![Just(0.0), 0.0..1.0_f64], slip in -1.0..=1.0_f64, depth in 0.0005..0.99_f64,
    ) {
        let exact = pair(SOILS[key], radius, width, rebound, Accuracy::Reference);
        let slip = Slip::new(slip).unwrap();
        let wheel = TrackedWheel::new(pair(SOILS[key], radius, width, rebound, Accuracy::Standard));
        for wheel in [wheel.clone(), wheel.portable()] {
            let got = wheel.forces(depth * radius, slip).unwrap();
            prop_assert!(off(&exact, slip, &got) <= 1e-9);
        }
    }

    #[test]
    fn a_walk_is_followed_to_1e_9(
        key in 0..5_usize, radius in 0.05..0.4_f64, width in 0.05..0.3_f64,
        steps in prop::collection::vec((-0.2..0.2_f64, -0.05..0.05_f64), 1..30),
    ) {
        let exact = pair(SOILS[key], radius, width, 0.0, Accuracy::Reference);
        let mut wheel = TrackedWheel::new(pair(SOILS[key], radius, width, 0.0, Accuracy::Standard));
        let (mut load, mut slip) = (1e4 * radius * width, 0.1_f64);
        for (up, on) in steps {
            load *= 1.0 + up;
            slip = (slip + on).clamp(-0.02, 1.0);
            let s = Slip::new(slip).unwrap();
            let got = wheel.under_load(load, s).unwrap();
            let wanted = exact.sinkage_under(load, &Kinematics::straight(s)).unwrap();
            if let Some(sinkage) = wanted.sinkage {
                let got = got.forces.unwrap();
                prop_assert!((got.sinkage / sinkage - 1.0).abs() < 2e-9, "{} {sinkage}", got.sinkage);
                // its own 1e-9 and what the sinkage's makes of it
                prop_assert!(off(&exact, s, &got) < 2e-9, "{:e}", off(&exact, s, &got));
            } else {
                let nothing = matches!(got.status, LoadStatus::NoSolution { .. });
                prop_assert!(nothing);
            }
        }
    }
}

#[test]
fn a_loop_takes_two_evaluations_and_allocates_nothing() {
    let mut wheel = TrackedWheel::new(pair("dry-sand", 0.1, 0.05, 0.0, Accuracy::Standard));
    wheel.under_load(20.0, Slip::new(0.2).unwrap()).unwrap();
    let mut evaluations = 0;
    let used = allocation_counter::measure(|| {
        for i in 0..1000 {
            // a tick of a 100 Hz loop: slip and load sway by a few percent a second
            let t = f64::from(i) * 0.01;
            let slip = Slip::new(0.2 + 0.15 * t.sin()).unwrap();
            let solved = wheel
                .under_load(20.0 + 3.0 * (2.3 * t).cos(), slip)
                .unwrap();
            evaluations += solved.evaluations;
            wheel.forces(solved.forces.unwrap().sinkage, slip).unwrap();
        }
        // what lanes do not serve
        let braked = Slip::new(-0.3).unwrap();
        wheel.under_load(20.0, braked).unwrap();
        wheel.forces(0.07, braked).unwrap();
    });
    assert_eq!((used.count_total, used.bytes_total), (0, 0));
    assert!(evaluations <= 2000, "{evaluations}");
}

#[test]
fn bad_input_is_the_general_solvers_error() {
    let mut wheel = TrackedWheel::new(pair("lunar", 0.1, 0.05, 0.0, Accuracy::Standard));
    let slip = Slip::new(0.2).unwrap();
    for load in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(wheel.under_load(load, slip).is_err());
    }
    for sinkage in [-0.001, f64::NAN, 0.1, 0.2] {
        assert!(wheel.forces(sinkage, slip).is_err());
    }
    assert_eq!(wheel.forces(0.0, slip).unwrap().vertical_force, 0.0);
    let nothing = wheel.under_load(1e9, slip).unwrap();
    assert!(matches!(nothing.status, LoadStatus::NoSolution { .. }));
    // and goes on afterwards
    assert!(wheel.under_load(20.0, slip).unwrap().forces.is_some());
}
