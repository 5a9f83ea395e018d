//! Vectors and attitudes in space. x forwards, y to the left, z upwards.

use std::ops::{Add, AddAssign, Index, Mul, Neg, Sub};

use grouser_real::Real;

/// A vector of three numbers.
///
/// ```
/// use grouser_rover::vector::Vector;
///
/// let lever = Vector::new(0.3, 0.0, 0.0);
/// let force = Vector::new(0.0, 0.0, 10.0);
/// assert_eq!(lever.cross(force), Vector::new(0.0, -3.0, 0.0)); // lifts the nose
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector {
    /// Forwards (or east).
    pub x: f64,
    /// To the left (or north).
    pub y: f64,
    /// Upwards.
    pub z: f64,
}

impl Vector {
    /// Nothing.
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);
    /// The unit vectors.
    pub const AXES: [Self; 3] = [
        Self::new(1.0, 0.0, 0.0),
        Self::new(0.0, 1.0, 0.0),
        Self::new(0.0, 0.0, 1.0),
    ];

    /// From its parts.
    #[must_use]
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    /// Scalar product.
    ///
    /// ```
    /// # use grouser_rover::vector::Vector;
    /// assert_eq!(Vector::new(1.0, 2.0, 3.0).dot(Vector::AXES[2]), 3.0);
    /// ```
    #[must_use]
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Vector product.
    ///
    /// ```
    /// # use grouser_rover::vector::Vector;
    /// let [x, y, z] = Vector::AXES;
    /// assert_eq!(x.cross(y), z);
    /// ```
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Length.
    ///
    /// ```
    /// # use grouser_rover::vector::Vector;
    /// assert_eq!(Vector::new(3.0, 0.0, 4.0).length(), 5.0);
    /// ```
    #[must_use]
    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// The vector of length 1 along it; nothing for nothing.
    ///
    /// ```
    /// # use grouser_rover::vector::Vector;
    /// assert_eq!(Vector::new(0.0, 0.0, 4.0).unit(), Vector::AXES[2]);
    /// assert_eq!(Vector::ZERO.unit(), Vector::ZERO);
    /// ```
    #[must_use]
    pub fn unit(self) -> Self {
        let length = self.length();
        if length > 0.0 {
            self * (1.0 / length)
        } else {
            Self::ZERO
        }
    }

    /// Turned by the angle whose cosine and sine are given, about y (z towards x).
    #[must_use]
    pub fn pitched(self, (cos, sin): (f64, f64)) -> Self {
        Self::new(
            cos * self.x + sin * self.z,
            self.y,
            cos * self.z - sin * self.x,
        )
    }
}

impl Add for Vector {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl AddAssign for Vector {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Vector {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl Neg for Vector {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl Mul<f64> for Vector {
    type Output = Self;
    fn mul(self, k: f64) -> Self {
        Self::new(self.x * k, self.y * k, self.z * k)
    }
}

impl Index<usize> for Vector {
    type Output = f64;
    /// x, y, and z for every other index.
    fn index(&self, index: usize) -> &f64 {
        match index {
            0 => &self.x,
            1 => &self.y,
            _ => &self.z,
        }
    }
}

/// A symmetric tensor: a moment of inertia.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tensor {
    /// Diagonal: xx, yy, zz.
    pub diagonal: Vector,
    /// yz, xz, xy.
    pub products: Vector,
}

impl Tensor {
    /// Without products.
    #[must_use]
    pub const fn diagonal(diagonal: Vector) -> Self {
        Self {
            diagonal,
            products: Vector::ZERO,
        }
    }

    /// The inertia about the origin of a mass (kg) at `at`.
    ///
    /// ```
    /// # use grouser_rover::vector::{Tensor, Vector};
    /// // 2 kg at 3 m along x: nothing about x, 18 kg m² about y and z
    /// let inertia = Tensor::of_point(2.0, Vector::new(3.0, 0.0, 0.0));
    /// assert_eq!(inertia.diagonal, Vector::new(0.0, 18.0, 18.0));
    /// ```
    #[must_use]
    pub fn of_point(mass: f64, at: Vector) -> Self {
        let Vector { x, y, z } = at;
        Self {
            diagonal: Vector::new(y * y + z * z, x * x + z * z, x * x + y * y) * mass,
            products: Vector::new(-y * z, -x * z, -x * y) * mass,
        }
    }

