//! What samples say of motion: of a wheel between two readings, of a pose, of wheels that drive in one direction.

use grouser_real::{Real, wrap_angle};
use grouser_slip::{Measurement, Robot, Wheel, WheelRole};

/// How far a wheel turned between two readings, m; a rate counts as the mean since the reading before, as the filter takes it.
/// NaN of readings that have nothing in common.
///
/// ```
/// use grouser_slip::{Measurement, Wheel};
///
/// let wheel = Wheel::powered("left").radius(0.1);
/// let reading = |rate| Measurement::WheelRate { wheel: 0, rate };
/// assert_eq!(grouser_doctor::wheel_travel(&wheel, &reading(3.0), &reading(2.0), 0.5), 0.1);
/// ```
#[must_use]
pub fn wheel_travel(wheel: &Wheel, last: &Measurement, now: &Measurement, passed_s: f64) -> f64 {
    match (last, now) {
        (Measurement::WheelCount { raw: from, .. }, Measurement::WheelCount { raw: to, .. }) => {
            let ticks = wheel.encoder.counter.step(*from, *to) as f64;
            ticks * wheel.travel_per_tick().unwrap_or(f64::NAN)
        }
        (
            Measurement::WheelAngle { angle: from, .. },
            Measurement::WheelAngle { angle: to, .. },
        ) => (to - from) * wheel.travel_per_radian(),
        (_, Measurement::WheelRate { rate, .. }) => rate * wheel.travel_per_radian() * passed_s,
        _ => f64::NAN,
    }
}

/// Cosine and sine of the heading of the first powered wheel, where the other ones' differ from it by an angle with more than
/// this cosine.
pub(crate) fn common_heading(robot: &Robot, min_cosine: f64) -> Option<[f64; 2]> {
    let mut powered = robot
        .wheels()
        .iter()
        .filter(|wheel| wheel.role == WheelRole::Powered)
        .map(|wheel| [wheel.heading.cos(), wheel.heading.sin()]);
    let first = powered.next()?;
    let is_parallel = |e: [f64; 2]| first[0] * e[0] + first[1] * e[1] > min_cosine;
    powered.all(is_parallel).then_some(first)
}

/// Way forwards and to the left (m), in the robot's frame halfway, and turn (rad) from one pose to another.
pub(crate) fn displacement(from: [f64; 3], to: [f64; 3]) -> ([f64; 2], f64) {
    let turn = wrap_angle(to[2] - from[2]);
    let (sin, cos) = Real::sin_cos(from[2] + 0.5 * turn);
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    ([cos * dx + sin * dy, cos * dy - sin * dx], turn)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, SQRT_2};

    use super::displacement;

    #[test]
    fn a_displacement_is_that_of_the_arc_between_two_poses() {
        // a quarter of a circle of 1 m to the left has a chord of √2 m, whichever way the robot heads
        for heading in [0.0, 1.0, 0.75 * PI, 0.9 * PI, -0.9 * PI] {
            let from = [3.0, -2.0, heading];
            let (sin, cos) = f64::sin_cos(heading + 0.25 * PI);
            let mut to = heading + 0.5 * PI;
            if to > PI {
                to -= 2.0 * PI;
            }
            let to = [from[0] + SQRT_2 * cos, from[1] + SQRT_2 * sin, to];
            let ([forward, left], turn) = displacement(from, to);
            assert!(
                (forward - SQRT_2).abs() < 1e-14 && left.abs() < 1e-14,
                "{heading}"
            );
            assert!((turn - 0.5 * PI).abs() < 1e-14, "{heading}: {turn}");
        }
    }
}
