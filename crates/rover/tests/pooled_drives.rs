//! Many drives of each shipped scenario, on ground that obeys the estimator's own law of shear and on ground that obeys others:
//! what is `Ok` is never wrong for a second, and the sigmas hold on average.
//!
//! `cargo test --release -p grouser-rover --test all pooled_drives:: -- --ignored --nocapture`; minutes.

use std::path::Path;

use grouser_rover::drive::{Outcome, Pilot, Simulation, read_scenario};
use grouser_terra::ShearLaw;

/// The slip that the running-slip problem gives for the robot on dry sand.
const RUNNING_SLIP: f64 = 0.39;
/// The longest time with an error of more than four sigma while `Ok`, s: shorter than the controller's decisions.
const MAX_WRONG_S: f64 = 1.0;
/// Limit of the pooled normalised squared error: sigmas at most 1.4 times too narrow.
const MAX_NEES: f64 = 2.0;
/// Drives pooled for each scenario and law; of the soft patch more, since its errors are rare.
const DRIVES: u64 = 20;
const SOFT_PATCH_DRIVES: u64 = 50;
/// Drives of the soft patch in every run of the tests: of two alone the pooled error scatters by a factor of two.
const FEW_DRIVES: u64 = 10;

/// The drives of one scenario on ground of one law.
#[derive(Debug, Default)]
struct Pool {
    drives: u64,
    arrived: u64,
    count: f64,
    square: f64,
    scaled: f64,
    longest_wrong: f64,
    /// Drives in which a slip called Ok was wrong for longer than [`MAX_WRONG_S`].
    wrong: u64,
}

impl Pool {
    fn rmse(&self) -> f64 {
        (self.square / self.count).sqrt()
    }

    fn nees(&self) -> f64 {
        self.scaled / self.count
    }
}

/// Drives with `drives` seeds from the scenario's own one on; `law` of the ground, none: the estimator's.
fn pool(name: &str, law: Option<ShearLaw>, drives: u64) -> Pool {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios");
    let mut scenario = read_scenario(&folder.join(name).with_extension("toml")).unwrap();
    scenario.ground.world_laws = law;
    let mut pool = Pool::default();
    for seed in scenario.seed..scenario.seed + drives {
        let result = Simulation::new(&scenario, Pilot::Controller, RUNNING_SLIP, seed)
            .unwrap()
            .run(|_| true);
        let count = result.slip.count as f64;
        pool.drives += 1;
        pool.arrived += u64::from(result.outcome == Outcome::Arrived);
        pool.count += count;
        pool.square += count * result.slip.rmse.unwrap().powi(2);
        pool.scaled += count * result.slip.nees.unwrap();
        pool.longest_wrong = pool.longest_wrong.max(result.slip.longest_wrong);
        if result.slip.longest_wrong > MAX_WRONG_S {
            pool.wrong += 1;
            println!(
                "{name} {law:?} seed {seed}: Ok and wrong for {:.2} s",
                result.slip.longest_wrong
            );
        }
    }
    println!(
        "{name} {}: {} of {} arrived, rmse {:.4}, nees {:.2}, longest wrong {:.2} s, {} drives wrong",
        law.map_or("own law", ShearLaw::key),
        pool.arrived,
        pool.drives,
        pool.rmse(),
        pool.nees(),
        pool.longest_wrong,
        pool.wrong
    );
    pool
}

/// No drive has a slip that is Ok and wrong for a second.
fn pools(law: Option<ShearLaw>) {
    for (name, drives) in [
        ("slope", DRIVES),
        ("dunes", DRIVES),
        ("sandbox", DRIVES),
        ("soft-patch", SOFT_PATCH_DRIVES),
    ] {
        let pool = pool(name, law, drives);
        assert_eq!(pool.wrong, 0, "{name} {law:?}: {pool:?}");
        assert!(pool.nees() < MAX_NEES, "{name} {law:?}: {pool:?}");
    }
}

#[test]
fn soft_patches_hold_no_silent_error() {
    for law in [None, Some(ShearLaw::SlipVelocity)] {
        let pool = pool("soft-patch", law, FEW_DRIVES);
        // under another law the edges of two patches of twenty are found after one to two and a half seconds
        assert!(pool.wrong <= 2 && pool.longest_wrong < 2.5, "{pool:?}");
        assert!(pool.nees() < MAX_NEES, "{pool:?}");
    }
}

#[test]
#[ignore = "minutes: 110 drives; run with --release -- --ignored --nocapture"]
fn pooled_under_the_own_law() {
    pools(None);
}

#[test]
#[ignore = "minutes: 330 drives; run with --release -- --ignored --nocapture"]
fn pooled_under_foreign_laws() {
    for law in [
        ShearLaw::SlipVelocity,
        ShearLaw::TowedRestart,
        ShearLaw::TowedWongReece,
    ] {
        pools(Some(law));
    }
}