    /// The sum of two about one point; `sign` −1 takes the second away.
    ///
    /// ```
    /// use grouser_rover::vector::{Tensor, Vector};
    ///
    /// let one = Tensor::diagonal(Vector::new(1.0, 2.0, 3.0));
    /// assert_eq!(one.plus(one, -1.0).diagonal, Vector::ZERO);
    /// ```
    #[must_use]
    pub fn plus(self, other: Self, sign: f64) -> Self {
        Self {
            diagonal: self.diagonal + other.diagonal * sign,
            products: self.products + other.products * sign,
        }
    }

    /// Tensor times vector.
    ///
    /// ```
    /// # use grouser_rover::vector::{Tensor, Vector};
    /// let inertia = Tensor::diagonal(Vector::new(1.0, 2.0, 3.0));
    /// assert_eq!(inertia.times(Vector::AXES[1]), Vector::new(0.0, 2.0, 0.0));
    /// ```
    #[must_use]
    pub fn times(&self, v: Vector) -> Vector {
        let (d, p) = (self.diagonal, self.products);
        Vector::new(
            d.x * v.x + p.z * v.y + p.y * v.z,
            p.z * v.x + d.y * v.y + p.x * v.z,
            p.y * v.x + p.x * v.y + d.z * v.z,
        )
    }
}

/// An attitude: a unit quaternion that turns the robot's frame into the world's.
///
/// ```
/// use grouser_rover::vector::{Attitude, Vector};
///
/// let left = Attitude::from_angles(0.0, 0.0, std::f64::consts::FRAC_PI_2);
/// let ahead = left.to_world(Vector::AXES[0]);
/// assert!((ahead - Vector::AXES[1]).length() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude {
    w: f64,
    v: Vector,
}

impl Attitude {
    /// Upright, heading along x.
    pub const LEVEL: Self = Self {
        w: 1.0,
        v: Vector::ZERO,
    };

    /// Turned by the rotation vector `turn` (rad).
    ///
    /// ```
    /// use grouser_rover::vector::{Attitude, Vector};
    ///
    /// let (roll, pitch, _) = Attitude::from_rotation(Vector::new(0.3, 0.0, 0.0)).angles();
    /// assert!((roll - 0.3).abs() < 1e-12 && pitch.abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn from_rotation(turn: Vector) -> Self {
        let square = turn.dot(turn);
        // cos(α/2) and sin(α/2)/α; by their series to the last bit where the angle is small, as in a step in time
        let (w, scale) = if square < 1e-3 {
            let y = 0.25 * square;
            (
                1.0 - y * (1.0 / 2.0 - y * (1.0 / 24.0 - y * (1.0 / 720.0))),
                0.5 - y * (1.0 / 12.0 - y * (1.0 / 240.0 - y * (1.0 / 10_080.0))),
            )
        } else {
            let angle = square.sqrt();
            let (sin, cos) = Real::sin_cos(0.5 * angle);
            (cos, sin / angle)
        };
        Self { w, v: turn * scale }
    }

    /// Heading, then slope: yaw about z, then pitch about y, then roll about x (rad).
    #[must_use]
    pub fn from_angles(roll: f64, pitch: f64, yaw: f64) -> Self {
        let [x, y, z] = Vector::AXES;
        Self::from_rotation(z * yaw)
            .then(Self::from_rotation(y * pitch))
            .then(Self::from_rotation(x * roll))
    }

