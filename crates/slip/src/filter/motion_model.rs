//! The numbers of the Kalman filter and their process model: the robot's motion, the biases of its sensors, and the slips.

use grouser_real::Real;

use super::accelerometer::SpecificForce;
use super::kalman::{Kalman, ScalarMeasurement};
use super::settings::{FilterSettings, SlipPrior};

/// Speeds forwards and to the left, m/s, and yaw rate, rad/s.
pub(super) const FORWARD: usize = 0;
pub(super) const LEFT: usize = 1;
pub(super) const YAW: usize = 2;
/// Biases of the gyro, rad/s, and of the accelerometer, m/s².
pub(super) const GYRO_BIAS: usize = 3;
pub(super) const FORWARD_BIAS: usize = 4;
pub(super) const LEFT_BIAS: usize = 5;
/// The powered wheels' common slip.
pub(super) const COMMON_SLIP: usize = 6;
/// Position, m, and heading, rad, from the start. They are considered, not estimated. Each wheel's numbers follow.
pub(super) const PLACE: [usize; 2] = [7, 8];
pub(super) const HEADING: usize = 9;

/// Numbers of one wheel.
const PER_WHEEL: usize = 4;
/// The robot's speed at the start is within this of zero, m/s, and its yaw rate within this, rad/s.
const START_SPEED_SIGMA_M_PER_S: f64 = 1.0;
const START_YAW_RATE_SIGMA_RAD_PER_S: f64 = 1.0;
/// The variance of a yaw rate that nothing measures stays below this, rad²/s².
const MAX_YAW_RATE_VARIANCE: f64 = 1e4;
/// No odometry goes farther than this, m or rad.
const MAX_PLACE: f64 = 1e9;
/// How long an inflated skid of a free wheel lasts, s.
const SKID_DOUBT_MEMORY_S: f64 = 10.0;

/// The wheel's own slip, beside the common one.
pub(super) const fn own_slip(wheel: usize) -> usize {
    HEADING + 1 + PER_WHEEL * wheel
}

/// The share by which its radius is larger than described.
pub(super) const fn radius(wheel: usize) -> usize {
    own_slip(wheel) + 1
}

/// The travel of its rim since the counter's last tick at the end of a window (m), for two windows in turn.
pub(super) const fn remainder(wheel: usize, odd: bool) -> usize {
    if odd {
        own_slip(wheel) + 3
    } else {
        own_slip(wheel) + 2
    }
}

/// The number of numbers for this many wheels.
pub(super) const fn size(wheels: usize) -> usize {
    own_slip(wheels)
}

/// Sets the motion and the biases to their priors.
pub(super) fn reset(state: &mut Kalman, settings: &FilterSettings) {
    let square = |x: f64| x * x;
    for i in [FORWARD, LEFT] {
        state.reset(
            i,
            0.0,
            square(START_SPEED_SIGMA_M_PER_S.min(settings.max_speed)),
        );
    }
    for i in [PLACE[0], PLACE[1], HEADING] {
        state.set_considered(i, true);
    }
    state.reset(YAW, 0.0, square(START_YAW_RATE_SIGMA_RAD_PER_S));
    state.reset(GYRO_BIAS, 0.0, square(settings.gyro_bias));
    for i in [FORWARD_BIAS, LEFT_BIAS] {
        state.reset(i, 0.0, square(settings.accelerometer_bias));
    }
}

/// Decorrelates the place from the motion where the clock was set: the robot may have moved by `moved` (m) and turned by
/// `turned` (rad) meanwhile.
pub(super) fn reset_place(state: &mut Kalman, moved: f64, turned: f64) {
    let square = |x: f64| x * x;
    for (i, off) in [(PLACE[0], moved), (PLACE[1], moved), (HEADING, turned)] {
        let (mean, variance) = (state.mean(i), state.covariance(i, i));
        state.reset(i, mean, variance + square(off));
    }
}

/// Moves the place on by `dt` (s): the integral of the speeds, with the covariance that follows from theirs. Measurements do
/// not move it back: the wheels' residuals, which last, would push it reading by reading.
fn integrate_place(state: &mut Kalman, dt: f64) {
    let [v_x, v_y, yaw] = [FORWARD, LEFT, YAW].map(|i| state.mean(i));
    let (sin, cos) = Real::sin_cos(state.mean(HEADING) + 0.5 * yaw * dt);
    let step = [(cos * v_x - sin * v_y) * dt, (sin * v_x + cos * v_y) * dt];
    state.propagate(PLACE[0], HEADING, -step[1]);
    state.propagate(PLACE[1], HEADING, step[0]);
    state.propagate(PLACE[0], FORWARD, cos * dt);
    state.propagate(PLACE[0], LEFT, -sin * dt);
    state.propagate(PLACE[1], FORWARD, sin * dt);
    state.propagate(PLACE[1], LEFT, cos * dt);
    state.propagate(HEADING, YAW, dt);
    for (i, moved) in [
        (PLACE[0], step[0]),
        (PLACE[1], step[1]),
        (HEADING, yaw * dt),
    ] {
        state.set_mean(i, (state.mean(i) + moved).clamp(-MAX_PLACE, MAX_PLACE));
        state.limit_variance(i, MAX_PLACE * MAX_PLACE);
    }
}

