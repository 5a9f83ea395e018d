//! Heading, pitch and roll from an inertial unit: the gyro's angles, drawn to gravity.

use crate::vector::Vector;

/// Time over which gravity outweighs the gyro, s.
const GRAVITY_TIME: f64 = 10.0;
/// A specific force further than this from gravity says nothing of the vertical, m/s².
const GRAVITY_BAND: f64 = 2.0;

/// A complementary filter.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AttitudeFilter {
    /// Roll, pitch, yaw, rad.
    angles: Option<[f64; 3]>,
    last_ns: Option<i64>,
    /// How long it has looked at gravity, s, up to `GRAVITY_TIME`.
    looked: f64,
}

impl AttitudeFilter {
    /// Knows the heading at the start.
    pub(super) fn new(heading: f64) -> Self {
        Self {
            angles: Some([0.0, 0.0, heading]),
            last_ns: None,
            looked: 0.0,
        }
    }

    pub(super) fn take(&mut self, time_ns: i64, force: Vector, turning: Vector) {
        let finite = [force.x, force.y, force.z, turning.x, turning.y, turning.z];
        if finite.iter().any(|x| !x.is_finite()) {
            return;
        }
        let [mut roll, mut pitch, mut yaw] = self.angles.unwrap_or_default();
        let passed = self
            .last_ns
            .map_or(0.0, |last| time_ns.saturating_sub(last) as f64 * 1e-9);
        self.last_ns = Some(time_ns);
        if !(0.0..=0.5).contains(&passed) {
            return;
        }
        let (sin, cos) = roll.sin_cos();
        let tangent = pitch.clamp(-1.4, 1.4).tan();
        let across = sin * turning.y + cos * turning.z;
        roll += passed * (turning.x + tangent * across);
        pitch += passed * (cos * turning.y - sin * turning.z);
        yaw += passed * across / pitch.clamp(-1.4, 1.4).cos();
        let length = force.length();
        if (length - crate::dynamics::GRAVITY).abs() < GRAVITY_BAND {
            // what stands still feels gravity upwards
            let seen_roll = force.y.atan2(force.z);
            let seen_pitch = (-force.x).atan2(force.y.hypot(force.z));
            // at first a mean of all that was seen
            let share = if self.looked == 0.0 {
                1.0
            } else {
                passed / (self.looked + passed)
            };
            self.looked = (self.looked + passed).clamp(1e-3, GRAVITY_TIME);
            roll += share * (seen_roll - roll);
            pitch += share * (seen_pitch - pitch);
        }
        self.angles = Some([roll, pitch, yaw]);
    }

    /// What is left of a specific force (m/s²) forwards and to the left without gravity's share.
    pub(super) fn without_gravity(&self, force: Vector) -> [f64; 2] {
        let [roll, pitch, _] = self.angles.unwrap_or_default();
        let gravity = crate::dynamics::GRAVITY;
        [
            force.x + gravity * pitch.sin(),
            force.y - gravity * pitch.cos() * roll.sin(),
        ]
    }

    pub(super) fn roll(&self) -> Option<f64> {
        self.angles.map(|angles| angles[0])
    }

    pub(super) fn pitch(&self) -> Option<f64> {
        self.angles.map(|angles| angles[1])
    }

    pub(super) fn heading(&self) -> Option<f64> {
        self.angles.map(|angles| angles[2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::GRAVITY;
    use crate::vector::Attitude;

    #[test]
    fn at_rest_it_finds_the_tilt() {
        let attitude = Attitude::from_angles(0.2, -0.15, 1.0);
        let force = attitude.to_robot(Vector::new(0.0, 0.0, GRAVITY));
        let mut filter = AttitudeFilter::new(1.0);
        filter.take(0, force, Vector::ZERO);
        assert!((filter.roll().unwrap() - 0.2).abs() < 1e-9);
        assert!((filter.pitch().unwrap() + 0.15).abs() < 1e-9);
        filter.take(10_000_000, Vector::new(f64::NAN, 0.0, 0.0), Vector::ZERO);
        assert!((filter.roll().unwrap() - 0.2).abs() < 1e-9);
    }
}
