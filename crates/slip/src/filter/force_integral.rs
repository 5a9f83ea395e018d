//! The specific force integrated over time: what a step adds to the robot's speed, and what was added since a wheel's window.

use grouser_real::Real;

use super::multiple_model::reference_noise::ReferenceNoise;
use super::settings::FilterSettings;
use crate::history::{History, seconds_between};

/// Limits of the learnt noise density of the accelerometer, m/s per √s: better ones are limited by vibration.
const NOISE_LIMITS: (f64, f64) = (0.003, 0.3);
/// Readings further apart are not joined, s: in 0.1 s a robot starts or stops.
const MAX_PERIOD_S: f64 = 0.1;
/// Readings that come at least this often are waited for, s, from this share of their period after the last until this one: wheels
/// and accelerometer of one row of a log have one time.
const MAX_AWAITED_PERIOD_S: f64 = 0.06;
const AWAITED_PERIODS: core::ops::Range<f64> = 0.9..1.5;
/// Entries of the history at most, and their time, s: the longest window of a wheel at the default settings and its age, by steps of 5 ms.
const MAX_HISTORY_ENTRIES: usize = 128;
const HISTORY_S: f64 = 0.5;

/// Integrals of the specific force.
#[derive(Clone, Debug)]
pub(super) struct ForceIntegral {
    /// The last reading, forwards and to the left, m/s², its time and the period of the readings, s.
    last: [f64; 2],
    last_ns: Option<i64>,
    period_s: f64,
    noise: ReferenceNoise<2>,
    /// Speed gained until the last reading, and until the last step, m/s.
    read: [f64; 2],
    stepped: [f64; 2],
    /// Speed gained along the rims, m/s, and its own integral at each step, m.
    gained: f64,
    way: f64,
    history: History<1>,
}

impl ForceIntegral {
    /// For readings of at most `max_rate` (Hz).
    pub(super) fn new(max_rate: f64) -> Self {
        Self {
            last: [0.0; 2],
            last_ns: None,
            period_s: 0.0,
            noise: ReferenceNoise::new(),
            read: [0.0; 2],
            stepped: [0.0; 2],
            gained: 0.0,
            way: 0.0,
            history: History::of_rate(HISTORY_S, max_rate, MAX_HISTORY_ENTRIES),
        }
    }

    /// The clock was set: times are forgotten, what was learnt is not.
    pub(super) fn restart_clock(&mut self) {
        self.last_ns = None;
        self.history.clear();
    }

    /// Adds a reading, m/s²: between two of them the force is linear.
    pub(super) fn observe(&mut self, time_ns: i64, force: [f64; 2]) {
        let before = core::mem::replace(&mut self.last, force);
        let passed = self
            .last_ns
            .replace(time_ns)
            .map_or(0.0, |last| seconds_between(last, time_ns));
        if passed > 0.0 && passed < MAX_PERIOD_S {
            self.period_s = passed;
            for axis in 0..2 {
                self.read[axis] += 0.5 * (before[axis] + force[axis]) * passed;
            }
        } else {
            self.read = self.stepped;
        }
        self.noise.push(force);
    }

    /// Is the reading that covers the time up to `now_ns` still to come? Steps wait for it: a force that is one reading old would
    /// delay each change of slip.
    pub(super) fn awaits(&self, now_ns: i64) -> bool {
        let within = |last| {
            let periods = seconds_between(last, now_ns) / self.period_s;
            AWAITED_PERIODS.contains(&periods)
        };
        (0.0..=MAX_AWAITED_PERIOD_S).contains(&self.period_s) && self.last_ns.is_some_and(within)
    }

    /// The noise density, m/s per √s: as learnt, and as set before.
    pub(super) fn density(&self, settings: &FilterSettings) -> f64 {
        let (low, high) = NOISE_LIMITS;
        self.noise
            .learnt()
            .filter(|_| self.period_s > 0.0)
            .map_or(settings.accelerometer_noise, |sigma| {
                (sigma * Real::sqrt(self.period_s)).clamp(low, high)
            })
    }

    /// The mean force along `direction` (rad, beside the robot's heading) over the step of `dt` (s) that ends now, m/s²; `None`
    /// without a reading within the dropout time, s. Since the last reading it is that reading; what the next one shows
    /// otherwise is made up for in the step after it.
    pub(super) fn step(
        &mut self,
        now_ns: i64,
        direction: f64,
        (dt, dropout): (f64, f64),
    ) -> Option<f64> {
        let held = seconds_between(self.last_ns?, now_ns);
        if held > dropout {
            return None;
        }
        let now = core::array::from_fn(|axis| self.read[axis] + held * self.last[axis]);
        let before = core::mem::replace(&mut self.stepped, now);
        let (sin, cos) = Real::sin_cos(direction);
        let gained = cos * (now[0] - before[0]) + sin * (now[1] - before[1]);
        self.way += (self.gained + 0.5 * gained) * dt;
        self.gained += gained;
        self.history.push(now_ns, [self.way]);
        Some(gained / dt)
    }

