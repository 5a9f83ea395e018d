//! Do the filter's residuals have the size that it says?

/// 95 % of a χ² of one degree of freedom lie below this.
const CHI_SQUARE_95: f64 = 3.841_459;
/// The sensors whose residuals are counted apart.
const KINDS: [&str; 3] = ["wheels", "yaw_rate", "reference"];

/// Squared residuals over their variances (NIS) of one kind of sensor: with right sigmas their mean is 1 and 0.95 of
/// them lie in the 95 % band, below 3.84.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Consistency {
    /// How many residuals there were.
    pub count: u64,
    /// Their mean.
    pub mean: Option<f64>,
    /// The share of them in the 95 % band.
    pub in_band: Option<f64>,
}

/// The same of every kind, while it is counted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Residuals {
    counts: [(u64, u64, f64); KINDS.len()],
    last: u64,
}

impl Residuals {
    /// What the filter shows after a measurement of `kind`; one that entered nothing leaves the last figure standing.
    pub(crate) fn add(&mut self, kind: Kind, nis: f64) {
        if std::mem::replace(&mut self.last, nis.to_bits()) == nis.to_bits() {
            return;
        }
        let (count, within, sum) = &mut self.counts[kind as usize];
        *count += 1;
        *within += u64::from(nis <= CHI_SQUARE_95);
        *sum += nis;
    }

    pub(crate) fn summary(&self) -> Vec<(&'static str, Consistency)> {
        let one = |&(count, within, sum): &(u64, u64, f64)| Consistency {
            count,
            mean: (count > 0).then(|| sum / count as f64),
            in_band: (count > 0).then(|| within as f64 / count as f64),
        };
        KINDS.into_iter().zip(self.counts.iter().map(one)).collect()
    }
}

/// A kind of sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Wheel,
    YawRate,
    Reference,
}
