//! The constant by which the gyro's clock differs from the encoders'.

use grouser_files::robot::WheelSensor;
use grouser_slip::window::{WindowEstimator, WindowSettings};
use grouser_slip::{Measurement, Reference, Robot, Sample, WheelRole};

use crate::reference_delay::track::Track;

/// Turns are compared over this time, s: long against a sample, short against a manoeuvre.
const WINDOW_S: f64 = 0.2;
/// Offsets are looked for up to this, s.
const RANGE_S: f64 = 0.5;
/// First step of the search, s; the second is a tenth of it.
const STEP_S: f64 = 0.01;
/// Maximum number of readings of each sensor that are compared: the first of the log.
const MAX_READINGS: usize = 1 << 16;
/// Minimum mean size of a turn, rad: a log that hardly turns holds no offset.
const MIN_TURN_RAD: f64 = 0.002;

/// How much later the gyro's clock stamps the same moment than the encoders', in seconds: the offset
/// with the least mean |turn by encoders − turn by gyro| over windows of 0.2 s.
///
/// The mean of absolute values, not of squares: slip is the outlier here. `None` where the log does not
/// turn enough, or the best offset is at the end of the range (±0.5 s).
///
/// # Errors
/// The first of the samples, or a robot that means over windows refuse.
pub fn gyro_offset<E: From<grouser_slip::Error>>(
    robot: &Robot,
    sensor: WheelSensor,
    samples: impl IntoIterator<Item = Result<Sample, E>>,
) -> Result<Option<f64>, E> {
    let (encoders, gyro) = turns(robot, sensor, samples)?;
    let size = encoders.iter().map(|turn| turn.1.abs()).sum::<f64>() / encoders.len().max(1) as f64;
    // The same windows for every offset, or the ends of the log would choose it.
    let margin = RANGE_S + STEP_S + 0.5 * WINDOW_S;
    let is_covered = |of: &&(f64, f64)| gyro.between(of.0 - margin, of.0 + margin).is_finite();
    let encoders: Vec<(f64, f64)> = encoders.iter().filter(is_covered).copied().collect();
    if encoders.is_empty() || !(size * WINDOW_S > MIN_TURN_RAD) {
        return Ok(None);
    }
    let cost = |offset: f64| disagreement(&encoders, &gyro, offset);
    let best = |middle: f64, half: f64, step: f64| {
        let count = (half / step).round();
        let mut least = (f64::INFINITY, middle);
        let mut k = -count;
        while k <= count {
            let offset = middle + k * step;
            let here = cost(offset);
            if here < least.0 {
                least = (here, offset);
            }
            k += 1.0;
        }
        least.1
    };
    let coarse = best(0.0, RANGE_S, STEP_S);
    if coarse.abs() > RANGE_S - 1.5 * STEP_S {
        return Ok(None);
    }
    Ok(Some(best(coarse, STEP_S, 0.1 * STEP_S)))
}

/// Yaw rate by the wheels in windows around a time, s and rad/s, and the turn by the gyro.
type Turns = (Vec<(f64, f64)>, Track);

fn turns<E: From<grouser_slip::Error>>(
    robot: &Robot,
    sensor: WheelSensor,
    samples: impl IntoIterator<Item = Result<Sample, E>>,
) -> Result<Turns, E> {
    let settings = WindowSettings {
        reference: Reference::Grip,
        window: WINDOW_S,
        ..WindowSettings::default()
    };
    let mut estimator = WindowEstimator::new(robot, settings)?;
    let last_powered = robot
        .wheels()
        .iter()
        .rposition(|wheel| wheel.role == WheelRole::Powered);
    let (mut encoders, mut gyro, mut readings) = (Vec::new(), Track::default(), 0);
    let mut start_ns = None;
    let mut last: Option<(f64, f64)> = None;
    for sample in samples {
        let sample = sample?;
        let start = *start_ns.get_or_insert(sample.time_ns);
        let time = sample.time_ns.saturating_sub(start) as f64 * 1e-9;
        if !sensor.uses(&sample.measurement) {
            continue;
        }
        if let Measurement::YawRate { rate } = sample.measurement {
            let passed = last
                .replace((time, rate))
                .map_or(0.0, |(before, rate_before)| {
                    0.5 * (rate + rate_before) * (time - before)
                });
            gyro.add(time, passed);
            readings += 1;
        } else if sample.measurement.is_rotation() {
            // Only the wheels are shown to this estimator: a refused sample is no matter here.
            if let Ok(estimate) = estimator.update(sample)
                && sample.measurement.wheel() == last_powered
                && let Some(rate) = estimate.body.wheels_yaw_rate
                && encoders.len() < MAX_READINGS
            {
                encoders.push((time - 0.5 * WINDOW_S, rate.value));
            }
        }
        if encoders.len() >= MAX_READINGS && readings >= MAX_READINGS {
            break;
        }
    }
    Ok((encoders, gyro))
}

/// Mean |turn by encoders − turn by gyro|, rad, if the gyro's clock is ahead by `offset`.
fn disagreement(encoders: &[(f64, f64)], gyro: &Track, offset: f64) -> f64 {
    let apart = encoders.iter().map(|(time, rate)| {
        let middle = time + offset;
        let turn = gyro.between(middle - 0.5 * WINDOW_S, middle + 0.5 * WINDOW_S);
        (rate * WINDOW_S - turn).abs()
    });
    apart.sum::<f64>() / encoders.len() as f64
}
