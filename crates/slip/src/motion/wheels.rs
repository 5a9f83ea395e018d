//! The common motion of the wheels over a step: the direction in which they run and how far.

use grouser_real::{Real, solve};

use super::belief::dot;
use super::step::WheelStep;

/// The common motion of the wheels over a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CommonMotion {
    /// Distance by the wheels along [`Self::direction`], m.
    pub distance: f64,
    /// Direction in the robot's frame, rad.
    pub direction: f64,
    /// Turn by the wheels alone, rad; `None` where the wheels cannot show one.
    pub turn: Option<f64>,
    /// Variance of that turn by the scatter of the wheels about it, rad².
    pub turn_variance: f64,
    /// Variance of the distance, m².
    pub variance: f64,
    /// Turn by the gyro, else by the wheels, without a correction of the bias, rad.
    pub turned: f64,
}

/// A wheel slower than this has no slip of its own to show, m/s: a few ticks a second.
pub const MIN_SPEED: f64 = 0.01;
/// Variances of a wheel's speed over ground are compared with the square of that speed, which counts as this at least, m²/s².
pub const MIN_SQUARED_SPEED: f64 = MIN_SPEED * MIN_SPEED;

/// Two headings of wheels differ by less than this where the wheels are parallel: the sine.
const PARALLEL_SINE: f64 = 0.02;

/// Wheels run at this multiple of the robot's speed at most where their part in a turn is concerned: beyond, a turn is theirs alone.
const MAX_WHEEL_SHARE: f64 = 10.0;
/// Wheels move along themselves: the weight of no sideways speed against a wheel's own speed.
const SIDEWAYS_WEIGHT: f64 = 1e-2;
/// Rounds of the weights: by then one wheel of five that contradicts the others moves the result by a hundredth of its error.
const ROUNDS: usize = 6;
/// The speed of wheels over a step differs from what slip and speed give by this share of it: lugs, play of gears, clocks that
/// disagree by a millisecond. A prior: steps of 50 ms of Robotino, optiodom and a mower scatter by one to four hundredths.
pub const JITTER: f64 = 0.02;
/// The weight of a gyro's turn against a wheel's distance, 1/m².
const TURN_WEIGHT: f64 = 1e4;
/// Shorter distances have no direction, m.
const MIN_DISTANCE: f64 = 1e-5;
/// Parallel wheels scrub in a turn: it is wrong by about this share of it (a skid-steered robot turns half as far as its wheels say).
const SCRUB: f64 = 0.3;
/// Levers of parallel wheels that scatter by less than this show no turn, m².
const MIN_LEVER_SCATTER: f64 = 1e-6;

