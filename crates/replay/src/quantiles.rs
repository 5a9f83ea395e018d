//! Quantiles of a stream in fixed memory.

/// Half-width of the interval that contains 90 % of a normal distribution, in standard deviations: its 95 % quantile.
pub(crate) const SIGMAS_90: f64 = 1.644_854;

/// How finely a range is divided.
const BINS: usize = 1 << 16;

/// Quantiles of values in a range, to 1/65536 of it: a histogram, so that memory does not grow with
/// the log. Values outside the range count at its ends.
///
/// ```
/// use grouser_replay::Quantiles;
///
/// let mut quantiles = Quantiles::new(0.0, 1.0);
/// for i in 0..100 {
///     quantiles.add(f64::from(i) / 100.0);
/// }
/// assert!((quantiles.at(0.5).unwrap() - 0.5).abs() < 0.02);
/// ```
#[derive(Clone, Debug)]
pub struct Quantiles {
    low: f64,
    width: f64,
    bins: Vec<u32>,
    count: u64,
}

impl Quantiles {
    /// An empty stream of values in [low, high].
    ///
    /// ```
    /// use grouser_replay::Quantiles;
    ///
    /// assert_eq!(Quantiles::new(0.0, 1.0).count(), 0);
    /// ```
    #[must_use]
    pub fn new(low: f64, high: f64) -> Self {
        Self {
            low,
            width: (high - low) / BINS as f64,
            bins: vec![0; BINS],
            count: 0,
        }
    }

    /// Adds a value; NaN is left out.
    pub fn add(&mut self, value: f64) {
        if value.is_nan() {
            return;
        }
        let place = ((value - self.low) / self.width).clamp(0.0, (BINS - 1) as f64);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped on the line above"
        )]
        let bin = place as usize;
        self.bins[bin] = self.bins[bin].saturating_add(1);
        self.count += 1;
    }

    /// How many values there were.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The value below which the share `share` of them lies, `None` of none.
    ///
    /// ```
    /// use grouser_replay::Quantiles;
    ///
    /// let mut quantiles = Quantiles::new(-1.0, 1.0);
    /// assert_eq!(quantiles.at(0.5), None);
    /// quantiles.add(0.25);
    /// quantiles.add(f64::NAN); // left out
    /// assert!((quantiles.at(0.5).unwrap() - 0.25).abs() < 1e-4 && quantiles.count() == 1);
    /// ```
    #[must_use]
    pub fn at(&self, share: f64) -> Option<f64> {
        if self.count == 0 {
            return None;
        }
        let wanted = share * self.count as f64;
        let mut below = 0.0;
        for (bin, &count) in self.bins.iter().enumerate() {
            let here = f64::from(count);
            if count > 0 && below + here >= wanted {
                let part = ((wanted - below) / here).clamp(0.0, 1.0);
                return Some(self.low + (bin as f64 + part) * self.width);
            }
            below += here;
        }
        Some(self.low + BINS as f64 * self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_sorted_values_to_a_bin() {
        let mut values = Quantiles::new(-1.0, 1.0);
        let mut sorted = Vec::new();
        for i in 0..10_001_u32 {
            // A permutation of an uneven grid.
            let value = (f64::from(i * 7919 % 10_001) / 10_001.0).powi(2) - 0.3;
            values.add(value);
            sorted.push(value);
        }
        sorted.sort_by(f64::total_cmp);
        for (share, rank) in [(0.05, 500), (0.5, 5000), (0.95, 9500)] {
            assert!((values.at(share).unwrap() - sorted[rank]).abs() < 3e-4);
        }
    }

    #[test]
    fn nothing_has_no_quantile_and_ends_hold_what_lies_outside() {
        let mut values = Quantiles::new(0.0, 1.0);
        assert_eq!(values.at(0.5), None);
        values.add(f64::NAN);
        assert_eq!(values.count(), 0);
        values.add(7.0);
        assert!((values.at(0.5).unwrap() - 1.0).abs() < 1e-4);
    }
}
