//! A rate that repeats itself to the bit beside rates that change from reading to reading: a sensor, or its driver, that is stuck.

use crate::history::seconds_between;

/// A rate is stuck that has repeated itself as often, and for this long, s.
const STUCK_READINGS: u32 = 10;
const STUCK_TIME_S: f64 = 0.3;
/// A rate that changes with this share of its readings does not repeat itself as often by chance: 0.2¹⁰ is 1e-7. Rates without
/// noise, coarse ones and those that are held from row to row change more seldom.
const MIN_CHANGES: f64 = 0.8;
/// Weight of a reading in the share, a fading mean, which reaches the least one after 80 readings that change; and how many that
/// repeat themselves count at most, a memory of as many.
const MAX_REPEATS: u32 = 50;
const READING_WEIGHT: f64 = 0.02;

/// How often the rate of one wheel changes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RepeatedRate {
    last: Option<u64>,
    since_ns: i64,
    newest_ns: i64,
    repeats: u32,
    /// Share of readings that differ from the one before, up to the last change.
    changes: f64,
}

impl RepeatedRate {
    /// Adds a reading, rad/s. A rate of 0 is that of a wheel that stands.
    pub(super) fn push(&mut self, time_ns: i64, rate: f64) {
        self.newest_ns = time_ns;
        if self.last.replace(rate.to_bits()) == Some(rate.to_bits()) && rate != 0.0 {
            self.repeats = self.repeats.saturating_add(1);
            return;
        }
        let kept = 1.0 - READING_WEIGHT;
        for _ in 0..self.repeats.min(MAX_REPEATS) {
            self.changes *= kept;
        }
        self.changes = kept * self.changes + READING_WEIGHT;
        self.repeats = 0;
        self.since_ns = time_ns;
    }

    /// Does it change from reading to reading?
    pub(super) fn changes(&self) -> bool {
        self.usually_changes() && self.repeats < 2
    }

    /// Has it stopped changing?
    pub(super) fn has_stopped(&self) -> bool {
        self.usually_changes()
            && self.repeats >= STUCK_READINGS
            && seconds_between(self.since_ns, self.newest_ns) >= STUCK_TIME_S
    }

    fn usually_changes(&self) -> bool {
        self.changes >= MIN_CHANGES
    }
}

#[cfg(test)]
mod tests {
    use super::RepeatedRate;

    /// Readings at 50 Hz.
    fn after(rates: impl IntoIterator<Item = f64>) -> RepeatedRate {
        let mut rate = RepeatedRate::default();
        for (i, value) in (0..).zip(rates) {
            rate.push(20_000_000 * i, value);
        }
        rate
    }

    fn noisy(count: u32) -> impl Iterator<Item = f64> {
        (0..count).map(|i| 3.0 + 0.01 * f64::from(i * i).sin())
    }

    #[test]
    fn a_noisy_rate_that_repeats_itself_has_stopped() {
        assert!(after(noisy(200)).changes());
        let stuck = after(noisy(200).chain([3.0; 16]));
        assert!(stuck.has_stopped() && !stuck.changes());
        assert!(!after(noisy(200).chain([3.0; 10])).has_stopped());
        assert!(!after(noisy(20).chain([3.0; 16])).has_stopped());
        // it goes on
        assert!(!after(noisy(200).chain([3.0; 16]).chain([3.1])).has_stopped());
    }

    #[test]
    fn wheels_that_stand_and_rates_without_noise_are_not_stuck() {
        assert!(!after(noisy(200).chain([0.0; 100])).has_stopped());
        assert!(!after([3.0; 300]).has_stopped());
        assert!(!after([3.0; 300]).changes());
        let coarse = (0..300).map(|i| f64::from(i / 3)).chain([100.0; 100]);
        assert!(!after(coarse).has_stopped());
    }

    #[test]
    fn the_share_of_changes_fades_by_a_fiftieth_a_reading() {
        let share = |changes: i32| 1.0 - 0.98_f64.powi(changes);
        for (repeats, counted) in [(0, 0), (7, 7), (50, 50), (70, 50)] {
            let found = after(noisy(100).chain(vec![3.5; 1 + repeats]).chain([3.6]));
            // a change, as many that repeat it, and another change
            let expected = share(101) * 0.98_f64.powi(counted + 1) + 0.02;
            assert!((found.changes - expected).abs() < 1e-12, "{repeats}");
        }
        // 0.98⁸⁰ is 0.199
        assert!(!after(noisy(79)).changes() && after(noisy(80)).changes());
        let once = after(noisy(100).chain([3.5; 2]));
        assert!(once.changes() && !after(noisy(100).chain([3.5; 3])).changes());
    }

    #[test]
    fn a_rate_is_stuck_after_ten_repeats_that_last() {
        for (period_ms, repeats, is_stuck) in [
            (20, 14, false),
            (20, 15, true),
            (50, 9, false),
            (50, 10, true),
        ] {
            let mut rate = RepeatedRate::default();
            for (i, value) in (0..).zip(noisy(100).chain(vec![3.5; 1 + repeats])) {
                rate.push(1_000_000 * period_ms * i, value);
            }
            assert_eq!(rate.has_stopped(), is_stuck, "{period_ms} {repeats}");
        }
    }
}
