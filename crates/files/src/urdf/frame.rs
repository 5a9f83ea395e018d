//! Places and directions: what `<origin xyz rpy>` says, composed along a chain of joints.

use grouser_real::Real;

/// Three numbers.
pub(super) type Vector = [f64; 3];
/// By rows.
pub(super) type Matrix = [[f64; 3]; 3];

/// A frame within another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) turn: Matrix,
    pub(super) place: Vector,
}

impl Frame {
    pub(super) const IDENTITY: Self = Self {
        turn: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        place: [0.0; 3],
    };

    /// Turned about the fixed axes x, y and z in this order: R = R_z(yaw) R_y(pitch) R_x(roll).
    ///
    /// Source: the URDF specification of `<origin>`.
    pub(super) fn new(place: Vector, [roll, pitch, yaw]: Vector) -> Self {
        let ((s_r, c_r), (s_p, c_p), (s_y, c_y)) = (
            Real::sin_cos(roll),
            Real::sin_cos(pitch),
            Real::sin_cos(yaw),
        );
        Self {
            turn: [
                [
                    c_y * c_p,
                    c_y * s_p * s_r - s_y * c_r,
                    c_y * s_p * c_r + s_y * s_r,
                ],
                [
                    s_y * c_p,
                    s_y * s_p * s_r + c_y * c_r,
                    s_y * s_p * c_r - c_y * s_r,
                ],
                [-s_p, c_p * s_r, c_p * c_r],
            ],
            place,
        }
    }

    /// A direction of this frame, seen from outside.
    pub(super) fn direction(&self, v: Vector) -> Vector {
        self.turn.map(|row| dot(row, v))
    }

    /// A point of this frame, seen from outside.
    pub(super) fn point(&self, v: Vector) -> Vector {
        add(self.place, self.direction(v))
    }

    /// A frame within this one, seen from outside.
    pub(super) fn then(&self, inner: &Self) -> Self {
        let columns = transposed(&inner.turn).map(|column| self.direction(column));
        Self {
            turn: transposed(&columns),
            place: self.point(inner.place),
        }
    }

    /// A symmetric tensor of this frame, seen from outside: R T Rᵀ.
    pub(super) fn tensor(&self, t: &Matrix) -> Matrix {
        let half = self
            .turn
            .map(|row| transposed(t).map(|column| dot(row, column)));
        half.map(|row| self.turn.map(|other| dot(row, other)))
    }
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn scaled(a: Vector, by: f64) -> Vector {
    a.map(|x| x * by)
}

fn transposed(m: &Matrix) -> Matrix {
    [0, 1, 2].map(|column| [m[0][column], m[1][column], m[2][column]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn turns_follow_the_fixed_axes() {
        let near = |a: Vector, b: Vector| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-15);
        // a quarter about x brings y up; then a quarter about z leaves it up
        let frame = Frame::new([1.0, 2.0, 3.0], [FRAC_PI_2, 0.0, FRAC_PI_2]);
        assert!(near(frame.direction([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]));
        assert!(near(frame.direction([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]));
        assert!(near(frame.point([1.0, 0.0, 0.0]), [1.0, 3.0, 3.0]));
        // two frames in a row are one
        let inner = Frame::new([0.5, -0.5, 0.25], [0.1, -0.4, 2.0]);
        let both = frame.then(&inner);
        let v = [0.3, 0.7, -1.1];
        let twice = frame.point(inner.point(v));
        assert!((0..3).all(|i| (both.point(v)[i] - twice[i]).abs() < 1e-14));
        // a rod along x lies along y after the turn
        let rod = frame.tensor(&[[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]);
        assert!((rod[0][0] - 2.0).abs() < 1e-15 && rod[1][1].abs() < 1e-15);
    }
}