    /// How much faster the robot is at the last step than in the mean from `from_ns` to `to_ns`, m/s, by the force alone; `None`
    /// where the history does not reach back as far.
    pub(super) fn gained_since(&self, from_ns: i64, to_ns: i64) -> Option<f64> {
        let window = seconds_between(from_ns, to_ns);
        let [way] = self.history.between(from_ns, to_ns)?;
        (window > 0.0).then(|| self.gained - way / window)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;
    const MAX_RATE_HZ: f64 = 1000.0;
    const DROPOUT_S: f64 = 0.2;
    /// Not along an axis, rad.
    const DIRECTION_RAD: f64 = 0.7;

    fn along([forward, left]: [f64; 2]) -> f64 {
        forward * f64::cos(DIRECTION_RAD) + left * f64::sin(DIRECTION_RAD)
    }

    /// The speed that a step of `dt` at `now_ns` adds, m/s.
    fn gained(integral: &mut ForceIntegral, now_ns: i64, dt: f64) -> f64 {
        let force = integral.step(now_ns, DIRECTION_RAD, (dt, DROPOUT_S));
        force.map_or(f64::NAN, |force| force * dt)
    }

    #[test]
    fn a_step_adds_the_trapezoid_of_the_readings_and_makes_up_for_the_force_that_was_held() {
        let [a, b, c] = [[0.6, -0.8], [1.4, 0.5], [-0.3, 0.9]];
        let mut integral = ForceIntegral::new(MAX_RATE_HZ);
        let near = |value: f64, expected: f64| (value - expected).abs() < 1e-12;
        assert!(integral.step(0, DIRECTION_RAD, (0.01, DROPOUT_S)).is_none());
        integral.observe(0, a);
        assert!(near(gained(&mut integral, 10 * MS, 0.01), 0.01 * along(a)));
        integral.observe(20 * MS, b);
        let first = 0.01 * (along(a) + along(b));
        let second = first - 0.01 * along(a);
        assert!(near(gained(&mut integral, 20 * MS, 0.01), second));
        // the last reading is held
        assert!(near(
            gained(&mut integral, 25 * MS, 0.005),
            0.005 * along(b)
        ));
        integral.observe(40 * MS, c);
        let third = 0.01 * (along(b) + along(c)) - 0.005 * along(b);
        assert!(near(gained(&mut integral, 40 * MS, 0.015), third));
        // readings at one time, backwards or too far apart are not joined: the integral goes on from the last step
        for (index, to_ns) in [40 * MS, 30 * MS, 130 * MS].into_iter().enumerate() {
            integral.observe(to_ns, b);
            assert!(near(gained(&mut integral, to_ns, 0.01), 0.0), "{index}");
        }
        let dropout_ns = 330 * MS;
        assert_eq!(seconds_between(130 * MS, dropout_ns), DROPOUT_S);
        assert!(near(gained(&mut integral, dropout_ns, 0.2), 0.2 * along(b)));
        assert!((integral.step(dropout_ns + 1, DIRECTION_RAD, (0.01, DROPOUT_S))).is_none());
    }

    /// At a constant acceleration a the speed is a t, and its mean over a window that of the window's middle.
    #[test]
    fn the_speed_gained_since_a_window_is_that_since_its_middle() {
        let force = [0.6, -1.7];
        let mut integral = ForceIntegral::new(MAX_RATE_HZ);
        for step in 0..=20 {
            integral.observe(step * 10 * MS, force);
            integral.step(step * 10 * MS, DIRECTION_RAD, (0.01, DROPOUT_S));
        }
        let since = integral.gained_since(40 * MS, 120 * MS).unwrap();
        assert!((since - 0.12 * along(force)).abs() < 1e-12, "{since}");
        assert_eq!(integral.gained_since(40 * MS, 40 * MS), None);
        // what was read and not stepped over is forgotten with the clock
        integral.observe(220 * MS, force);
        integral.restart_clock();
        assert_eq!(integral.gained_since(40 * MS, 120 * MS), None);
        assert!((integral.step(230 * MS, DIRECTION_RAD, (0.01, DROPOUT_S))).is_none());
        integral.observe(240 * MS, force);
        assert_eq!(gained(&mut integral, 240 * MS, 0.01), 0.0);
    }

    /// Beside a noise that learns from the same readings: one of a period of 10 ms is a tenth of it per √s.
    #[test]
    fn the_noise_density_is_that_of_readings_over_their_period() {
        let settings = FilterSettings::default();
        for (period_ms, share) in [(10, Some(0.1)), (200, None)] {
            let mut integral = ForceIntegral::new(MAX_RATE_HZ);
            let mut noise = ReferenceNoise::new();
            for index in 0..90_i64 {
                let force = [0.3, -0.5, 0.1, 0.9, -0.2].map(|part: f64| part * (index % 7) as f64);
                let force = [force[usize::try_from(index % 5).unwrap()], force[0]];
                integral.observe(period_ms * MS * index, force);
                noise.push(force);
            }
            let learnt = share.map(|share| share * noise.learnt().unwrap());
            let expected = learnt.unwrap_or(settings.accelerometer_noise);
            let is = integral.density(&settings);
            assert!((is - expected).abs() < 1e-12, "{is} {expected}");
        }
    }

    #[test]
    fn the_next_reading_is_awaited_about_a_period_after_the_last() {
        let awaits = |period_ns: i64, since_ns: i64| {
            let mut integral = ForceIntegral::new(MAX_RATE_HZ);
            integral.observe(0, [0.3, 0.4]);
            integral.observe(period_ns, [0.3, 0.4]);
            integral.awaits(period_ns + since_ns)
        };
        let at = [17, 19, 29, 31].map(|since| awaits(20 * MS, since * MS));
        assert_eq!(at, [false, true, true, false]);
        // readings as seldom as this are not waited for
        assert!(awaits(59 * MS, 59 * MS) && !awaits(61 * MS, 61 * MS));
        assert!(!ForceIntegral::new(MAX_RATE_HZ).awaits(0));
    }
}
