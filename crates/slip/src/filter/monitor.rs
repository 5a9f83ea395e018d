//! Trust in one sensor, from how long its readings have agreed or disagreed with the others'.

use crate::history::seconds_between;

/// The longest time that one reading stands for, s: a sensor of 10 Hz is not condemned by one gap.
const MAX_READING_TIME_S: f64 = 0.1;
/// Agreement counts this many times less than disagreement, so that a sensor that agrees by chance now and then still fails.
const FORGIVENESS_FACTOR: f64 = 3.0;

/// The record of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Monitor {
    last_ns: Option<i64>,
    /// Time of disagreement less the agreement that makes up for it, s.
    refused_s: f64,
    is_refused: bool,
    failed: bool,
}

impl Monitor {
    /// Records a reading at `time_ns` that agreed or not; returns whether the sensor is trusted after it.
    ///
    /// It fails after `patience_s` of disagreement, and is trusted again after three times as long of agreement.
    pub(super) fn record(&mut self, time_ns: i64, agreed: bool, patience_s: f64) -> bool {
        let last = self.last_ns.replace(time_ns).unwrap_or(time_ns);
        let passed = seconds_between(last, time_ns).clamp(0.0, MAX_READING_TIME_S);
        self.is_refused = !agreed;
        if agreed {
            self.refused_s = (self.refused_s - passed / FORGIVENESS_FACTOR).max(0.0);
            self.failed &= self.refused_s > 0.0;
        } else {
            self.refused_s = (self.refused_s + passed).min(patience_s);
            self.failed |= self.refused_s >= patience_s;
        }
        !self.failed
    }

    /// Was the last reading refused?
    pub(super) const fn is_suspect(&self) -> bool {
        self.is_refused
    }

    /// Has it agreed for long?
    pub(super) const fn is_clean(&self) -> bool {
        self.refused_s <= 0.0 && !self.failed
    }

    pub(super) const fn has_failed(&self) -> bool {
        self.failed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;
    const PATIENCE_S: f64 = 0.2;

    #[test]
    fn it_fails_after_its_patience_and_is_trusted_after_three_times_that() {
        let mut monitor = Monitor::default();
        assert!(monitor.is_clean() && !monitor.is_suspect() && !monitor.has_failed());
        let mut record = |at_ms: i64, agreed| {
            let trusted = monitor.record(at_ms * MS, agreed, PATIENCE_S);
            assert_eq!(
                (monitor.is_suspect(), monitor.has_failed()),
                (!agreed, !trusted)
            );
            (trusted, monitor.is_clean())
        };
        // the first reading stands for no time, one after a gap for 0.1 s, and one of an earlier time for none
        assert_eq!(record(1_000, false), (true, true));
        assert_eq!(record(9_000, false), (true, false));
        assert_eq!(record(8_000, false), (true, false));
        // 0.1 s make up for 0.03 s
        assert_eq!(record(8_090, true), (true, false));
        assert_eq!(record(8_219, false), (true, false));
        assert_eq!(record(8_249, false), (false, false));
        // more of it changes nothing
        assert_eq!(record(8_249, false), (false, false));
        for at_ms in (8_299..8_849).step_by(50) {
            assert_eq!(record(at_ms, true), (false, false), "{at_ms}");
        }
        assert_eq!(record(8_850, true), (true, true));
    }
}
