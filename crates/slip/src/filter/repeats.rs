//! A sensor whose readings usually change, and that repeats one to the bit: it, or its driver, is stuck.

use crate::history::seconds_between;

/// A reading that is repeated for this long comes from a sensor that is stuck, s.
const STUCK_S: f64 = 0.5;
/// Readings of a noisy sensor change at least this often. Those of simulated ones without noise, of coarse and of held ones do not.
const MIN_CHANGES: f64 = 0.8;
/// Weight of a reading in that share, which is of this number of readings at least, and the largest number of repeats that count at
/// once.
const CHANGE_WEIGHT: f64 = 0.02;
const MIN_READINGS: u32 = 10;
const MAX_REPEATS: u32 = 50;

/// How often the readings of one sensor change.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Repeats {
    bits: u64,
    since_ns: i64,
    newest_ns: i64,
    times: u32,
    /// Readings that count, and the share of them that differ from the one before, up to the last change.
    count: u32,
    changes: f64,
    /// Different readings one after the other.
    runs: u32,
}

impl Repeats {
    /// Follows a reading; does it count in how often they change?
    pub(super) fn push<const K: usize>(&mut self, time_ns: i64, values: [f64; K], counts: bool) {
        let fold = |bits: u64, of: &f64| bits.rotate_left(7) ^ of.to_bits();
        let bits = values.iter().fold(1, fold);
        self.newest_ns = time_ns;
        if core::mem::replace(&mut self.bits, bits) == bits {
            self.times = self.times.saturating_add(1);
            return;
        }
        self.runs = self.runs.saturating_add(1);
        if counts {
            let repeats = self.times.min(MAX_REPEATS);
            self.count = self.count.saturating_add(1 + repeats);
            // a mean at first
            let weight = CHANGE_WEIGHT.max(1.0 / f64::from(self.count));
            for _ in 0..repeats {
                self.changes *= 1.0 - weight;
            }
            self.changes += weight * (1.0 - self.changes);
        }
        (self.since_ns, self.times) = (time_ns, 0);
    }

    /// Is it stuck?
    pub(super) fn has_stopped(&self) -> bool {
        self.usually_changes() && self.is_constant()
    }

    /// Does a sensor repeat the last reading whose readings usually change, or have never changed?
    pub(super) fn is_repeated(&self) -> bool {
        self.times > 0 && (self.usually_changes() || self.runs == 1)
    }

    fn usually_changes(&self) -> bool {
        self.count >= MIN_READINGS && self.changes >= MIN_CHANGES
    }

    /// Does it repeat its reading, whether it usually changes or not?
    pub(super) fn is_constant(&self) -> bool {
        seconds_between(self.since_ns, self.newest_ns) >= STUCK_S
    }
}
