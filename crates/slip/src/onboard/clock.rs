//! The computer's clock beside that of the sensors.

/// Nanoseconds in a millisecond.
const NS_PER_MS: i64 = 1_000_000;

/// The computer's clock since the first sample or tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clock {
    begun_ns: Option<i64>,
    /// The newest stamp of a sensor less the computer's clock when it arrived, ns.
    sensors_ahead_ns: Option<i64>,
}

impl Clock {
    /// Seconds since the beginning. Whole milliseconds are multiples of 0.001 s, so that loops with such periods count
    /// without rounding.
    pub(super) fn seconds(&mut self, now_ns: i64) -> f64 {
        let begun = *self.begun_ns.get_or_insert(now_ns);
        let passed = now_ns.saturating_sub(begun);
        let (whole, rest) = (passed / NS_PER_MS, passed % NS_PER_MS);
        whole as f64 * 1e-3 + rest as f64 * 1e-9
    }

    /// A sample with this stamp has arrived and was accepted.
    pub(super) const fn arrived(&mut self, now_ns: i64, stamp_ns: i64) {
        self.sensors_ahead_ns = Some(stamp_ns.saturating_sub(now_ns));
    }

    /// The time by the sensors' clock, which may have been set; `None` before the first sample.
    pub(super) fn sensor_time_ns(&self, now_ns: i64) -> Option<i64> {
        Some(now_ns.saturating_add(self.sensors_ahead_ns?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_counted_from_the_first_call_and_whole_milliseconds_exactly() {
        for begin in [0, -5_000_000_123, i64::MAX - 2_000_000_000] {
            let mut clock = Clock::default();
            assert_eq!(clock.seconds(begin), 0.0);
            for milliseconds in [1_i32, 7, 1500] {
                let passed = i64::from(milliseconds) * NS_PER_MS;
                assert_eq!(
                    clock.seconds(begin + passed),
                    f64::from(milliseconds) * 1e-3
                );
                let found = clock.seconds(begin + passed + 123_457);
                assert!((found - (passed + 123_457) as f64 * 1e-9).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn the_sensors_clock_runs_on_from_its_newest_stamp() {
        let mut clock = Clock::default();
        assert_eq!(clock.sensor_time_ns(5), None);
        clock.arrived(100, 1_000_040);
        assert_eq!(clock.sensor_time_ns(107), Some(1_000_047));
        clock.arrived(200, -3);
        assert_eq!(clock.sensor_time_ns(i64::MIN), Some(i64::MIN));
    }
}
