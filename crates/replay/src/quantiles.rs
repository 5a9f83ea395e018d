//! Quantiles of a stream in fixed memory.

/// How finely a range is divided.
const BINS: usize = 1 << 16;

/// Quantiles of values in a range, to 1/65536 of it: a histogram, so that memory does not grow with
/// the log. Values outside the range count at its ends.
#[derive(Clone, Debug)]
pub struct Quantiles {
    low: f64,
    width: f64,
    bins: Vec<u64>,
    count: u64,
}

impl Quantiles {
    /// An empty stream of values in [low, high].
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
        self.bins[bin] += 1;
        self.count += 1;
    }

    /// How many values there were.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// The value below which the share `share` of them lies, `None` of none.
    #[must_use]
    pub fn at(&self, share: f64) -> Option<f64> {
        if self.count == 0 {
            return None;
        }
        let wanted = share * self.count as f64;
        let mut below = 0.0;
        for (bin, &count) in self.bins.iter().enumerate() {
            let here = count as f64;
            if count > 0 && below + here >= wanted {
                let part = ((wanted - below) / here).clamp(0.0, 1.0);
                return Some(self.low + (bin as f64 + part) * self.width);
            }
            below += here;
        }
        Some(self.low + BINS as f64 * self.width)
    }
}
