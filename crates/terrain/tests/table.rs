//! The table against the exact solver.

use grouser_rover::ground::Noise;
use grouser_rover::robot::RobotModel;
use grouser_terra::{Soil, catalogue};
use grouser_terrain::{Demand, DemandSolver, Envelope, SLIP_BOUND, SlipTable};

const ROBOTS: [&str; 3] = ["five-wheel", "rocker-bogie", "skid-steer"];

fn robot(name: &str) -> RobotModel {
    let file = format!(
        "{}/../../examples/robots/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    RobotModel::read(file.as_ref()).unwrap()
}

fn soil(key: &str) -> Soil {
    catalogue::find(key).unwrap().soil().unwrap()
}

/// The greatest difference in slip, its 99.9 % quantile, and how many poses were answered differently.
fn compared(name: &str, key: &str, count: u32, seed: u64) -> (f64, u32, u32) {
    let solver = DemandSolver::new(robot(name), soil(key)).unwrap();
    let envelope = Envelope::within(solver.model(), 0.5, 0.4).unwrap();
    let began = std::time::Instant::now();
    let table = SlipTable::new(&solver, envelope).unwrap();
    let built = began.elapsed();
    let mut noise = Noise::new(seed, 1);
    let (mut worst, mut otherwise, mut drives) = (0.0_f64, 0, 0);
    for _ in 0..count {
        let pitch = envelope.max_pitch * (2.0 * noise.uniform() - 1.0);
        let roll = envelope.max_roll * (2.0 * noise.uniform() - 1.0);
        let exact = solver.demand(pitch, roll).unwrap();
        match (exact, table.demand(&solver, pitch, roll).unwrap()) {
            (Demand::Drives(exact), Demand::Drives(read)) => {
                drives += 1;
                worst = worst.max((exact.slip - read.slip).abs());
            }
            (exact, read) => otherwise += u32::from(exact != read),
        }
    }
    eprintln!(
        "{name} on {key}: {drives} of {count} drive, worst {worst:.2e} (bound {:.2e}), limit {:.1e} rad, energy {:.1e}, \
         sinkage {:.1e} m, {otherwise} otherwise; nodes {:?}, envelope {:.3} x {:.3}, built in {built:.2?}",
        table.error().slip,
        table.error().limit,
        table.error().energy,
        table.error().sinkage,
        table.nodes(),
        envelope.max_pitch,
        envelope.max_roll,
    );
    // what the table reports of itself holds
    assert!(worst <= table.error().slip, "{name} on {key}");
    (worst, otherwise, drives)
}

#[test]
fn the_table_keeps_its_bound_on_random_poses() {
    for name in ROBOTS {
        let key = if name == "skid-steer" {
            "clayey-soil"
        } else {
            "dry-sand"
        };
        let (worst, otherwise, drives) = compared(name, key, 500, 3);
        assert!(worst <= SLIP_BOUND, "{name} {key}: {worst}");
        assert_eq!(otherwise, 0, "{name} {key}");
        assert!(drives > 100, "{name} {key}");
    }
}

/// 100 000 poses: `cargo test --release -p grouser-terrain --test all table:: -- --ignored --nocapture`.
#[test]
#[ignore = "minutes; `just terrain` runs it"]
fn the_table_keeps_its_bound_on_a_hundred_thousand_poses() {
    for (index, name) in ROBOTS.into_iter().enumerate() {
        for (other, key) in ["dry-sand", "clayey-soil"].into_iter().enumerate() {
            let (worst, otherwise, _) =
                compared(name, key, 17_000, 10 + (2 * index + other) as u64);
            assert!(worst <= SLIP_BOUND, "{name} {key}: {worst}");
            assert_eq!(otherwise, 0, "{name} {key}");
        }
    }
}

/// A pose takes a dozen solves of each wheel; a coarse table has 306 poses, a fine one up to 4290 beside its checks.
#[test]
fn a_table_solves_wheels_at_few_loads_and_slips() {
    for name in ROBOTS {
        let solver = DemandSolver::new(robot(name), soil("dry-sand")).unwrap();
        let within = |pitch, roll| Envelope::within(solver.model(), pitch, roll).unwrap();
        let coarse = SlipTable::coarse(&solver, within(0.45, 0.38)).unwrap();
        let fine = SlipTable::new(&solver, within(0.45, 0.38)).unwrap();
        let narrow = SlipTable::new(&solver, within(0.3, 0.1)).unwrap();
        let solves = [coarse, fine, narrow].map(|table| table.wheel_solves());
        eprintln!("{name}: {solves:?}");
        let kinds = if name == "five-wheel" { 2 } else { 1 };
        assert!(
            solves[0] < kinds * 300 && solves[1] < kinds * 1000,
            "{name}: {solves:?}"
        );
        // what no pose needs is not solved
        assert!(solves[2] < solves[1], "{name}: {solves:?}");
    }
}

/// Learning takes a model for wrong by 0.03 in slip and more (`LearnSettings`).
#[test]
fn a_coarse_table_is_near_the_exact_solver() {
    for (name, key) in [
        ("five-wheel", "dry-sand"),
        ("five-wheel", "lunar"),
        ("skid-steer", "clayey-soil"),
    ] {
        let solver = DemandSolver::new(robot(name), soil(key)).unwrap();
        let envelope = Envelope::within(solver.model(), 0.45, 0.38).unwrap();
        let table = SlipTable::coarse(&solver, envelope).unwrap();
        let mut noise = Noise::new(4, 1);
        let (mut worst, mut drives) = (0.0_f64, 0);
        for _ in 0..200 {
            let pitch = envelope.max_pitch * (2.0 * noise.uniform() - 1.0);
            let roll = envelope.max_roll * (2.0 * noise.uniform() - 1.0);
            let exact = solver.demand(pitch, roll).unwrap();
            let read = table.demand(&solver, pitch, roll).unwrap();
            if let (Demand::Drives(exact), Demand::Drives(read)) = (exact, read) {
                drives += 1;
                worst = worst.max((exact.slip - read.slip).abs());
            }
        }
        eprintln!("{name} on {key}: {worst:.1e} in {drives}");
        assert!(drives > 50 && worst < 3e-3, "{name} on {key}: {worst}");
    }
}

#[test]
fn a_closed_table_answers_every_pose() {
    let solver = DemandSolver::new(robot("skid-steer"), soil("dry-sand")).unwrap();
    let table = SlipTable::closed(Envelope::within(solver.model(), 0.2, 0.1).unwrap());
    for (pitch, roll) in [(0.0, 0.0), (0.1, -0.1), (-0.2, 0.1)] {
        let found = table.demand(&solver, pitch, roll).unwrap();
        assert_eq!(found, Demand::Immobilised);
    }
}
