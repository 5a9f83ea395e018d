//! Is a sensor believed? It is watched by how far it is from what the others say.

use crate::history::seconds_between;

/// The most time that one measurement stands for, s.
const LONGEST: f64 = 0.1;
/// A sensor is forgiven this many times slower than it is refused.
const FORGIVING: f64 = 3.0;

/// How one sensor has agreed with the others.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Watch {
    last_ns: Option<i64>,
    /// How long it has been refused, less what is forgiven, s.
    refused: f64,
    is_refused: bool,
    failed: bool,
}

impl Watch {
    /// Counts a measurement that agreed (or not) at `time_ns`; gives whether the sensor is believed after it.
    ///
    /// It fails when it has been refused for `patience` seconds, and is believed again when it has agreed for three times
    /// as long; what agrees now and then by chance still fails.
    pub(super) fn judge(&mut self, time_ns: i64, agreed: bool, patience: f64) -> bool {
        let last = self.last_ns.replace(time_ns).unwrap_or(time_ns);
        let passed = seconds_between(last, time_ns).clamp(0.0, LONGEST);
        self.is_refused = !agreed;
        if agreed {
            self.refused = (self.refused - passed / FORGIVING).max(0.0);
            self.failed &= self.refused > 0.0;
        } else {
            self.refused = (self.refused + passed).min(patience);
            self.failed |= self.refused >= patience;
        }
        !self.failed
    }

    pub(super) const fn is_suspect(&self) -> bool {
        self.is_refused
    }

    /// Has it agreed for long?
    pub(super) const fn is_clean(&self) -> bool {
        self.refused <= 0.0 && !self.failed
    }

    pub(super) const fn has_failed(&self) -> bool {
        self.failed
    }
}
