//! The robot's planar motion, and what it means at each wheel.

use crate::speed::Measured;

/// A planar motion (v_x, v_y, Ω) of the robot's frame with its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion {
    /// Forwards m/s, to the left m/s, turning left rad/s.
    pub velocity: [f64; 3],
    /// Covariance of the three.
    pub covariance: [[f64; 3]; 3],
}

impl BodyMotion {
    /// The motion along `row`: for a wheel's [`speed_row`](crate::Wheel::speed_row) the speed of its
    /// centre along its heading, v_i = e_i · (v_body + Ω × p_i).
    ///
    /// ```
    /// use grouser_slip::{BodyMotion, Wheel};
    ///
    /// // 0.2 m/s ahead while turning left at 0.5 rad/s: a wheel 0.3 m to the left moves slower.
    /// let motion = BodyMotion { velocity: [0.2, 0.0, 0.5], covariance: [[0.0; 3]; 3] };
    /// let left = Wheel::powered("left").at(0.0, 0.3);
    /// assert!((motion.along(left.speed_row()).value - 0.05).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn along(&self, row: [f64; 3]) -> Measured {
        let mut variance = 0.0;
        for (i, line) in self.covariance.iter().enumerate() {
            variance += row[i] * dot(*line, row);
        }
        Measured {
            value: dot(self.velocity, row),
            variance: variance.max(0.0),
        }
    }
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A part of a motion with a larger variance is not fixed, (m/s)² or (rad/s)²: wheels that are steered by a billionth of a radian show
/// no sideways speed.
const MAX_VARIANCE: f64 = 1e9;

/// Weighted least squares for a planar motion: what several sensors say of row · (v_x, v_y, Ω),
/// each with its variance, in information form.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Observations {
    information: [[f64; 3]; 3],
    weighted: [f64; 3],
}

impl Observations {
    /// Adds one observation; a variance below 1e-12 counts as 1e-12 (a micrometre a second).
    pub(crate) fn add(&mut self, row: [f64; 3], seen: Measured) {
        let weight = 1.0 / seen.variance.max(1e-12);
        for i in 0..3 {
            for j in 0..3 {
                self.information[i][j] += weight * row[i] * row[j];
            }
            self.weighted[i] += weight * row[i] * seen.value;
        }
    }

    /// The most likely motion; `None` when the observations do not fix all three parts.
    pub(crate) fn solve(&self) -> Option<BodyMotion> {
        let covariance = inverse(self.information)?;
        let velocity = [0, 1, 2].map(|i| dot(covariance[i], self.weighted));
        let is_fixed = |i: usize| velocity[i].is_finite() && covariance[i][i] <= MAX_VARIANCE;
        (0..3).all(is_fixed).then_some(BodyMotion {
            velocity,
            covariance,
        })
    }
}

/// Inverse of a symmetric positive definite matrix, scaled to a unit diagonal first so that
/// metres and radians may differ by any factor.
fn inverse(m: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let mut scale = [0.0; 3];
    for i in 0..3 {
        // `!` so that NaN is refused as well
        if !(m[i][i] > 0.0 && m[i][i].is_finite()) {
            return None;
        }
        scale[i] = 1.0 / grouser_real::Real::sqrt(m[i][i]);
    }
    let (a, b, c) = (
        m[0][1] * scale[0] * scale[1],
        m[0][2] * scale[0] * scale[2],
        m[1][2] * scale[1] * scale[2],
    );
    let determinant = 1.0 + 2.0 * a * b * c - a * a - b * b - c * c;
    if !(determinant > 1e-12) {
        return None;
    }
    let adjugate = [
        [1.0 - c * c, b * c - a, a * c - b],
        [b * c - a, 1.0 - b * b, a * b - c],
        [a * c - b, a * b - c, 1.0 - a * a],
    ];
    let mut out = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = adjugate[i][j] / determinant * scale[i] * scale[j];
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_is_one_and_what_has_none_is_refused() {
        // positive definite, each with other signs of the correlations; units that differ by a factor of 1e6
        for (a, b, c) in [
            (0.3, 0.5, 0.2),
            (-0.4, 0.1, 0.6),
            (0.7, -0.2, -0.3),
            (0.0, 0.0, 0.9),
        ] {
            let unit = [1e-3, 2.0, 1e3];
            let correlation = [[1.0, a, b], [a, 1.0, c], [b, c, 1.0]];
            let m = [0, 1, 2].map(|i| [0, 1, 2].map(|j| correlation[i][j] * unit[i] * unit[j]));
            let inverse = inverse(m).unwrap();
            for i in 0..3 {
                for j in 0..3 {
                    let product: f64 = (0..3).map(|k| m[i][k] * inverse[k][j]).sum();
                    let expected = f64::from(u8::from(i == j));
                    assert!((product * unit[j] / unit[i] - expected).abs() < 1e-12);
                }
            }
        }
        let diagonal = |first| [[first, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for first in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            assert_eq!(inverse(diagonal(first)), None, "{first}");
        }
        let singular = [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(inverse(singular), None);
    }
    /// Of rows that are turned by a ten-thousandth the sideways speed is known badly, and by almost nothing not at all.
    #[test]
    fn a_part_that_hardly_shows_is_not_fixed() {
        let mut turned = Observations::default();
        for (row, value) in [
            ([1.0, 0.0, 0.0], 0.3),
            ([1.0, 1e-4, 0.0], 0.3),
            ([0.0, 0.0, 1.0], 0.2),
        ] {
            let variance = 1.0;
            turned.add(row, Measured { value, variance });
        }
        let found = turned.solve().unwrap();
        assert!(found.covariance[1][1] < 2.1e8 && found.velocity[1].abs() < 1e-6);
        let seen = Measured {
            value: 0.3,
            variance: 1.0,
        };
        let mut alike = Observations::default();
        alike.add([0.0, 0.0, 1.0], seen);
        alike.add([1.0, 0.0, 0.0], seen);
        alike.add([0.0, 6e-67, 0.0], seen);
        assert_eq!(alike.solve(), None);
    }
}
