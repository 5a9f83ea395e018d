//! The smoother of robots without a free wheel against the centred means, on drives whose slip is known.

use grouser_replay::smoothed;
use grouser_slip::filter::FilterSettings;
use grouser_slip::{Measurement, Sample};
use grouser_synthetic::{Disturbance, KnownTruth, SlipProfile, TruthStep};

/// Errors count from here on and up to here, s.
const FROM_S: f64 = 3.0;
const UNTIL_S: f64 = 117.0;

/// RMSE of the smoother and of the filter, the smaller RMSE of the centred means over 1 s and 2 s, squared error over
/// variance, and the median time between the true slip and the smoothed one at a jump, s.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    smoother: f64,
    filter: f64,
    centred: f64,
    nees: f64,
    lag_s: f64,
}

/// RMSE of the mean over `window_s`, half before and half after.
fn centred_rmse(steps: &[TruthStep], window_s: f64) -> f64 {
    let readings: Vec<_> = steps
        .iter()
        .filter_map(|step| Some((step.time_s, step.rim_way, step.position?)))
        .collect();
    let (mut sum, mut count) = (0.0, 0.0);
    for step in steps {
        let time = step.time_s;
        let half = 0.5 * window_s + 1e-9;
        let before = readings
            .iter()
            .rev()
            .find(|reading| reading.0 <= time - half + 2e-9);
        let after = readings
            .iter()
            .find(|reading| reading.0 >= time + half - 2e-9);
        if let (Some(a), Some(b)) = (before, after)
            && (FROM_S..UNTIL_S).contains(&time)
        {
            let moved = (b.2[0] - a.2[0]).hypot(b.2[1] - a.2[1]);
            sum += (1.0 - moved / (b.1 - a.1) - step.slip).powi(2);
            count += 1.0;
        }
    }
    f64::sqrt(sum / count)
}

fn score(drive: &KnownTruth) -> Score {
    score_of(drive, 0.02, |_, sample| Some(sample))
}

/// The score where `change` gives what is logged of each sample, by the number of its step, and the reference's sigma (m).
fn score_of<Logged: IntoIterator<Item = Sample>>(
    drive: &KnownTruth,
    position_sigma: f64,
    mut change: impl FnMut(usize, Sample) -> Logged,
) -> Score {
    let steps = drive.steps();
    let mut samples = Vec::new();
    for (index, step) in steps.iter().enumerate() {
        samples.extend(step.samples.iter().flat_map(|&one| change(index, one)));
    }
    let settings = FilterSettings {
        position_sigma,
        ..FilterSettings::any_ground()
    };
    let known = smoothed(&KnownTruth::robot().unwrap(), settings, &samples).unwrap();
    let mut known = known.iter().peekable();
    let mut score = Score::default();
    let mut count = 0.0;
    let mut crossed = None;
    for step in &steps {
        let time_ns = step.samples[0].time_ns;
        let Some(at) = known.next_if(|at| at.time_ns == time_ns) else {
            continue;
        };
        let truths = step.wheel_slips.iter();
        let mean = at
            .wheels
            .iter()
            .filter_map(|wheel| Some(wheel.slip?.value()))
            .sum::<f64>()
            / 4.0;
        if crossed.is_none() && step.time_s > 38.0 && mean > 0.1 {
            crossed = Some(step.time_s);
        }
        if !(FROM_S..UNTIL_S).contains(&step.time_s) {
            continue;
        }
        for ((wheel, forward), truth) in at.wheels.iter().zip(&at.forward).zip(truths) {
            let error = wheel.slip.unwrap().value() - truth;
            score.smoother += error * error;
            score.nees += (error / wheel.sigma.unwrap()).powi(2);
            score.filter += (forward.slip.unwrap().value() - truth).powi(2);
            count += 1.0;
        }
    }
    // the true slip crosses 0.1 at 40.075 s
    assert!(known.next().is_none() && count > 1000.0, "{count}");
    score.lag_s = crossed.unwrap_or(f64::INFINITY) - 40.075;
    score.smoother = (score.smoother / count).sqrt();
    score.filter = (score.filter / count).sqrt();
    score.nees /= count;
    score.centred = centred_rmse(&steps, 1.0).min(centred_rmse(&steps, 2.0));
    score
}

fn drive(rim_speed: f64, accelerations: bool, disturbance: Disturbance, seed: u64) -> KnownTruth {
    KnownTruth {
        rim_speed,
        accelerations,
        disturbance,
        profile: SlipProfile::Steps,
        position_sigma: 0.02,
        duration_s: 120,
        seed: 1000 * seed + 17,
    }
}

