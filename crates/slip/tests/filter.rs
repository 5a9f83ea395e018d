//! The filter on a robot whose slips are known.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test fails by panicking and may say what it measured; counts are small"
)]

use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::{Health, Sample};

use crate::world;
use crate::world::{Truth, World};

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
        let row = (known.time_ns / world::STEP_NS) as usize;
        let then = &truths[row.min(truths.len() - 1)];
        for (wheel, wrong) in wrong.iter_mut().enumerate() {
            let estimate = &known.wheels[wheel];
            let (Some(slip), Some(sigma), Some(truth)) =
                (estimate.slip, estimate.sigma, then.slips[wheel])
            else {
                *wrong = 0.0;
                continue;
            };
            let error = slip.value() - truth;
            if estimate.health == Health::Ok && error.abs() > 4.0 * sigma {
                *wrong += world::STEP;
                score.silent = score.silent.max(*wrong);
            } else {
                *wrong = 0.0;
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

fn report(name: &str, s: &Score) {
    println!(
        "{name}: rms {:.4}, squared error over variance {:.2}, longest silence {:.2} s",
        s.rms(),
        s.nees(),
        s.silent
    );
}

#[test]
fn slips_of_a_five_wheeled_robot_are_found_within_their_sigmas() {
    for (camera, accelerometer, most) in [
        (0, false, 0.025),
        (0, true, 0.02),
        (25, false, 0.025),
        (25, true, 0.022),
    ] {
        let world = World {
            accelerometer,
            camera,
            ..World::default()
        };
        let s = score(&world, FilterSettings::default(), 2.0, |_, x| Some(x));
        report(
            &format!("camera {camera} Hz, accelerometer {accelerometer}"),
            &s,
        );
        assert!(s.rms() < most);
        assert!(s.nees() < 1.8);
        // never beyond a second
        assert!(s.silent < 0.5);
    }
}

/// With nothing but encoders and an IMU the slip is its prior's, as wide as that, and said to be so.
#[test]
fn without_a_reference_the_prior_speaks_and_says_how_wide_it_is() {
    let blind = World {
        free: false,
        ..World::default()
    };
    for mean in [0.1, 0.2, 0.3] {
        let settings = FilterSettings {
            slip: SlipPrior { mean, sigma: 0.2 },
            ..FilterSettings::default()
        };
        let s = score(&blind, settings, 2.0, |_, x| Some(x));
        report(&format!("prior {mean}"), &s);
        assert!(s.nees() < 1.5);
        assert!(s.silent == 0.0);
    }
}

/// A robot that starts and stops within 0.3 s, beside a free wheel and without an accelerometer: all its counters show the stop.
#[test]
fn brisk_starts_and_stops_are_no_fault_of_the_free_wheel() {
    for (speed, time) in [(0.5, 0.3), (0.8, 0.3), (0.8, 0.6), (1.5, 0.6)] {
        let mut sum = Score::default();
        for seed in 0..10 {
            let world = World {
                seed,
                speed,
                slip: (0.2, 0.2),
                legs: [1.0, time, 4.0, time],
                accelerometer: false,
                ..World::default()
            };
            let score = score(&world, FilterSettings::default(), 1.0, |_, sample| {
                Some(sample)
            });
            sum.readings += score.readings;
            sum.squares += score.squares;
            sum.scaled += score.scaled;
            sum.silent = sum.silent.max(score.silent);
        }
        let [rms, nees, silent] = [sum.rms(), sum.nees(), sum.silent];
        println!("{speed} m/s within {time} s: {rms:.3}, {nees:.2}, {silent:.2} s");
        assert!(
            rms < 0.03 && nees < 1.0 && silent < 0.1,
            "{rms} {nees} {silent}"
        );
    }
}
