//! Rates of a sensor, summed over time.

use super::repeats::Repeats;
use crate::fault::Fault;
use crate::history::{History, seconds_between};

/// The integrals of `K` rates, which change linearly between readings.
#[derive(Clone, Debug)]
pub(super) struct Rates<const K: usize> {
    totals: History<K>,
    last: Option<(i64, [f64; K])>,
    sums: [f64; K],
    repeats: Repeats,
}

impl<const K: usize> Rates<K> {
    /// Room for so many readings over `span_ns`.
    pub(super) fn new(capacity: usize, span_ns: i64) -> Self {
        Self {
            totals: History::new(capacity, span_ns),
            last: None,
            sums: [0.0; K],
            repeats: Repeats::default(),
        }
    }

    /// Keeps its readings for so long.
    pub(super) fn keep(&mut self, span_ns: i64) {
        self.totals.keep(span_ns);
    }

    /// Takes a reading; after a silence of more than `gap` (s) the sums restart.
    pub(super) fn take(&mut self, time_ns: i64, rates: [f64; K], gap: f64) -> Result<(), Fault> {
        let passed = self.last.map(|(then, _)| seconds_between(then, time_ns));
        match (self.last, passed) {
            // a second one of the same time adds nothing
            (Some(_), Some(0.0)) => return Ok(()),
            (Some((last_ns, _)), Some(passed)) if passed < 0.0 => {
                return Err(Fault::NotLater { time_ns, last_ns });
            }
            (Some((_, before)), Some(passed)) if passed <= gap => {
                for (sum, (a, b)) in self.sums.iter_mut().zip(before.iter().zip(&rates)) {
                    *sum += 0.5 * passed * (a + b);
                }
            }
            _ => self.totals.clear(),
        }
        self.repeats.push(time_ns, rates, true);
        self.last = Some((time_ns, rates));
        self.totals.push(time_ns, self.sums);
        Ok(())
    }

    /// Does the sensor repeat its reading?
    pub(super) fn is_stuck(&self) -> bool {
        self.repeats.has_stopped()
    }

    /// Does the sensor repeat its reading, as one that is not there?
    pub(super) fn is_constant(&self) -> bool {
        self.repeats.is_constant()
    }

    /// The time of its newest reading.
    pub(super) const fn newest_ns(&self) -> Option<i64> {
        match self.last {
            Some((time_ns, _)) => Some(time_ns),
            None => None,
        }
    }

    /// The integrals between two times; `None` where that is not covered.
    pub(super) fn between(&self, from_ns: i64, to_ns: i64) -> Option<[f64; K]> {
        self.totals.between(from_ns, to_ns)
    }

    /// Readings in between are missing, or the clock was set.
    pub(super) fn interrupt(&mut self) {
        self.totals.clear();
        self.last = None;
    }
}
