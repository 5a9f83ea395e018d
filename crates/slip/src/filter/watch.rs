//! Is a sensor believed? It is watched by how far it is from what the others say.

use crate::history::seconds_between;

/// How one sensor has agreed with the others.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Watch {
    refused_since_ns: Option<i64>,
    agreed_since_ns: Option<i64>,
    failed: bool,
}

impl Watch {
    /// Counts a measurement that agreed (or not) at `time_ns`; gives whether the sensor is believed after it.
    ///
    /// It fails when it has been refused for `patience` seconds without a break, and is believed again when it has agreed
    /// for three times as long.
    pub(super) fn judge(&mut self, time_ns: i64, agreed: bool, patience: f64) -> bool {
        if agreed {
            self.refused_since_ns = None;
            let since = *self.agreed_since_ns.get_or_insert(time_ns);
            if seconds_between(since, time_ns) >= 3.0 * patience {
                self.failed = false;
            }
        } else {
            self.agreed_since_ns = None;
            let since = *self.refused_since_ns.get_or_insert(time_ns);
            if seconds_between(since, time_ns) >= patience {
                self.failed = true;
            }
        }
        !self.failed
    }

    pub(super) const fn is_suspect(&self) -> bool {
        self.refused_since_ns.is_some()
    }

    pub(super) const fn has_failed(&self) -> bool {
        self.failed
    }
}