#[test]
#[ignore = "minutes: all cells; run with --release -- --ignored --nocapture"]
fn every_cell() {
    let seeds = std::env::var("SEEDS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(3);
    for accelerations in [false, true] {
        for disturbance in [Disturbance::Clean, Disturbance::Outliers, Disturbance::Late] {
            for rim_speed in [0.1, 0.25, 0.5, 1.0, 2.0, 3.0] {
                for seed in 0..seeds {
                    let one = score(&drive(rim_speed, accelerations, disturbance, seed));
                    println!(
                        "{accelerations} {disturbance:?} {rim_speed} m/s seed {seed}: ratio {:.2} {one:.4?}",
                        one.smoother / one.centred
                    );
                }
            }
        }
    }
}

#[test]
fn all_positions_at_once_halve_the_error_of_the_centred_mean() {
    for (rim_speed, accelerations, limit) in
        [(0.1, false, 0.35), (1.0, false, 0.45), (1.0, true, 0.4)]
    {
        let one = score(&drive(rim_speed, accelerations, Disturbance::Clean, 1));
        println!("{rim_speed} m/s {accelerations}: {one:?}");
        assert!(
            one.smoother <= limit * one.centred,
            "{rim_speed} m/s: {one:?}"
        );
        assert!(one.smoother <= 1.3 * one.filter, "{rim_speed} m/s: {one:?}");
        assert!(one.nees < 2.0, "{rim_speed} m/s: {one:?}");
    }
}

#[test]
fn places_are_positions_though_displacements_come_beside_them() {
    for (rim_speed, limit) in [(0.25, 0.4), (1.0, 0.45)] {
        let mut before = None;
        let drive = drive(rim_speed, false, Disturbance::Clean, 6);
        let one = score_of(&drive, 0.02, |_, sample| {
            let Measurement::Pose { x, y, yaw } = sample.measurement else {
                return [Some(sample), None].into_iter().flatten();
            };
            // as a log gives them
            let (at_x, at_y) = before.replace((x, y)).unwrap_or((x, y));
            let (sin, cos) = yaw.sin_cos();
            let (dx, dy) = (x - at_x, y - at_y);
            let displacement = Measurement::Displacement {
                forward: cos * dx + sin * dy,
                left: cos * dy - sin * dx,
                turn: None,
            };
            let beside = Sample {
                measurement: displacement,
                ..sample
            };
            let place = Sample {
                measurement: Measurement::Position { x, y },
                ..sample
            };
            [Some(place), Some(beside)].into_iter().flatten()
        });
        println!("{rim_speed} m/s: {one:?}");
        assert!(
            one.smoother <= limit * one.centred,
            "{rim_speed} m/s: {one:?}"
        );
        assert!(one.nees < 2.0, "{rim_speed} m/s: {one:?}");
    }
}

#[test]
fn a_jump_is_found_within_a_third_of_the_time_between_two_positions() {
    let mut lags: Vec<f64> = (0..5)
        .map(|seed| score(&drive(1.0, false, Disturbance::Clean, seed)).lag_s)
        .collect();
    lags.sort_by(f64::total_cmp);
    println!("lags {lags:?} s");
    assert!(lags[2].abs() <= 0.06, "{lags:?}");
}

#[test]
fn outliers_lose_their_weight() {
    let one = score(&drive(1.0, false, Disturbance::Outliers, 2));
    println!("{one:?}");
    assert!(one.smoother <= 0.6 * one.centred, "{one:?}");
}

#[test]
fn rims_that_are_read_at_half_the_rate_of_the_accelerometer_are_not_led_on() {
    // their way over 0.05 s was that of 0.04 s and of 0.06 s in turns: an error of a fifth, which the accelerometer made a slip
    for rim_speed in [0.5, 2.0] {
        let one = score_of(
            &drive(rim_speed, true, Disturbance::Clean, 3),
            0.02,
            |index, sample| {
                let is_read = index % 2 == 0 || !sample.measurement.is_rotation();
                is_read.then_some(sample)
            },
        );
        println!("{rim_speed} m/s: {one:?}");
        assert!(
            one.smoother <= 0.23 * one.centred,
            "{rim_speed} m/s: {one:?}"
        );
        assert!(one.nees < 2.0, "{rim_speed} m/s: {one:?}");
    }
}

#[test]
fn an_accelerometer_makes_no_slip_of_the_errors_of_slow_rims() {
    let one = score(&drive(0.1, true, Disturbance::Clean, 4));
    println!("{one:?}");
    assert!(one.smoother <= 1.1 * one.filter, "{one:?}");
}

#[test]
fn errors_of_displacements_are_not_those_of_their_sum() {
    // with independent errors of 1 cm the sum is off by 0.2 m after most of the drive
    let exact = KnownTruth {
        position_sigma: 0.0,
        ..drive(1.0, false, Disturbance::Clean, 5)
    };
    let mut bits = 1_u64;
    let mut error = || {
        let mut sum = 0.0;
        for _ in 0..12 {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            sum += (bits >> 11) as f64 / (1_u64 << 53) as f64;
        }
        0.01 * (sum - 6.0)
    };
    let mut before = None;
    let one = score_of(&exact, 0.01, |_, sample| {
        let Measurement::Pose { x, y, yaw } = sample.measurement else {
            return Some(sample);
        };
        let (at_x, at_y) = before.replace((x, y)).unwrap_or((x, y));
        let (sin, cos) = yaw.sin_cos();
        let (x, y) = (x - at_x, y - at_y);
        Some(Sample {
            measurement: Measurement::Displacement {
                forward: cos * x + sin * y + error(),
                left: cos * y - sin * x + error(),
                turn: None,
            },
            ..sample
        })
    });
    println!("{one:?}");
    assert!(one.smoother <= 0.8 * one.filter, "{one:?}");
    assert!(one.nees < 2.0, "{one:?}");
}
