//! The one model of the motion and its pass back, against a dense solution, known worlds and itself.

use grouser_slip::motion::{
    Belief, Entry, KINDS, Levels, Motion, Noise, Reading, Row, SIZE, SLIP, SPEED, Step, Tape,
    Value, WheelStep, X, common_motion, dot, log_slip, slip_of_log, start,
};
use grouser_slip::smooth::{fit, smoothed, travel, wheel_slips};

use crate::noise::Noise as Random;

/// A linear chain of random rows, noises and readings: the smoothed mean and variance are those of the joint Gaussian of the
/// start and all noises, solved densely.
#[test]
#[allow(
    clippy::too_many_lines,
    reason = "one dense solution for all that is compared"
)]
fn the_pass_back_is_the_dense_solution() {
    let mut random = Random::new(7);
    let sigma = [1.0, 0.8, 0.5, 1.2, 0.3, 0.7, 0.2, 0.4];
    let first = Belief::independent([0.1; SIZE], sigma);
    let mut belief = first;
    let mut tape = Tape::default();
    // every number as a function of the start and the noises so far, with their variances
    let mut prior: Vec<f64> = sigma.iter().map(|s| s * s).collect();
    let mut rows: Vec<Vec<f64>> = (0..SIZE)
        .map(|i| (0..SIZE).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    let mut readings: Vec<(Vec<f64>, f64, f64)> = Vec::new();
    let mut ends: Vec<Vec<Vec<f64>>> = Vec::new();
    let at = |rows: &[Vec<f64>], row: &Row, width: usize| -> Vec<f64> {
        let of = |k: usize| {
            (0..SIZE)
                .map(|i| row[i] * rows[i].get(k).copied().unwrap_or(0.0))
                .sum()
        };
        (0..width).map(of).collect()
    };
    for _ in 0..6 {
        let index = random.below(SIZE);
        let variance = 0.1 + random.uniform();
        belief.add_noise(index, variance);
        tape.entries.push(Entry::Noise {
            noise: Noise::Slip,
            index,
            exposure: variance,
        });
        prior.push(variance);
        let width = prior.len();
        rows[index].resize(width, 0.0);
        rows[index][width - 1] += 1.0;
        let mut row: Row = core::array::from_fn(|_| random.normal());
        let index = random.below(SIZE);
        rows[index] = at(&rows, &row, width);
        let mean = belief.mean_of(&row);
        belief.propagate(index, &row);
        belief.mean[index] = mean;
        tape.entries.push(Entry::Propagate { index, row });
        row = core::array::from_fn(|_| random.normal());
        let (value, variance) = (random.normal(), 0.2 + random.uniform());
        let innovation = value - belief.mean_of(&row);
        let correction = belief.update(&row, innovation, variance);
        tape.entries.push(Entry::Update {
            noise: Noise::Place,
            correction,
            variance,
            reading: None,
        });
        readings.push((at(&rows, &row, width), value, variance));
        tape.entries.push(Entry::End);
        tape.ends.push(belief);
        ends.push(rows.clone());
    }
    let found = smoothed(&tape);
    // the joint Gaussian, reading by reading
    let n = prior.len();
    let mut mean = vec![0.0; n];
    mean[..SIZE].copy_from_slice(&first.mean);
    let mut covariance = vec![vec![0.0; n]; n];
    for (i, variance) in prior.iter().enumerate() {
        covariance[i][i] = *variance;
    }
    let times = |covariance: &[Vec<f64>], row: &[f64]| -> Vec<f64> {
        covariance
            .iter()
            .map(|of| of.iter().zip(row).map(|(a, b)| a * b).sum())
            .collect()
    };
    for (row, value, variance) in &readings {
        let spread = times(&covariance, row);
        let total: f64 = row.iter().zip(&spread).map(|(a, b)| a * b).sum::<f64>() + variance;
        let innovation = value - row.iter().zip(&mean).map(|(a, b)| a * b).sum::<f64>();
        for i in 0..n {
            mean[i] += spread[i] * innovation / total;
            for j in 0..n {
                covariance[i][j] -= spread[i] * spread[j] / total;
            }
        }
    }
    for (smoothed, rows) in found.iter().zip(&ends) {
        for (i, row) in rows.iter().enumerate() {
            let expected: f64 = row.iter().zip(&mean).map(|(a, b)| a * b).sum();
            let variance: f64 = times(&covariance, row)
                .iter()
                .zip(row)
                .map(|(a, b)| a * b)
                .sum();
            assert!(
                (smoothed.mean[i] - expected).abs() < 1e-10,
                "{i}: {} {expected}",
                smoothed.mean[i]
            );
            assert!((smoothed.covariance[i][i] - variance).abs() < 1e-10, "{i}");
        }
    }
    // the distance is a sum over the steps that no reading shows
    let seconds = [0.5, 0.0, 1.0, -0.3, 2.0, 0.7];
    let of = |k: usize| {
        let steps = ends.iter().zip(seconds);
        let parts = steps.map(|(rows, t)| t * rows[SPEED].get(k).copied().unwrap_or(0.0));
        parts.sum::<f64>()
    };
    let sum: Vec<f64> = (0..n).map(of).collect();
    let found = travel(&tape, &seconds);
    let expected = dot_of(&sum, &mean);
    assert!(
        (found.value - expected).abs() < 1e-10,
        "{found:?} {expected}"
    );
    let expected = dot_of(&sum, &times(&covariance, &sum));
    assert!(
        (found.variance - expected).abs() < 1e-10,
        "{found:?} {expected}"
    );
}

fn dot_of(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn a_logarithmic_slip_is_the_slip_of_both_definitions() {
    for ground in [0.1, 0.5, 1.0, 2.0] {
        for wheel in [0.05, 0.5, 1.0, 3.0] {
            let expected = if wheel >= ground {
                1.0 - ground / wheel
            } else {
                wheel / ground - 1.0
            };
            let (slip, slope) = slip_of_log(log_slip(wheel, ground));
            assert!((slip - expected).abs() < 1e-14, "{wheel} {ground}");
            let (above, _) = slip_of_log(log_slip(wheel, ground) + 1e-6);
            assert!((above - slip - 1e-6 * slope).abs() < 1e-11);
        }
    }
    assert!(
        slip_of_log(log_slip(0.5, -0.1)).0 > 0.98,
        "a wheel that is dragged back spins"
    );
    assert!(slip_of_log(log_slip(0.0, 0.3)).0 < -0.98, "a locked wheel");
}

/// A straight drive: wheels of two sides, places at 5 Hz with noise of `sigma`, slip by time.
pub(crate) fn drive(
    slip: impl Fn(f64) -> f64,
    seconds: f64,
    speed: f64,
    sigma: f64,
    seed: u64,
    force: Option<f64>,
) -> Vec<Step> {
    let mut random = Random::new(seed);
    let dt = 0.05;
    let (mut x, mut steps) = (0.0, Vec::new());
    let mut time = 0.0;
    for k in 1_usize.. {
        time += dt;
        if time > seconds {
            break;
        }
        x += speed * dt;
        let wheels = [-1.0, 1.0].map(|side| WheelStep {
            distance: Some(speed * dt / (1.0 - slip(time)) + 1e-4 * random.normal()),
            variance: 1e-8,
            row: [1.0, 0.0, -0.2 * side],
            across: [0.0, 1.0, 0.0],
            ..WheelStep::default()
        });
        let place = Value::Place([x + sigma * random.normal(), sigma * random.normal()]);
        let is_read = k % 4 == 0;
        let readings = if is_read {
            vec![Reading {
                value: place,
                since: 0.0,
                scale: 1.0,
            }]
        } else {
            Vec::new()
        };
        let turn = Some(1e-4 * random.normal());
        let force = force.map(|noise| [noise * random.normal(), 0.0]);
        steps.push(Step {
            frame: None,
            time,
            dt,
            wheels: wheels.to_vec(),
            turn,
            force,
            readings,
        });
    }
    steps
}

pub(crate) fn prior(place: f64) -> (Levels, [bool; KINDS]) {
    let sigmas = [
        0.03, 0.03, 0.03, 2e-3, 2e-4, 3e-3, 1e-5, place, 0.01, 0.03, 1.0,
    ];
    let mut learn = [true; KINDS];
    for kind in [Noise::Wander, Noise::Wheel] {
        learn[kind as usize] = false;
    }
    (Levels(sigmas.map(|sigma: f64| sigma * sigma)), learn)
}

#[test]
fn a_slip_that_jumps_is_found_with_its_interval_and_its_time() {
    let slip = |time: f64| if time < 20.0 { 0.1 } else { 0.4 };
    let mut steps = drive(slip, 40.0, 0.5, 0.02, 1, None);
    let (levels, learn) = prior(0.05);
    let found = fit(
        &mut steps,
        start([0.0; 2], 0.0, true),
        levels,
        learn,
        0.0..f64::INFINITY,
    );
    assert_eq!(found.jumps.len(), 1, "{:?}", found.jumps);
    assert!((steps[found.jumps[0]].time - 20.0).abs() < 0.6);
    let sigma = found.levels.of(Noise::Place).sqrt();
    assert!((sigma - 0.02).abs() < 0.004, "noise of the places: {sigma}");
    for wheel in 0..2 {
        let slips = wheel_slips(&found, &steps, wheel);
        let errors = slips
            .iter()
            .map(|of| (of.slip - slip(steps[of.step].time), of.variance.sqrt()));
        let (mut inside, mut squares) = (0, 0.0);
        for (error, sigma) in errors {
            inside += usize::from(error.abs() <= 1.645 * sigma);
            squares += error * error;
        }
        let rmse = (squares / slips.len() as f64).sqrt();
        println!("{wheel}: {rmse:.4}, {inside} of {}", slips.len());
        // a centred mean over a second of places of 2 cm: 0.02 √2/0.5 = 0.057
        assert!(rmse < 0.02, "{rmse}");
        assert!(inside * 100 > slips.len() * 85);
    }
}

#[test]
fn a_slip_that_wanders_is_no_series_of_jumps() {
    let slip = |time: f64| 0.2 + 0.1 * (0.7 * time).sin() + 0.05 * (1.9 * time).cos();
    let mut steps = drive(slip, 40.0, 1.0, 0.01, 2, None);
    let (levels, learn) = prior(0.05);
    let found = fit(
        &mut steps,
        start([0.0; 2], 0.0, true),
        levels,
        learn,
        0.0..f64::INFINITY,
    );
    assert!(found.jumps.is_empty(), "{:?}", found.jumps);
    let slips = wheel_slips(&found, &steps, 0);
    let error = |of: &&grouser_slip::smooth::WheelSlip| (of.slip - slip(steps[of.step].time)).abs();
    let inside = slips
        .iter()
        .filter(|of| error(of) <= 1.645 * of.variance.sqrt())
        .count();
    assert!(
        inside * 100 > slips.len() * 80,
        "{inside} of {}",
        slips.len()
    );
}

/// One place of ten is off by 0.7 m, 35 sigma.
#[test]
fn outliers_change_little() {
    let (levels, learn) = prior(0.05);
    let mut clean = drive(|_| 0.2, 30.0, 1.0, 0.02, 3, None);
    let mut steps = clean.clone();
    let read = steps.iter_mut().filter(|step| !step.readings.is_empty());
    for step in read.skip(5).step_by(10) {
        step.readings[0].value = Value::Place([step.time + 0.5, -0.5]);
    }
    let begin = start([0.0; 2], 0.0, true);
    let without = fit(&mut clean, begin, levels, learn, 0.0..f64::INFINITY);
    let with = fit(&mut steps, begin, levels, learn, 0.0..f64::INFINITY);
    for (a, b) in with.smoothed.iter().zip(&without.smoothed) {
        // a tenth of the readings is lost
        let error = (a.mean[SLIP] - b.mean[SLIP]).abs();
        assert!(error < 0.02, "{} {}", a.mean[SLIP], b.mean[SLIP]);
        assert!((a.mean[X] - b.mean[X]).abs() < 0.05);
    }
}

#[test]
fn covariances_stay_symmetric_and_positive() {
    let steps = drive(|_| 0.3, 20.0, 0.5, 0.02, 5, Some(0.1));
    let (levels, _) = prior(0.02);
    let mut motion = Motion::new(start([0.0; 2], 0.0, true));
    let mut random = Random::new(9);
    for step in &steps {
        motion.advance(step, &levels, 0.0, &mut [0.0; 2], None);
        let belief = &motion.belief;
        for _ in 0..4 {
            let row: Row = core::array::from_fn(|_| random.normal());
            assert!(dot(&row, &belief.spread(&row)) > 0.0);
        }
        for i in 0..SIZE {
            for j in 0..SIZE {
                let (a, b) = (belief.covariance[i][j], belief.covariance[j][i]);
                assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()), "{i} {j}: {a} {b}");
            }
        }
    }
}

