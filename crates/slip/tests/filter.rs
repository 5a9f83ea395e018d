//! The filter on a robot whose slips are known.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test fails by panicking and may say what it measured; counts are small"
)]

mod noise;
mod world;

use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::{Health, Sample};
use world::{Truth, World};

/// What a run came to, over the powered wheels.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    readings: f64,
    squares: f64,
    scaled: f64,
    /// The longest time with health Ok and an error beyond four sigma, s.
    silent: f64,
}

impl Score {
    fn rms(&self) -> f64 {
        (self.squares / self.readings).sqrt()
    }

    fn nees(&self) -> f64 {
        self.scaled / self.readings
    }
}

/// Runs the filter over `world` with `alter` applied to every sample; scores from `from` s on.
fn score(
    world: &World,
    settings: FilterSettings,
    from: f64,
    mut alter: impl FnMut(f64, Sample) -> Option<Sample>,
) -> Score {
    let mut filter = SlipFilter::new(&world.robot(), settings).unwrap();
    let mut score = Score::default();
    let mut wrong = vec![0.0_f64; world.powered];
    // the truth of the moment that the estimate is of
    let mut truths: Vec<Truth> = Vec::new();
    world.run(|truth, samples| {
        truths.push(truth.clone());
        for sample in samples {
            if let Some(sample) = alter(truth.time, *sample) {
                let _ = filter.update(sample);
            }
        }
        let known = filter.latest();
        if std::env::var("SHOW").is_ok() && truths.len() % 20 == 0 {
            let b = known.body;
            println!(
                "{:.1} v {:.3} ({:.3}±{:.3}) common {:.3}±{:.3} s0 {:?}±{:?} {:?} ({:?}) rej {:?}",
                truth.time,
                truth.speed,
                b.forward.value,
                b.forward.sigma(),
                b.common_slip.value,
                b.common_slip.sigma(),
                known.wheels[0].slip.map(|s| s.value()),
                known.wheels[0].sigma,
                known.wheels[0].health,
                truth.slips[0],
                known.rejected.total()
            );
        }
        let row = (known.time_ns / world::STEP_NS) as usize;
        let then = &truths[row.min(truths.len() - 1)];
        for wheel in 0..world.powered {
            let estimate = &known.wheels[wheel];
            let (Some(slip), Some(sigma), Some(truth)) =
                (estimate.slip, estimate.sigma, then.slips[wheel])
            else {
                wrong[wheel] = 0.0;
                continue;
            };
            let error = slip.value() - truth;
            if estimate.health == Health::Ok && error.abs() > 4.0 * sigma {
                wrong[wheel] += world::STEP;
                score.silent = score.silent.max(wrong[wheel]);
            } else {
                wrong[wheel] = 0.0;
            }
            if then.time >= from && then.speed > 0.05 {
                score.readings += 1.0;
                score.squares += error * error;
                score.scaled += (error / sigma) * (error / sigma);
            }
        }
    });
    score
}

#[test]
fn slips_of_a_five_wheeled_robot_are_found_within_their_sigmas() {
    for camera in [0, 25] {
        for accelerometer in [false, true] {
            let world = World {
                camera,
                accelerometer,
                ..World::default()
            };
            let s = score(&world, FilterSettings::default(), 4.0, |_, x| Some(x));
            println!(
                "camera {camera} accelerometer {accelerometer}: rms {:.4} nees {:.2} silent {:.2} of {}",
                s.rms(),
                s.nees(),
                s.silent,
                s.readings
            );
        }
    }
    if std::env::var("SHOW").is_ok() {
        println!("BLIND");
    }
    let blind = World {
        free: false,
        ..World::default()
    };
    let s = score(&blind, FilterSettings::default(), 4.0, |_, x| Some(x));
    println!(
        "no reference: rms {:.4} nees {:.2} silent {:.2} of {}",
        s.rms(),
        s.nees(),
        s.silent,
        s.readings
    );
    let settings = FilterSettings {
        slip: SlipPrior {
            mean: 0.2,
            sigma: 0.15,
        },
        ..FilterSettings::default()
    };
    let s = score(&blind, settings, 4.0, |_, x| Some(x));
    println!(
        "no reference, prior .2: rms {:.4} nees {:.2} silent {:.2} of {}",
        s.rms(),
        s.nees(),
        s.silent,
        s.readings
    );
}