    /// This one, and `next` in the turned frame.
    ///
    /// ```
    /// use grouser_rover::vector::Attitude;
    ///
    /// let quarter = Attitude::from_angles(0.0, 0.0, std::f64::consts::FRAC_PI_2);
    /// let (_, _, yaw) = quarter.then(quarter.then(quarter)).angles();
    /// assert!((yaw + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self {
            w: self.w * next.w - self.v.dot(next.v),
            v: next.v * self.w + self.v * next.w + self.v.cross(next.v),
        }
    }

    /// Brought back to length 1 after many products.
    #[must_use]
    pub fn normalised(self) -> Self {
        let scale = 1.0 / (self.w * self.w + self.v.dot(self.v)).sqrt();
        Self {
            w: self.w * scale,
            v: self.v * scale,
        }
    }

    /// A vector of the robot's frame in the world's.
    #[must_use]
    pub fn to_world(self, a: Vector) -> Vector {
        let t = self.v.cross(a) * 2.0;
        a + t * self.w + self.v.cross(t)
    }

    /// A vector of the world's frame in the robot's.
    ///
    /// ```
    /// # use grouser_rover::vector::{Attitude, Vector};
    /// // Nose up by 0.2 rad: gravity pulls backwards too.
    /// let down = Attitude::from_angles(0.0, -0.2, 0.0).to_robot(-Vector::AXES[2]);
    /// assert!((down.x + 0.2_f64.sin()).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn to_robot(self, a: Vector) -> Vector {
        Self {
            w: self.w,
            v: -self.v,
        }
        .to_world(a)
    }

    /// The axes of the robot's frame in the world's: cheaper than the attitude where many vectors are turned.
    #[must_use]
    pub(crate) fn axes(self) -> Axes {
        Axes(Vector::AXES.map(|axis| self.to_world(axis)))
    }

    /// Roll, pitch (nose down positive) and yaw, rad.
    ///
    /// ```
    /// # use grouser_rover::vector::Attitude;
    /// let (roll, pitch, yaw) = Attitude::from_angles(0.1, -0.2, 0.3).angles();
    /// assert!((roll - 0.1).abs() < 1e-12 && (pitch + 0.2).abs() < 1e-12 && (yaw - 0.3).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn angles(self) -> (f64, f64, f64) {
        let forward = self.to_world(Vector::AXES[0]);
        let (left, up) = (
            self.to_world(Vector::AXES[1]),
            self.to_world(Vector::AXES[2]),
        );
        let flat = Real::hypot(forward.x, forward.y);
        (
            Real::atan2(left.z, up.z),
            Real::atan2(-forward.z, flat),
            Real::atan2(forward.y, forward.x),
        )
    }
}

/// The axes of a robot's frame in the world's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes([Vector; 3]);

impl Axes {
    /// A vector of the robot's frame in the world's.
    pub(crate) fn to_world(self, a: Vector) -> Vector {
        let [x, y, z] = self.0;
        x * a.x + y * a.y + z * a.z
    }

    /// A vector of the world's frame in the robot's.
    pub(crate) fn to_robot(self, a: Vector) -> Vector {
        let [x, y, z] = self.0;
        Vector::new(x.dot(a), y.dot(a), z.dot(a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_come_back() {
        let attitude = Attitude::from_angles(0.1, -0.2, 2.5);
        let (roll, pitch, yaw) = attitude.angles();
        assert!((roll - 0.1).abs() < 1e-12 && (pitch + 0.2).abs() < 1e-12);
        assert!((yaw - 2.5).abs() < 1e-12);
        let v = Vector::new(0.3, -1.2, 0.5);
        assert!((attitude.to_robot(attitude.to_world(v)) - v).length() < 4e-15);
        let axes = attitude.axes();
        assert!((axes.to_world(v) - attitude.to_world(v)).length() < 4e-15);
        assert!((axes.to_robot(v) - attitude.to_robot(v)).length() < 4e-15);
    }

    #[test]
    fn a_small_turn_is_that_of_sine_and_cosine() {
        let axis = Vector::new(0.48, -0.6, 0.64);
        for angle in [1e-12, 1e-7, 1e-3, 0.0316, 0.0317, 0.3] {
            let Attitude { w, v } = Attitude::from_rotation(axis * angle);
            let (sin, cos) = (0.5_f64 * angle).sin_cos();
            assert!((w - cos).abs() < 3e-16, "{angle}");
            assert!((v.dot(axis) / sin - 1.0).abs() < 1e-15, "{angle}");
        }
        assert_eq!(Attitude::from_rotation(Vector::ZERO), Attitude::LEVEL);
    }

    #[test]
    fn a_point_mass_has_its_inertia() {
        let at = Vector::new(0.2, -0.3, 0.4);
        let spin = Vector::new(1.0, 2.0, -0.5);
        let moment = at.cross(spin.cross(at)) * 3.0;
        assert!((Tensor::of_point(3.0, at).times(spin) - moment).length() < 1e-14);
    }
}
