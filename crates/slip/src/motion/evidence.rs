//! What a step shows of a mode, and readings that may be outliers.
//!
//! A reading is good, or an outlier whose noise is [`OUTLIER_SIGMA`] times as large; the belief after it has the moments of both updates.
//! No reading is refused: one that stays is followed.

use grouser_real::Real;

use super::belief::{Belief, Row};
use super::noise::KINDS;

/// Share of outliers among readings of a reference, and their size in sigma: a prior, two of a hundred GNSS fixes or camera poses.
pub const OUTLIERS: f64 = 0.02;
/// See [`OUTLIERS`].
pub const OUTLIER_SIGMA: f64 = 30.0;

/// What the measurements of a step show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    /// The log-likelihood of the innovations, up to a constant that all modes share.
    pub likelihood: f64,
    /// For each kind of reading the probability that it is good, and its squared noise where it is: both summed over the numbers read in
    /// the step.
    pub noise: [[f64; 2]; KINDS],
}

/// What a reading is where its innovation is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Log-likelihood of the innovation, up to a constant.
    pub likelihood: f64,
    /// Probability that the reading is good.
    pub good: f64,
    /// The expectation of its squared noise, were it good, summed over its numbers.
    pub square: f64,
}

/// Logarithm of the normal density of an innovation, up to a constant.
#[must_use]
pub fn log_density(innovation: f64, variance: f64) -> f64 {
    -0.5 * (innovation * innovation / variance + Real::ln(variance))
}

/// Powered wheels contradict a mode beyond this many sigma.
const SURPRISE: f64 = 2.0;

/// What the innovation of a powered wheel adds to a mode's log-likelihood: nothing within two sigma. Errors of a wheel in a row are of
/// one cause (a count, a bump, the accelerometer between them), and as independent ones they would show that the slip is steady while it
/// drifts away.
#[must_use]
pub fn surprise(innovation: f64, variance: f64) -> f64 {
    -0.5 * (innovation * innovation / variance - SURPRISE * SURPRISE).max(0.0)
}

impl Belief {
    /// The update by one reading whose numbers are outliers together, with a probability of [`OUTLIERS`]; `variance` is that of the
    /// noise of each. Judged one after the other, a place that is right across the motion and wrong along it would count as good.
    pub fn update_mixed(&mut self, rows: &[Row], values: &[f64], variance: f64) -> Judgement {
        let read = || rows.iter().zip(values);
        let after = |variance: f64| {
            let (mut belief, mut density) = (*self, 0.0);
            for (row, value) in read() {
                let innovation = value - belief.mean_of(row);
                let total = belief.update(row, innovation, variance).variance;
                density += log_density(innovation, total);
            }
            (belief, density)
        };
        let (good, density) = after(variance);
        let of_good = Real::ln(1.0 - OUTLIERS) + density;
        let (outlier, density) = after(variance * OUTLIER_SIGMA * OUTLIER_SIGMA);
        let of_outlier = Real::ln(OUTLIERS) + density;
        let less = Real::exp(-(of_good - of_outlier).abs());
        let share = if of_good > of_outlier { 1.0 } else { less } / (1.0 + less);
        *self = Self::mixture([(share, &good), (1.0 - share, &outlier)].into_iter());
        let left = read().map(|(row, value)| {
            let error = value - good.mean_of(row);
            error * error + good.variance_of(row)
        });
        Judgement {
            likelihood: of_good.max(of_outlier) + Real::ln_1p(less),
            good: share,
            square: left.sum(),
        }
    }
}
