//! The motion of all rims together, along their common direction: what the models of [`super::ground_track`] are predicted by.

use grouser_real::Real;

use super::MAX_FILTER_WHEELS;
use super::multiple_model::{MIN_RIM_SHARE, TURNING_SPEED_M_PER_S};
use super::wheel_bank::{WheelBank, median};
use super::wheel_channel::WheelChannel;
use crate::body::Observations;
use crate::speed::Measured;

/// A wheel counts while its rim speed is within this share, or this many sigma, of the median.
const INLIER_SHARE: f64 = 0.2;
const INLIER_SIGMA: f64 = 3.0;
/// Rims that run against their mean do so at this multiple of it at most: where the mean nearly vanishes its slip means nothing.
const MAX_AGAINST_SHARE: f64 = 4.0;
/// Rim and robot differ by this for other reasons than slip, m/s.
const RIM_CREEP_M_PER_S: f64 = 5e-4;
/// Wheels move along themselves: the variance of their sideways speed against that of a rim. Without this a steered wheel that slips
/// more than the others turned the direction of the motion.
const SIDEWAYS_VARIANCE_SHARE: f64 = 1e-4;
/// The rims of wheels that are not parallel show their turn: the variance of the turn by that of the robot (rad²/s²) against that of a
/// rim (m²/s²). The robot's turn over its share in the rims' speed is many times theirs where it hardly moves, and would turn the
/// direction round.
const TURN_VARIANCE: f64 = 100.0;
/// Two headings of wheels differ by less than this where the wheels are parallel: the sine.
const PARALLEL_SINE: f64 = 0.02;

/// What the rims did over one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct RimStep {
    pub(super) now_ns: i64,
    /// Length, s.
    pub(super) dt: f64,
    /// Way of each rim, m.
    pub(super) ways: [f64; MAX_FILTER_WHEELS],
    /// Of the robot, rad/s.
    pub(super) yaw_rate: f64,
    /// The robot's speed over that of its rims, as estimated before.
    pub(super) rim_share: f64,
    /// Direction while the rims do not turn, beside the robot's heading, rad.
    pub(super) direction: f64,
}

/// The motion of the rims along their common direction.
pub(super) struct Rims {
    /// m.
    pub(super) way: f64,
    /// Beside the robot's heading, rad.
    pub(super) direction: f64,
    /// m/s, and its variance, m²/s².
    pub(super) speed: f64,
    pub(super) variance: f64,
    /// By how much the middle of the windows lies before the step's end, s.
    pub(super) lag: f64,
    /// Speed gained since the windows by the specific force, m/s; 0 without an accelerometer.
    pub(super) gained: f64,
    /// The greatest slip of these rims together: above 1 where some run the other way, as in a turn on the spot, and may take the
    /// robot with them.
    pub(super) max_slip: f64,
}

/// The greatest slip of rims that run at `speed` together while the slowest along it runs at `slowest`, m/s.
fn max_slip(speed: f64, slowest: f64) -> f64 {
    let against = -slowest / speed.abs().max(TURNING_SPEED_M_PER_S);
    1.0 + against.clamp(0.0, MAX_AGAINST_SHARE)
}

