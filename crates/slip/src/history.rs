//! A bounded record of cumulative quantities over time.

use alloc::boxed::Box;
use alloc::vec;

/// Running totals of `K` quantities at their times, the newest `capacity` of them, linear in between.
///
/// Totals, not rates: what passed between two times is then a difference, exact for counters and for
/// displacements, however unevenly the samples came.
#[derive(Clone, Debug)]
pub(crate) struct History<const K: usize> {
    ring: Box<[Entry<K>]>,
    start: usize,
    len: usize,
    /// No two entries are closer than this, the newest two aside, so that a fast sensor cannot push the window out.
    spacing_ns: i64,
}

#[derive(Clone, Copy, Debug)]
struct Entry<const K: usize> {
    time_ns: i64,
    totals: [f64; K],
}

/// Nanoseconds from `from` to `to` in seconds; saturates instead of overflowing.
pub(crate) fn seconds_between(from: i64, to: i64) -> f64 {
    to.saturating_sub(from) as f64 * 1e-9
}

/// The whole number of a float, towards zero; saturates, and NaN gives 0.
#[allow(
    clippy::cast_possible_truncation,
    reason = "the cast saturates, which is what is wanted"
)]
pub(crate) fn whole(value: f64) -> i64 {
    value as i64
}

/// Seconds in whole nanoseconds.
pub(crate) fn nanoseconds(seconds: f64) -> i64 {
    whole(seconds * 1e9)
}

impl<const K: usize> History<K> {
    /// Room for `span_ns` of samples no closer than `span_ns / capacity`.
    pub(crate) fn new(capacity: usize, span_ns: i64) -> Self {
        let capacity = capacity.max(4);
        let empty = Entry {
            time_ns: 0,
            totals: [0.0; K],
        };
        let mut history = Self {
            ring: vec![empty; capacity].into_boxed_slice(),
            start: 0,
            len: 0,
            spacing_ns: 0,
        };
        history.keep(span_ns);
        history
    }

    /// Changes the span to that of the samples to come.
    pub(crate) fn keep(&mut self, span_ns: i64) {
        let spaces = i64::try_from(self.ring.len() - 2).unwrap_or(i64::MAX);
        // rounded up, lest the spaces together fall short of the span
        self.spacing_ns = -(-span_ns).div_euclid(spaces);
    }

    fn entry(&self, index: usize) -> &Entry<K> {
        let slot = self.start + index;
        let capacity = self.ring.len();
        &self.ring[if slot < capacity {
            slot
        } else {
            slot - capacity
        }]
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    pub(crate) fn newest(&self) -> Option<(i64, [f64; K])> {
        let last = self.len.checked_sub(1)?;
        let entry = self.entry(last);
        Some((entry.time_ns, entry.totals))
    }

    /// Adds totals at a time no earlier than the newest.
    pub(crate) fn push(&mut self, time_ns: i64, totals: [f64; K]) {
        let new = Entry { time_ns, totals };
        let capacity = self.ring.len();
        if self.len >= 2 {
            let [before, last] = [2, 1].map(|back| self.entry(self.len - back).time_ns);
            if last.saturating_sub(before) < self.spacing_ns {
                let last = (self.start + self.len - 1) % capacity;
                self.ring[last] = new;
                return;
            }
        }
        if self.len == capacity {
            self.start = (self.start + 1) % capacity;
            self.len -= 1;
        }
        let slot = (self.start + self.len) % capacity;
        self.ring[slot] = new;
        self.len += 1;
    }

    /// The totals at `time_ns`; `None` outside what is held.
    pub(crate) fn at(&self, time_ns: i64) -> Option<[f64; K]> {
        let (newest, totals) = self.newest()?;
        if time_ns > newest || time_ns < self.entry(0).time_ns {
            return None;
        }
        if time_ns == newest {
            return Some(totals);
        }
        let low = self.before(time_ns);
        let (a, b) = (self.entry(low), self.entry(low + 1));
        let share = seconds_between(a.time_ns, time_ns) / seconds_between(a.time_ns, b.time_ns);
        let mut out = [0.0; K];
        for (value, (&from, &to)) in out.iter_mut().zip(a.totals.iter().zip(&b.totals)) {
            *value = from + share * (to - from);
        }
        Some(out)
    }

    /// The last entry at or before `time_ns`, which lies between the oldest entry and the newest.
    ///
    /// Samples come at nearly equal intervals, so the search begins where the entry would be if they were equal, and
    /// widens from there.
    fn before(&self, time_ns: i64) -> usize {
        let last = self.len - 1;
        let oldest = self.entry(0).time_ns;
        let span = seconds_between(oldest, self.entry(last).time_ns);
        let guess = whole(seconds_between(oldest, time_ns) / span * last as f64);
        let mut low = usize::try_from(guess).unwrap_or(0).min(last);
        let mut high = low + 1;
        let mut step = 1;
        while self.entry(low).time_ns > time_ns {
            (high, low) = (low, low.saturating_sub(step));
            step *= 2;
        }
        while high < last && self.entry(high).time_ns <= time_ns {
            (low, high) = (high, (high + step).min(last));
            step *= 2;
        }
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if self.entry(middle).time_ns > time_ns {
                high = middle;
            } else {
                low = middle;
            }
        }
        low
    }

