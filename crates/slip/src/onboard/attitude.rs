//! Heading, pitch and roll from an inertial unit: the gyro's angles, corrected towards gravity.

use grouser_real::Real;

use crate::history::seconds_between;

/// Gravity corrects the gyro's angles with this time constant, s: accelerations of a drive average out over it, while a
/// gyro of 0.03°/s bias drifts by 0.3°.
const GRAVITY_TIME_CONSTANT_S: f64 = 10.0;
/// A specific force whose size differs by more than this share from gravity's does not show the vertical: a wheeled robot
/// accelerates by less.
const GRAVITY_BAND_SHARE: f64 = 0.2;
/// Angular rates are not integrated over longer gaps, s.
const MAX_GAP_S: f64 = 0.5;
/// Pitches are limited to this in the rates' equation, rad (80°): at 90° roll and yaw are not separable.
const MAX_PITCH_RAD: f64 = 1.4;
/// Limits of readings, m/s² and rad/s: beyond the ranges of the inertial units that robots carry (16 g, 2000°/s).
const MAX_FORCE_M_PER_S2: f64 = 1000.0;
const MAX_RATE_RAD_PER_S: f64 = 100.0;
/// The specific force of [`AttitudeFilter::felt_slope`] is smoothed over this time, s: as long as the slips that are compared with
/// what it demands.
const FELT_TIME_CONSTANT_S: f64 = 0.2;
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
    /// Specific force forwards and up, smoothed, m/s².
    felt: [f64; 2],
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
            felt: [0.0, gravity],
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
        let felt_share = passed / (FELT_TIME_CONSTANT_S + passed);
        for (felt, now) in self.felt.iter_mut().zip([forward, up]) {
            *felt += felt_share * (now - *felt);
        }
        let size = Real::sqrt(forward * forward + left * left + up * up);
        if (size - self.gravity).abs() < GRAVITY_BAND_SHARE * self.gravity {
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

    /// The slope (rad, up) on which a robot at a steady speed would need the pull that this one needs now: where it gains speed it
    /// pulls as on a steeper one.
    #[must_use]
    pub fn felt_slope(&self) -> f64 {
        let [forward, up] = self.felt;
        Real::atan2(forward, up)
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

    #[test]
    fn a_robot_that_gains_speed_pulls_as_on_a_steeper_slope() {
        let filter = |slope: f64, acceleration: f64, steps: i64| {
            let (sin, cos) = slope.sin_cos();
            let mut filter = AttitudeFilter::new(0.0, EARTH_GRAVITY_M_PER_S2);
            for step in 0..=steps {
                let force = [
                    EARTH_GRAVITY_M_PER_S2 * sin + acceleration,
                    0.0,
                    EARTH_GRAVITY_M_PER_S2 * cos,
                ];
                filter.update(step * 10_000_000, force, [0.0; 3]);
            }
            filter.felt_slope()
        };
        assert!((filter(0.1, 0.0, 300) - 0.1).abs() < 1e-6);
        assert!((filter(0.0, 0.5, 300) - (0.5 / EARTH_GRAVITY_M_PER_S2).atan()).abs() < 1e-6);
        let both = (0.1_f64.tan() + -0.7 / (EARTH_GRAVITY_M_PER_S2 * 0.1_f64.cos())).atan();
        assert!((filter(0.1, -0.7, 300) - both).abs() < 1e-6);
        // smoothed over 0.2 s: by steps of 0.01 s
        let share = 1.0 - (1.0_f64 + 0.05).powi(-20);
        let expected = (share * 0.5 / EARTH_GRAVITY_M_PER_S2).atan();
        assert!((filter(0.0, 0.5, 20) - expected).abs() < 1e-9);
        let before = AttitudeFilter::new(0.0, EARTH_GRAVITY_M_PER_S2).felt_slope();
        assert!(before.abs() < 1e-12);
    }

    /// Nothing shows the vertical: a force far from gravity's.
    const FALLING: [f64; 3] = [0.0; 3];

    /// The angles of a body that turns from level at a constant rate about its own axes, by Rodrigues' formula.
    fn turned(rate: [f64; 3], seconds: f64) -> [f64; 3] {
        let size = rate.iter().map(|w| w * w).sum::<f64>().sqrt();
        let [x, y, z] = rate.map(|w| w / size);
        let (sin, cos) = (size * seconds).sin_cos();
        let rest = 1.0 - cos;
        let row = [y * z * rest + x * sin, cos + z * z * rest];
        let forwards = [
            cos + x * x * rest,
            x * y * rest + z * sin,
            x * z * rest - y * sin,
        ];
        [
            row[0].atan2(row[1]),
            -forwards[2].asin(),
            forwards[1].atan2(forwards[0]),
        ]
    }

    #[test]
    fn the_gyro_s_angles_are_those_of_a_turning_body() {
        for rate in [
            [0.3, -0.2, 0.5],
            [-0.4, 0.3, 0.2],
            [0.1, 0.5, -0.6],
            [0.5, 0.4, 0.3],
        ] {
            let mut filter = AttitudeFilter::new(0.7, EARTH_GRAVITY_M_PER_S2);
            for step in 0..=2000 {
                filter.update(step * 1_000_000, FALLING, rate);
            }
            let [roll, pitch, yaw] = turned(rate, 2.0);
            let found = [filter.roll(), filter.pitch(), filter.heading() - 0.7];
            for (found, exact) in found.into_iter().zip([roll, pitch, yaw]) {
                // a rectangle rule with steps of 1 ms
                assert!((found - exact).abs() < 1e-3, "{rate:?}: {found} {exact}");
            }
        }
    }

    #[test]
    fn gravity_is_a_mean_at_first_and_a_low_pass_from_ten_seconds_on() {
        let (roll, pitch) = (1.2_f64, -0.9_f64);
        let tilted = [
            -pitch.sin(),
            pitch.cos() * roll.sin(),
            pitch.cos() * roll.cos(),
        ];
        let tilted = tilted.map(|part| EARTH_GRAVITY_M_PER_S2 * part);
        let level = [0.0, 0.0, EARTH_GRAVITY_M_PER_S2];
        for (before, after) in [(4, 3), (25, 5)] {
            let mut filter = AttitudeFilter::new(0.0, EARTH_GRAVITY_M_PER_S2);
            for step in 0..100 * (before + after) {
                let force = if step < 100 * before { level } else { tilted };
                filter.update(step * 10_000_000, force, [0.0; 3]);
            }
            let (before, after) = (before as f64, after as f64);
            let share = if before < GRAVITY_TIME_CONSTANT_S {
                after / (before + after - 0.01 + MIN_SEEN_S)
            } else {
                1.0 - (GRAVITY_TIME_CONSTANT_S / (GRAVITY_TIME_CONSTANT_S + 0.01))
                    .powf(100.0 * after)
            };
            assert!((filter.roll() - share * roll).abs() < 1e-12);
            assert!((filter.pitch() - share * pitch).abs() < 1e-12);
        }
    }

    #[test]
    fn readings_that_do_not_show_the_vertical_change_no_tilt() {
        let tilt = |force: [f64; 3], rate: [f64; 3]| {
            let mut filter = AttitudeFilter::new(0.0, 10.0);
            filter.update(0, force, rate);
            filter.roll()
        };
        // a share of 0.6 to the left; the size is gravity's, at the edges of its band, and beyond them
        let force = |size: f64| [0.0, 0.6 * size, 0.8 * size];
        let roll = 0.6_f64.atan2(0.8);
        for size in [8.5, 10.0, 11.5] {
            assert!((tilt(force(size), [0.0; 3]) - roll).abs() < 1e-12, "{size}");
        }
        for size in [0.0, 7.5, 12.0, 15.0, 1e4, f64::NAN] {
            assert_eq!(tilt(force(size), [0.0; 3]), 0.0, "{size}");
        }
        // on the Moon a robot that falls feels a force near to gravity's too
        for (size, is_tilted) in [(0.0, false), (1.0, false), (1.5, true), (2.2, false)] {
            let mut filter = AttitudeFilter::new(0.0, 1.62);
            filter.update(0, force(size), [0.0; 3]);
            assert_eq!(filter.roll() != 0.0, is_tilted, "{size}");
        }
        for rate in [f64::NAN, 101.0, -101.0] {
            assert_eq!(tilt(force(10.0), [0.0, 0.0, rate]), 0.0, "{rate}");
        }
        let mut filter = AttitudeFilter::new(0.5, 10.0);
        filter.update(0, [0.0, 6.0, 8.0], [0.0; 3]);
        let [forward, left] = filter.without_gravity([1.0, 2.0, 3.0]);
        assert!((forward - 1.0).abs() < 1e-12 && (left + 4.0).abs() < 1e-12);
        // after a gap the rates are not integrated
        filter.update(600_000_000, FALLING, [0.0, 0.0, 1.0]);
        assert_eq!(filter.heading(), 0.5);
        filter.update(700_000_000, FALLING, [0.0, 0.0, 1.0]);
        assert!((filter.heading() - 0.5 - 0.1 * 0.8 / 0.06_f64.cos()).abs() < 1e-12);
        filter.set_heading(-1.0);
        assert_eq!(filter.heading(), -1.0);
    }

    #[test]
    fn readings_at_the_end_of_their_range_count() {
        let mut filter = AttitudeFilter::new(0.0, MAX_FORCE_M_PER_S2);
        filter.update(0, [MAX_FORCE_M_PER_S2, 0.0, 0.0], [0.0; 3]);
        assert!((filter.pitch() + core::f64::consts::FRAC_PI_2).abs() < 1e-12);
        let mut filter = AttitudeFilter::new(0.0, 10.0);
        for time_ns in [0, 10_000_000] {
            filter.update(time_ns, FALLING, [0.0, 0.0, MAX_RATE_RAD_PER_S]);
        }
        assert!((filter.heading() - 1.0).abs() < 1e-12);
    }
}
