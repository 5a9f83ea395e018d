//! What a step shows of a mode, and readings that may be outliers.
//!
//! A reading is good, or an outlier whose noise is [`OUTLIER_SIGMA`] times as large. Both updates change the belief along P h, so the
//! Gaussian with the moments of their mixture is again one update of rank one. No reading is refused: one that stays is followed.

use grouser_real::Real;

use super::belief::{Belief, Row, dot};
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
    /// For each kind of reading the probability that it is good, and its squared noise where it is: both summed over the step.
    pub noise: [[f64; 2]; KINDS],
}

/// What a reading is where its innovation is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Log-likelihood of the innovation, up to a constant.
    pub likelihood: f64,
    /// Probability that the reading is good.
    pub good: f64,
    /// The expectation of its squared noise, were it good.
    pub square: f64,
}

/// Logarithm of the normal density of an innovation, up to a constant.
#[must_use]
pub fn log_density(innovation: f64, variance: f64) -> f64 {
    -0.5 * (innovation * innovation / variance + Real::ln(variance))
}

impl Belief {
    /// The update by one scalar reading that is an outlier with a probability of `outliers`.
    pub fn update_mixed(
        &mut self,
        row: &Row,
        innovation: f64,
        variance: f64,
        outliers: f64,
    ) -> Judgement {
        let spread = self.spread(row);
        let own = dot(row, &spread);
        let total = own + variance;
        let wide = own + variance * OUTLIER_SIGMA * OUTLIER_SIGMA;
        let of_good = Real::ln(1.0 - outliers) + log_density(innovation, total);
        let of_outlier = Real::ln(outliers) + log_density(innovation, wide);
        let less = Real::exp(-(of_good - of_outlier).abs());
        let good = if of_good > of_outlier { 1.0 } else { less } / (1.0 + less);
        let gain = good / total + (1.0 - good) / wide;
        let between = innovation * (1.0 / total - 1.0 / wide);
        let taken = gain - good * (1.0 - good) * between * between;
        for (i, &of) in spread.iter().enumerate() {
            self.mean[i] += gain * innovation * of;
            for (p, other) in self.covariance[i].iter_mut().zip(&spread) {
                *p -= taken * of * other;
            }
        }
        let left = innovation * variance / total;
        Judgement {
            likelihood: of_good.max(of_outlier) + Real::ln_1p(less),
            good,
            square: left * left + own * variance / total,
        }
    }
}