    /// What was added between two times.
    pub(crate) fn between(&self, from_ns: i64, to_ns: i64) -> Option<[f64; K]> {
        let (mut from, to) = (self.at(from_ns)?, self.at(to_ns)?);
        for (f, t) in from.iter_mut().zip(&to) {
            *f = t - *f;
        }
        Some(from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn totals_are_linear_between_samples_and_unknown_outside() {
        let mut history = History::<1>::new(8, 1_000);
        for (time, total) in [(0, 0.0), (500, 5.0), (1000, 6.0)] {
            history.push(time, [total]);
        }
        assert_eq!(history.at(250), Some([2.5]));
        assert_eq!(history.between(250, 750), Some([3.0]));
        assert_eq!(history.at(-1), None);
        assert_eq!(history.at(1001), None);
        assert_eq!(
            [0, 1000].map(|time| history.at(time)),
            [Some([0.0]), Some([6.0])]
        );
    }

    #[test]
    fn a_new_entry_takes_the_place_of_the_newest_that_is_closer_than_a_spacing_to_the_one_before() {
        // ten spaces of 100 ns
        let kept = |times: [i64; 3]| {
            let mut history = History::<1>::new(12, 1_000);
            for (time, total) in times.into_iter().zip([0.0, 7.0, 1.0]) {
                history.push(time, [total]);
            }
            history.at(times[1]) == Some([7.0])
        };
        assert!(!kept([0, 50, 60]) && !kept([0, 99, 500]) && kept([0, 100, 101]));
    }

    #[test]
    fn totals_may_jump_at_one_time() {
        let mut history = History::<1>::new(8, 0);
        for (time, total) in [(0, 0.0), (10, 1.0), (10, 3.0), (20, 5.0)] {
            history.push(time, [total]);
        }
        let at = [5, 10, 15].map(|time| history.at(time));
        assert_eq!(at, [Some([0.5]), Some([3.0]), Some([4.0])]);
    }

    #[test]
    fn uneven_samples_are_found_as_by_a_linear_search() {
        let mut history = History::<1>::new(40, 0);
        let mut time = 0;
        for index in 0..100_i64 {
            // bursts and gaps
            time += if index % 7 == 0 { 1_000 } else { 1 + index % 3 };
            history.push(time, [index as f64]);
            let oldest = history.entry(0).time_ns;
            for at in oldest..time.min(oldest + 3_000) {
                let low = (0..history.len)
                    .rev()
                    .find(|i| history.entry(*i).time_ns <= at);
                assert_eq!(Some(history.before(at)), low, "{at}");
            }
        }
    }

    proptest! {
        #[test]
        fn whatever_the_rate_the_whole_span_is_held(
            capacity in 4_usize..40,
            span_ns in 0_i64..1_000_000,
            periods_ns in prop::collection::vec(0_i64..50_000, 300),
        ) {
            let mut history = History::<1>::new(capacity, span_ns);
            let mut time = 0;
            for period in core::iter::once(0).chain(periods_ns) {
                time += period;
                history.push(time, [time as f64]);
                let held = history.newest().unwrap().0 - history.entry(0).time_ns;
                prop_assert!(held >= span_ns.min(time), "{held} of {span_ns} ns at {time}");
                prop_assert_eq!(history.between(time - held, time), Some([held as f64]));
            }
        }
    }
}
