//! Readings of a reference that contradict the models one after the other.

/// A reading with a larger probability of being an outlier is refused.
const MAX_OUTLIER_PROBABILITY: f64 = 0.5;
/// This many refused readings in a row are a steady reference, which is right: at 10 Hz outliers of satellite and visual positions
/// last for less.
const MAX_REFUSED: u32 = 6;

/// Is a reading accepted that is no outlier with the probability `inlier`?
pub(super) fn is_accepted(inlier: f64) -> bool {
    1.0 - inlier <= MAX_OUTLIER_PROBABILITY
}

/// How many readings have been refused one after the other.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RefusedSeries(u32);

impl RefusedSeries {
    /// Counts a reading that is no outlier with the probability `inlier`. Is it accepted?
    pub(super) fn accepts(&mut self, inlier: f64) -> bool {
        let is_accepted = is_accepted(inlier);
        self.0 = if is_accepted { 0 } else { self.0 + 1 };
        is_accepted
    }

    /// Is the series so long that the reference is right?
    pub(super) const fn is_steady(self) -> bool {
        self.0 >= MAX_REFUSED
    }

    /// The number of refused readings.
    pub(super) const fn len(self) -> u32 {
        self.0
    }

    /// The next reading begins a new series.
    pub(super) const fn end(&mut self) {
        self.0 = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_is_accepted_that_is_an_outlier_as_probably_as_not() {
        assert!(is_accepted(0.5) && !is_accepted(0.5 - f64::EPSILON));
    }
}
