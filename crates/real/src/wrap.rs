//! Angles within one turn.

use crate::real::Real;

/// The same direction as `angle` (rad), in (−π, π].
///
/// ```
/// use std::f64::consts::{PI, TAU};
///
/// let turn = grouser_real::wrap_angle(0.3 - TAU);
/// assert!((turn - 0.3).abs() < 1e-15 && grouser_real::wrap_angle(PI) == PI);
/// assert_eq!(grouser_real::wrap_angle(-2.1), -2.1);
/// ```
#[must_use]
pub fn wrap_angle(angle: f64) -> f64 {
    if angle.abs() <= f64::PI {
        return angle;
    }
    let (sin, cos) = Real::sin_cos(angle);
    Real::atan2(sin, cos)
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{PI, TAU};

    use super::*;

    #[test]
    fn a_direction_stays_and_is_within_half_a_turn() {
        for angle in [-PI, -2.1, 0.0, 1e-300, 0.3, PI] {
            assert_eq!(wrap_angle(angle), angle);
        }
        for turns in [-3.0, -1.0, 1.0, 2.0] {
            for angle in [-2.1, 0.3, 3.0] {
                assert!((wrap_angle(angle + turns * TAU) - angle).abs() < 1e-14);
            }
        }
        assert!(wrap_angle(PI.next_up()) < -3.0);
    }
}