/// Predicts the motion after `dt` (s): by the specific force where there is one, and by the process noise `density` (m/s
/// per √s). Returns the change of the speeds by the force, m/s.
pub(super) fn predict(
    state: &mut Kalman,
    settings: &FilterSettings,
    dt: f64,
    force: Option<SpecificForce>,
    density: f64,
) -> [f64; 2] {
    let yaw = state.mean(YAW);
    let (v_x, v_y) = (state.mean(FORWARD), state.mean(LEFT));
    let limit = settings.max_speed;
    let mut gained = [0.0; 2];
    integrate_place(state, dt);
    if let Some(SpecificForce {
        force: [a_x, a_y], ..
    }) = force
    {
        // in a turning frame: v̇ = a − Ω × v
        let rise_x = a_x - state.mean(FORWARD_BIAS) + yaw * v_y;
        let rise_y = a_y - state.mean(LEFT_BIAS) - yaw * v_x;
        gained = [rise_x * dt, rise_y * dt];
        state.propagate(FORWARD, FORWARD_BIAS, -dt);
        state.propagate(LEFT, LEFT_BIAS, -dt);
        state.set_mean(FORWARD, (v_x + gained[0]).clamp(-limit, limit));
        state.set_mean(LEFT, (v_y + gained[1]).clamp(-limit, limit));
    }
    let square = |x: f64| x * x;
    for i in [FORWARD, LEFT] {
        state.inflate(i, square(density) * dt, square(limit));
    }
    state.inflate(YAW, square(settings.yaw_walk) * dt, MAX_YAW_RATE_VARIANCE);
    let bias = square(settings.gyro_bias);
    state.inflate(GYRO_BIAS, square(settings.gyro_drift) * dt, bias);
    for i in [FORWARD_BIAS, LEFT_BIAS] {
        let bias = square(settings.accelerometer_bias);
        state.inflate(i, square(settings.accelerometer_drift) * dt, bias);
    }
    gained
}

/// Is a free wheel's skid less certain than its prior?
pub(super) fn is_doubted(state: &Kalman, settings: &FilterSettings, wheel: usize) -> bool {
    let SlipPrior { sigma, .. } = settings.free_slip.by_wheel();
    state.covariance(own_slip(wheel), own_slip(wheel)) > 2.0 * sigma * sigma
}

/// Predicts the slips after `dt` (s): each decays to its prior. `wheels` are for each whether it is free, and its noise
/// scale.
pub(super) fn predict_slips(
    state: &mut Kalman,
    settings: &FilterSettings,
    dt: f64,
    wheels: impl Iterator<Item = (bool, f64)>,
) {
    let decay = |state: &mut Kalman, i: usize, prior: SlipPrior, memory: f64| {
        let a = Real::exp(-dt / memory);
        state.decay(i, prior.mean, a);
        state.inflate(i, (1.0 - a * a) * prior.sigma * prior.sigma, f64::MAX);
    };
    decay(state, COMMON_SLIP, settings.slip, settings.slip_memory);
    for (wheel, (free, noise_scale)) in wheels.enumerate() {
        let mut prior = settings.own_slip_prior(free);
        let memory = if !free {
            prior.sigma *= Real::sqrt(noise_scale);
            settings.wheel_slip_memory
        } else if is_doubted(state, settings, wheel) {
            SKID_DOUBT_MEMORY_S.min(settings.free_slip_memory)
        } else {
            settings.free_slip_memory
        };
        decay(state, own_slip(wheel), prior, memory);
    }
}

/// The robot's speed along `row` · (v_x, v_y, Ω), as a row of the state.
pub(super) fn along(row: [f64; 3]) -> [(usize, f64); 3] {
    [(FORWARD, row[0]), (LEFT, row[1]), (YAW, row[2])]
}

/// A pseudo-measurement: the robot's speed along `row` is `value` within `sigma`.
pub(super) fn hold(state: &mut Kalman, row: [f64; 3], value: f64, sigma: f64) {
    let jacobian = along(row);
    state.update(&ScalarMeasurement {
        jacobian: &jacobian,
        residual: value - state.mean_of(&jacobian),
        variance: sigma * sigma,
    });
}

#[cfg(test)]
mod tests;