/// The common motion of the powered wheels; `turn` is the robot's turn over the step (rad), `share` its speed over that of its
/// wheels, `last` the direction that holds while the wheels are stationary.
#[must_use]
pub fn common_motion(
    wheels: &[WheelStep],
    turn: Option<f64>,
    share: f64,
    last: f64,
    scratch: &mut [f64],
) -> Option<CommonMotion> {
    let used = || {
        wheels
            .iter()
            .filter(|wheel| !wheel.is_free && wheel.distance.is_some())
    };
    let first = used().next()?.row;
    let count = used().count();
    let parallel = are_parallel(used());
    let by_wheels = turn_by_wheels(used());
    let turn_variance = by_wheels.map_or(0.0, |of| of[1] * share * share);
    let by_wheels = by_wheels.map(|of| of[0]);
    let share = share.max(1.0 / MAX_WHEEL_SHARE);
    let turned = turn.map(|turn| turn / share).or(by_wheels).unwrap_or(0.0);
    if parallel {
        let mut n = 0;
        let mut variance = 0.0;
        for wheel in used() {
            let level = wheel.distance.unwrap_or(0.0) - turned * wheel.row[2] - wheel.swing / share;
            scratch[n] = level;
            variance += wheel.variance;
            n += 1;
        }
        let levels = &mut scratch[..n];
        levels.sort_unstable_by(f64::total_cmp);
        let distance = if n % 2 == 1 {
            levels[n / 2]
        } else {
            0.5 * (levels[n / 2 - 1] + levels[n / 2])
        };
        return Some(CommonMotion {
            distance,
            direction: Real::atan2(first[1], first[0]),
            turn: by_wheels.map(|t| t * share),
            turn_variance,
            variance: variance / (count * count) as f64,
            turned: 0.0,
        });
    }
    // wheels in several directions: the least sum of distances off (x, y, turn) by weights, the turn given where a gyro measures it
    let variance: f64 = used().map(|wheel| wheel.variance).sum();
    let mut found = [0.0; 3];
    for round in 0..ROUNDS {
        let (mut a, mut b) = ([[0.0; 3]; 3], [0.0; 3]);
        let like = Real::sqrt(variance) + JITTER * Real::hypot(found[0], found[1]);
        for wheel in used() {
            let level = wheel.distance.unwrap_or(0.0) - wheel.swing / share;
            let off = level - dot(&wheel.row, &found);
            let weight = if round == 0 || off.abs() <= like {
                1.0
            } else {
                like / off.abs()
            };
            add_equation(&mut a, &mut b, wheel.row, level, weight);
            if !wheel.is_omni {
                add_equation(&mut a, &mut b, wheel.across, 0.0, SIDEWAYS_WEIGHT);
            }
        }
        if turn.is_some() {
            add_equation(&mut a, &mut b, [0.0, 0.0, 1.0], turned, TURN_WEIGHT);
        }
        found = solve(a, b)?;
    }
    let [x, y, z] = found;
    let size = Real::hypot(x, y);
    let is_omni = wheels.iter().any(|wheel| wheel.is_omni);
    // wheels that roll one way go forwards and backwards, others in any direction
    let sign = if is_omni || x >= 0.0 { 1.0 } else { -1.0 };
    let direction = if size > MIN_DISTANCE {
        Real::atan2(sign * y, sign * x)
    } else {
        last
    };
    let distance = sign * size;
    Some(CommonMotion {
        distance,
        direction,
        // next to a gyro it is that of the gyro
        turn: turn.is_none().then_some(z * share),
        turn_variance: 0.0,
        variance: variance / (count * count) as f64,
        turned: 0.0,
    })
}

/// The turn by the powered wheels, rad; `None` where they are not parallel or cannot show one.
#[must_use]
pub fn turn_by_parallel_wheels(wheels: &[WheelStep]) -> Option<f64> {
    let used = || {
        wheels
            .iter()
            .filter(|of| !of.is_free && of.distance.is_some())
    };
    let turn = turn_by_wheels(used()).filter(|_| are_parallel(used()));
    turn.map(|[turn, _]| turn)
}

fn are_parallel<'a>(mut wheels: impl Iterator<Item = &'a WheelStep>) -> bool {
    let Some(WheelStep { row: [x, y, _], .. }) = wheels.next() else {
        return false;
    };
    wheels.all(|of| (x * of.row[1] - y * of.row[0]).abs() < PARALLEL_SINE)
}

/// Adds an equation row · (x, y, turn) = value to the normal equations.
pub fn add_equation(
    a: &mut [[f64; 3]; 3],
    b: &mut [f64; 3],
    row: [f64; 3],
    value: f64,
    weight: f64,
) {
    for i in 0..3 {
        for j in 0..3 {
            a[i][j] += weight * row[i] * row[j];
        }
        b[i] += weight * row[i] * value;
    }
}

/// The turn that parallel wheels at different distances from the middle show, and its variance by their scatter about it.
fn turn_by_wheels<'a>(wheels: impl Iterator<Item = &'a WheelStep> + Clone) -> Option<[f64; 2]> {
    let n = wheels.clone().count() as f64;
    let mean = |f: &dyn Fn(&WheelStep) -> f64| wheels.clone().map(f).sum::<f64>() / n;
    let lever = mean(&|w| w.row[2]);
    let level = mean(&|w| w.distance.unwrap_or(0.0) - w.swing);
    let (mut below, mut above) = (0.0, 0.0);
    for wheel in wheels.clone() {
        let off = wheel.row[2] - lever;
        below += off * off;
        above += off * (wheel.distance.unwrap_or(0.0) - wheel.swing - level);
    }
    if below <= MIN_LEVER_SCATTER {
        return None;
    }
    let turn = above / below;
    let square = |wheel: &WheelStep| {
        let left =
            wheel.distance.unwrap_or(0.0) - wheel.swing - level - turn * (wheel.row[2] - lever);
        left * left
    };
    let scatter = wheels.map(square).sum::<f64>() / (n - 2.0).max(1.0);
    let scrub = SCRUB * turn;
    Some([turn, scatter / below + scrub * scrub])
}