/// Five wheels, the last one steered, at 0.3 m/s: one counts backwards at six times that speed.
#[test]
fn one_wheel_that_contradicts_the_others_hardly_moves_the_common_motion() {
    let motion = |wrong: f64| {
        let headings = [0.0, 0.0, 0.0, 0.0, 0.1_f64];
        let wheels: Vec<WheelStep> = (headings.iter().enumerate())
            .map(|(index, heading)| {
                let (sin, cos) = heading.sin_cos();
                let [x, y] = [
                    [0.3, 0.2],
                    [0.3, -0.2],
                    [0.0, 0.2],
                    [0.0, -0.2],
                    [-0.3, 0.0],
                ][index];
                let row = [cos, sin, x * sin - y * cos];
                let along = dot(&row, &[0.015, 0.0, 0.0015]);
                WheelStep {
                    distance: Some(if index == 2 { wrong } else { along }),
                    variance: 1e-8,
                    row,
                    across: [-sin, cos, x * cos + y * sin],
                    ..WheelStep::default()
                }
            })
            .collect();
        common_motion(&wheels, Some(0.0015), 1.0, 0.0, &mut [0.0; 5]).unwrap()
    };
    let [sound, broken] = [0.015 - 0.2 * 0.0015, -0.09].map(motion);
    assert!((sound.distance - 0.015).abs() < 1e-4, "{sound:?}");
    let moved = broken.distance - sound.distance;
    assert!(moved.abs() < 0.01 * 0.105, "{moved}");
}
