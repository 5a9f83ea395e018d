//! The usual time between the readings of a sensor.

/// Number of readings over which a period is averaged; half of them give a first value.
const READINGS: f64 = 8.0;
/// A sensor is silent after this number of its periods. A prior: one lost reading is usual, two in a row are not.
pub(crate) const GAP_PERIODS: f64 = 3.0;

/// The mean time between the readings of a sensor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Period {
    sum: f64,
    count: f64,
}

impl Period {
    /// Another reading came after `passed` (s).
    pub(crate) fn push(&mut self, passed: f64) {
        let kept = if self.count >= READINGS { 0.5 } else { 1.0 };
        self.sum = kept * self.sum + passed;
        self.count = kept * self.count + 1.0;
    }

    /// The mean time, s; 0 while it is not known.
    pub(crate) fn mean(&self) -> f64 {
        if self.count >= 0.5 * READINGS {
            self.sum / self.count
        } else {
            0.0
        }
    }
}