/// The motion of the rims over a step, over the powered wheels that agree with the median; `gained_since` is the speed gained since a
/// wheel's last window by the specific force, m/s.
pub(super) fn mean_rims(
    step: &RimStep,
    wheels: &WheelBank,
    gained_since: impl Fn(&WheelChannel) -> Option<f64>,
) -> Option<Rims> {
    let RimStep {
        now_ns, dt, ways, ..
    } = *step;
    let is_used =
        |wheel: &WheelChannel| !wheel.free && wheel.is_led_on(now_ns) && wheel.rim.is_some();
    let first = wheels.iter().find(|wheel| is_used(wheel))?.row;
    let parallel = wheels
        .iter()
        .filter(|wheel| is_used(wheel))
        .all(|wheel| (first[0] * wheel.row[1] - first[1] * wheel.row[0]).abs() < PARALLEL_SINE);
    // rims that slip run faster than the robot in its turn, too
    let turn = step.yaw_rate / step.rim_share.max(MIN_RIM_SHARE);
    let level = |wheel: &WheelChannel| {
        let (rim, _) = wheel.rim?;
        Some(Measured {
            value: rim.value - turn * wheel.row[2],
            variance: rim.variance,
        })
    };
    let levels = || (wheels.iter().filter(|wheel| is_used(wheel))).filter_map(level);
    let count = levels().count();
    let median = median(levels().map(|rim| rim.value))?;
    let is_near = |rim: Measured| {
        let limit = (INLIER_SHARE * median.abs()).max(INLIER_SIGMA * rim.sigma());
        (rim.value - median).abs() <= limit
    };
    let any_near = levels().any(is_near);
    // two sides that run apart have no wheel near their middle
    let agrees = |rim: Measured| !parallel || count < 3 || !any_near || is_near(rim);
    let mut by_way = Observations::default();
    let mut by_speed = Observations::default();
    let (mut way, mut speed, mut variance, mut used) = (0.0, 0.0, 0.0, 0.0);
    let (mut lag, mut gained) = (0.0, 0.0);
    for (index, wheel) in wheels
        .iter()
        .enumerate()
        .filter(|(_, wheel)| is_used(wheel))
    {
        let Some(rim) = level(wheel).filter(|&rim| agrees(rim)) else {
            continue;
        };
        let along = ways[index] - turn * dt * wheel.row[2];
        way += along;
        speed += rim.value;
        variance += rim.variance;
        lag += wheel.rim_lag(now_ns);
        gained += gained_since(wheel).unwrap_or(0.0);
        used += 1.0;
        if !parallel {
            let row = wheel.row;
            let of = |value| Measured {
                value,
                variance: 1.0,
            };
            by_way.add(row, of(along));
            by_speed.add(row, of(rim.value));
        }
    }
    if used < 1.0 {
        return None;
    }
    let (lag, gained) = (lag / used, gained / used);
    let variance = variance / (used * used) + RIM_CREEP_M_PER_S * RIM_CREEP_M_PER_S;
    if parallel {
        let speed = speed / used;
        let along = |wheel: &WheelChannel| Some(wheel.rim?.0.value * speed.signum());
        let rims = wheels.iter().filter(|wheel| is_used(wheel));
        let slowest = rims.filter_map(along).fold(0.0, f64::min);
        return Some(Rims {
            way: way / used,
            direction: Real::atan2(first[1], first[0]),
            speed,
            variance,
            lag,
            gained,
            max_slip: max_slip(speed, slowest),
        });
    }
    if roll_one_way(wheels) {
        for wheel in wheels.iter().filter(|wheel| is_used(wheel)) {
            let row = wheel.steering.across();
            let still = |turn: f64| Measured {
                value: -turn * row[2],
                variance: SIDEWAYS_VARIANCE_SHARE,
            };
            by_way.add(row, still(turn * dt));
            by_speed.add(row, still(turn));
        }
    }
    let (way, speed, direction) = along_one_way(by_way, by_speed, step.direction)?;
    Some(Rims {
        way,
        direction,
        speed,
        variance,
        lag,
        gained,
        max_slip: 1.0,
    })
}

/// Way (m), speed (m/s) and direction (rad) of rims that are not parallel; `direction` holds while they do not turn.
fn along_one_way(
    mut by_way: Observations,
    mut by_speed: Observations,
    direction: f64,
) -> Option<(f64, f64, f64)> {
    let turn = Measured {
        value: 0.0,
        variance: TURN_VARIANCE,
    };
    by_way.add([0.0, 0.0, 1.0], turn);
    by_speed.add([0.0, 0.0, 1.0], turn);
    let [x, y, _] = by_speed.solve()?.velocity;
    let direction = if Real::hypot(x, y) > TURNING_SPEED_M_PER_S {
        Real::atan2(y, x)
    } else {
        direction
    };
    let (sin, cos) = Real::sin_cos(direction);
    let [way_x, way_y, _] = by_way.solve()?.velocity;
    Some((cos * way_x + sin * way_y, cos * x + sin * y, direction))
}

/// Do all wheels roll one way at no steering angle, and so hardly move across? Omnidirectional wheels do not.
fn roll_one_way(wheels: &WheelBank) -> bool {
    let heading = |wheel: &WheelChannel| wheel.steering.heading;
    let first = wheels.iter().next().map_or(0.0, heading);
    wheels
        .iter()
        .all(|wheel| Real::sin(heading(wheel) - first).abs() < PARALLEL_SINE)
}

#[cfg(test)]
mod tests;
