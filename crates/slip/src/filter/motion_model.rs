//! The robot's motion in the filter: speeds, yaw rate and the biases of what measures them.

use grouser_real::Real;

use super::kalman::{Kalman, ScalarMeasurement};
use super::settings::{FilterSettings, SlipPrior};

pub(super) const FORWARD: usize = 0;
pub(super) const LEFT: usize = 1;
pub(super) const YAW: usize = 2;
pub(super) const GYRO_BIAS: usize = 3;
pub(super) const FORWARD_BIAS: usize = 4;
pub(super) const LEFT_BIAS: usize = 5;
/// The powered wheels' common slip.
pub(super) const COMMON_SLIP: usize = 6;
/// Where the robot is, m, and where it heads, rad, from where it began; after these come each wheel's numbers.
pub(super) const PLACE: [usize; 2] = [7, 8];
pub(super) const HEADING: usize = 9;

/// Numbers of one wheel.
pub(super) const PER_WHEEL: usize = 4;

/// The wheel's own slip, beside the common one.
pub(super) const fn own_slip(wheel: usize) -> usize {
    HEADING + 1 + PER_WHEEL * wheel
}

/// How much larger its radius is than told, as a share.
pub(super) const fn radius(wheel: usize) -> usize {
    own_slip(wheel) + 1
}

/// How far its rim was from the counter's last tick at the end of a window (m), for two windows in turn.
pub(super) const fn remainder(wheel: usize, odd: bool) -> usize {
    if odd {
        own_slip(wheel) + 3
    } else {
        own_slip(wheel) + 2
    }
}

/// Specific force in the robot's frame and its time, for the next steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heard {
    pub(super) time_ns: i64,
    pub(super) force: [f64; 2],
}

/// All that is unknown of the robot's motion at the start.
pub(super) fn start(state: &mut Kalman, settings: &FilterSettings) {
    let square = |x: f64| x * x;
    for i in [FORWARD, LEFT] {
        state.reset(i, 0.0, square(1.0_f64.min(settings.max_speed)));
    }
    for i in [PLACE[0], PLACE[1], HEADING] {
        state.set_considered(i, true);
    }
    state.reset(YAW, 0.0, 1.0);
    state.reset(GYRO_BIAS, 0.0, square(settings.gyro_bias));
    for i in [FORWARD_BIAS, LEFT_BIAS] {
        state.reset(i, 0.0, square(settings.accelerometer_bias));
    }
}

/// How many numbers there are for so many wheels.
pub(super) const fn size(wheels: usize) -> usize {
    own_slip(wheels)
}

/// Time has begun anew: where the robot is has nothing to do any more with how fast it is, and it may have moved by `apart`
/// (m) meanwhile, turned by `turned` (rad).
pub(super) fn restart_place(state: &mut Kalman, apart: f64, turned: f64) {
    let square = |x: f64| x * x;
    for (i, off) in [(PLACE[0], apart), (PLACE[1], apart), (HEADING, turned)] {
        let (mean, variance) = (state.mean(i), state.covariance(i, i));
        state.reset(i, mean, variance + square(off));
    }
}

/// Moves the robot's place on by `dt` (s). It is the integral of the speeds, with the covariance that follows from theirs; no
/// reading moves it back, for the wheels' residuals, which last, would push it reading by reading.
fn travel(state: &mut Kalman, dt: f64) {
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
    for (i, gone) in [
        (PLACE[0], step[0]),
        (PLACE[1], step[1]),
        (HEADING, yaw * dt),
    ] {
        state.set_mean(i, (state.mean(i) + gone).clamp(-FARTHEST, FARTHEST));
        // a place that is not known at all needs no more doubt
        state.hold_variance(i, FARTHEST * FARTHEST);
    }
}

/// No odometry goes farther than this, m or rad.
const FARTHEST: f64 = 1e9;

