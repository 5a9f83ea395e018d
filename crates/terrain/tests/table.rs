//! The table against the exact solver, and the exact solver against `climb`, which is another program for the same question.

use grouser_rover::ground::Noise;
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::climb;
use grouser_terra::{Soil, catalogue};
use grouser_terrain::{Demand, DemandSolver, Envelope, MAX_SLIP, SLIP_BOUND, SlipTable};

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

#[test]
fn straight_uphill_the_demand_is_that_of_climb() {
    for name in ROBOTS {
        for key in ["dry-sand", "sandy-loam", "lunar"] {
            let model = robot(name);
            let solver = DemandSolver::new(model.clone(), soil(key)).unwrap();
            let slopes: Vec<f64> = (0..12).map(|i| 0.03 * f64::from(i)).collect();
            for step in climb(&model, &soil(key), &slopes).unwrap() {
                if step.lifts {
                    continue;
                }
                let found = solver.demand(step.slope, 0.0).unwrap();
                match (found, step.slip.filter(|slip| *slip <= MAX_SLIP)) {
                    (Demand::Drives(found), Some(slip)) => {
                        assert!((found.slip - slip).abs() < 1e-8, "{name} {key} {step:?}");
                        let energy = step.energy_per_metre.unwrap();
                        assert!((found.work_per_metre / energy - 1.0).abs() < 1e-6);
                        assert!((found.sinkage - step.sinkage.unwrap()).abs() < 1e-8);
                    }
                    (Demand::Immobilised, None) => {}
                    other => panic!("{name} {key} {step:?}: {other:?}"),
                }
            }
        }
    }
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
