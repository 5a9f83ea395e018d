//! Heading, pitch and roll from an inertial unit: the gyro's angles, corrected towards gravity.

use grouser_real::Real;

use crate::history::seconds_between;

/// Gravity corrects the gyro's angles with this time constant, s: accelerations of a drive average out over it, while a
/// gyro of 0.03°/s bias drifts by 0.3°.
const GRAVITY_TIME_CONSTANT_S: f64 = 10.0;
/// A specific force whose size differs by more than this from gravity's does not show the vertical, m/s²: a wheeled robot
/// accelerates by less.
const GRAVITY_BAND_M_PER_S2: f64 = 2.0;
/// Angular rates are not integrated over longer gaps, s.
const MAX_GAP_S: f64 = 0.5;
/// Pitches are limited to this in the rates' equation, rad (80°): at 90° roll and yaw are not separable.
const MAX_PITCH_RAD: f64 = 1.4;
/// Limits of readings, m/s² and rad/s: beyond the ranges of the inertial units that robots carry (16 g, 2000°/s).
const MAX_FORCE_M_PER_S2: f64 = 1000.0;
const MAX_RATE_RAD_PER_S: f64 = 100.0;
/// The mean over what was seen of gravity begins with this time, s, so that its share is never infinite.
const MIN_SEEN_S: f64 = 1e-3;

/// A complementary filter for the attitude.
///
/// ```
/// use grouser_slip::onboard::AttitudeFilter;
///
/// let mut attitude = AttitudeFilter::new(0.0, 9.81);
/// for step in 0..100 {
///     // at rest, nose up by 0.1 rad: gravity's reaction points forwards too
///     let force = [9.81 * 0.1_f64.sin(), 0.0, 9.81 * 0.1_f64.cos()];
///     attitude.update(step * 10_000_000, force, [0.0; 3]);
/// }
/// assert!((attitude.pitch() + 0.1).abs() < 1e-6);
/// assert!(attitude.without_gravity([9.81 * 0.1_f64.sin(), 0.0, 0.0])[0].abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct AttitudeFilter {
    gravity: f64,
    /// Roll, pitch, yaw, rad.
    angles: [f64; 3],
    last_ns: Option<i64>,
    /// How long gravity has been seen, s, up to `GRAVITY_TIME_CONSTANT_S`.
    seen: f64,
}

impl AttitudeFilter {
    /// An attitude that begins level with a known heading (rad), where gravity is `gravity` (m/s²).
    #[must_use]
    pub const fn new(heading: f64, gravity: f64) -> Self {
        Self {
            gravity,
            angles: [0.0, 0.0, heading],
            last_ns: None,
            seen: 0.0,
        }
    }

    /// Begins with another heading, rad.
    pub const fn set_heading(&mut self, heading: f64) {
        self.angles[2] = heading;
    }

    /// Takes a specific force (m/s²) and an angular rate (rad/s) in the robot's frame: forwards, to the left, up. At first
    /// the tilt is the mean of what gravity shows. Readings that are not finite, or that no unit measures, change nothing.
    pub fn update(&mut self, time_ns: i64, force: [f64; 3], rate: [f64; 3]) {
        let is_measured = force.iter().all(|x| x.abs() <= MAX_FORCE_M_PER_S2)
            && rate.iter().all(|x| x.abs() <= MAX_RATE_RAD_PER_S);
        if !is_measured {
            return;
        }
        let passed = self
            .last_ns
            .map_or(0.0, |last| seconds_between(last, time_ns));
        self.last_ns = Some(time_ns);
        if !(0.0..=MAX_GAP_S).contains(&passed) {
            return;
        }
        let [mut roll, mut pitch, mut yaw] = self.angles;
        let (sin, cos) = Real::sin_cos(roll);
        let tangent = Real::tan(pitch.clamp(-MAX_PITCH_RAD, MAX_PITCH_RAD));
        let across = sin * rate[1] + cos * rate[2];
        roll += passed * (rate[0] + tangent * across);
        pitch += passed * (cos * rate[1] - sin * rate[2]);
        yaw += passed * across / Real::cos(pitch.clamp(-MAX_PITCH_RAD, MAX_PITCH_RAD));
        let [forward, left, up] = force;
        let size = Real::sqrt(forward * forward + left * left + up * up);
        if (size - self.gravity).abs() < GRAVITY_BAND_M_PER_S2 {
            // a robot at rest measures gravity's reaction, upwards
            let roll_by_gravity = Real::atan2(left, up);
            let pitch_by_gravity = Real::atan2(-forward, Real::hypot(left, up));
            let share = if self.seen == 0.0 {
                1.0
            } else {
                passed / (self.seen + passed)
            };
            self.seen = (self.seen + passed).clamp(MIN_SEEN_S, GRAVITY_TIME_CONSTANT_S);
            roll += share * (roll_by_gravity - roll);
            pitch += share * (pitch_by_gravity - pitch);
        }
        self.angles = [roll, pitch, yaw];
    }

    /// A specific force (m/s²) forwards and to the left without gravity's share.
    #[must_use]
    pub fn without_gravity(&self, [forward, left, _]: [f64; 3]) -> [f64; 2] {
        let [roll, pitch, _] = self.angles;
        [
            forward + self.gravity * Real::sin(pitch),
            left - self.gravity * Real::cos(pitch) * Real::sin(roll),
        ]
    }

    /// Roll, right side down positive, rad.
    #[must_use]
    pub const fn roll(&self) -> f64 {
        self.angles[0]
    }

    /// Pitch, nose down positive, rad.
    #[must_use]
    pub const fn pitch(&self) -> f64 {
        self.angles[1]
    }

    /// Heading, rad, to the left; it continues past a whole turn.
    #[must_use]
    pub const fn heading(&self) -> f64 {
        self.angles[2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use grouser_terra::EARTH_GRAVITY_M_PER_S2;

    #[test]
    fn at_rest_it_finds_the_tilt() {
        let (roll, pitch) = (0.2_f64, -0.15_f64);
        let force = [
            -EARTH_GRAVITY_M_PER_S2 * pitch.sin(),
            EARTH_GRAVITY_M_PER_S2 * pitch.cos() * roll.sin(),
            EARTH_GRAVITY_M_PER_S2 * pitch.cos() * roll.cos(),
        ];
        let mut filter = AttitudeFilter::new(1.0, EARTH_GRAVITY_M_PER_S2);
        filter.update(0, force, [0.0; 3]);
        assert!((filter.roll() - roll).abs() < 1e-9);
        assert!((filter.pitch() - pitch).abs() < 1e-9);
        filter.update(10_000_000, [f64::NAN, 0.0, 0.0], [0.0; 3]);
        assert!((filter.roll() - roll).abs() < 1e-9);
        let rest = filter.without_gravity(force);
        assert!(rest.iter().all(|part| part.abs() < 1e-9));
    }
}
