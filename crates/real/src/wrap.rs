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