/// Moves the robot on by `dt` (s): with an accelerometer by what it feels, else by chance. Gives how much its
/// speeds have changed by what was felt, m/s.
pub(super) fn advance(
    state: &mut Kalman,
    settings: &FilterSettings,
    dt: f64,
    heard: Option<Heard>,
    walk: f64,
) -> [f64; 2] {
    let yaw = state.mean(YAW);
    let (v_x, v_y) = (state.mean(FORWARD), state.mean(LEFT));
    let most = settings.max_speed;
    let mut felt = [0.0; 2];
    travel(state, dt);
    if let Some(Heard {
        force: [a_x, a_y], ..
    }) = heard
    {
        // a turning frame: v̇ = a − Ω × v
        let rise_x = a_x - state.mean(FORWARD_BIAS) + yaw * v_y;
        let rise_y = a_y - state.mean(LEFT_BIAS) - yaw * v_x;
        felt = [rise_x * dt, rise_y * dt];
        state.propagate(FORWARD, FORWARD_BIAS, -dt);
        state.propagate(LEFT, LEFT_BIAS, -dt);
        state.set_mean(FORWARD, (v_x + felt[0]).clamp(-most, most));
        state.set_mean(LEFT, (v_y + felt[1]).clamp(-most, most));
    }
    let square = |x: f64| x * x;
    for i in [FORWARD, LEFT] {
        state.inflate(i, square(walk) * dt, square(most));
    }
    state.inflate(YAW, square(settings.yaw_walk) * dt, 1e4);
    state.inflate(
        GYRO_BIAS,
        square(settings.gyro_drift) * dt,
        square(settings.gyro_bias),
    );
    for i in [FORWARD_BIAS, LEFT_BIAS] {
        state.inflate(
            i,
            square(settings.accelerometer_drift) * dt,
            square(settings.accelerometer_bias),
        );
    }
    felt
}

/// How long doubt about a free wheel's skid lasts, s.
const DOUBT: f64 = 10.0;

/// Is a free wheel's skid less certain than was told?
pub(super) fn is_doubted(state: &Kalman, settings: &FilterSettings, wheel: usize) -> bool {
    let SlipPrior { sigma, .. } = settings.free_slip.by_rim();
    state.covariance(own_slip(wheel), own_slip(wheel)) > 2.0 * sigma * sigma
}

/// Moves the slips on by `dt` (s): each is drawn towards what is believed of it. Of each wheel: is it free, and how much
/// more does its slip wander than was told?
pub(super) fn advance_slips(
    state: &mut Kalman,
    settings: &FilterSettings,
    dt: f64,
    wheels: impl Iterator<Item = (bool, f64)>,
) {
    let draw = |state: &mut Kalman, i: usize, mean: f64, sigma: f64, memory: f64| {
        let a = Real::exp(-dt / memory);
        state.decay(i, mean, a);
        state.inflate(i, (1.0 - a * a) * sigma * sigma, f64::MAX);
    };
    draw(
        state,
        COMMON_SLIP,
        settings.slip.mean,
        settings.slip.sigma,
        settings.slip_memory,
    );
    for (wheel, (free, unrest)) in wheels.enumerate() {
        if free {
            let prior = settings.free_slip.by_rim();
            // doubt about its skid does not last
            let memory = if is_doubted(state, settings, wheel) {
                DOUBT.min(settings.free_slip_memory)
            } else {
                settings.free_slip_memory
            };
            draw(state, own_slip(wheel), prior.mean, prior.sigma, memory);
        } else {
            draw(
                state,
                own_slip(wheel),
                0.0,
                settings.wheel_slip_sigma * Real::sqrt(unrest),
                settings.wheel_slip_memory,
            );
        }
    }
}

/// The robot's speed along `row` · (v_x, v_y, Ω).
pub(super) fn along(row: [f64; 3]) -> [(usize, f64); 3] {
    [(FORWARD, row[0]), (LEFT, row[1]), (YAW, row[2])]
}

/// A pseudo-measurement: the robot's speed along `row` is `value` within `sigma`.
pub(super) fn hold(state: &mut Kalman, row: [f64; 3], value: f64, sigma: f64) {
    let slopes = along(row);
    let predicted: f64 = slopes.iter().map(|&(i, a)| a * state.mean(i)).sum();
    state.update(&ScalarMeasurement {
        jacobian: &slopes,
        residual: value - predicted,
        variance: sigma * sigma,
    });
}
