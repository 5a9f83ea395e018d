//! What is believed of the soil: 16 weights, and what follows from them.

use grouser_real::Real;

use super::family::{LEVELS, SoilFamily};
use super::settings::SoilLearnSettings;
use crate::error::{Result, check_range};
use crate::prior::{STIFFNESSES, STRENGTHS};

/// Half of the probability beside an interval of 90 %.
const TAIL_PROBABILITY: f64 = 0.05;

/// The weights of the 16 soils, and how wide their intervals have to be: plain numbers that outlast a
/// restart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilBelief {
    /// One per member of the family; their sum is 1.
    pub weights: [f64; LEVELS],
    /// Width of the intervals over the computed one: it follows how often they missed.
    pub error_scale: f64,
}

/// A mean with its interval of 90 %.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilInterval {
    /// Mean.
    pub mean: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// What has been learnt of the soil. The intervals cover the family alone: soil of another kind may lie outside.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilEstimate {
    /// Cohesion and tan φ as multiples of the known soil's.
    pub strength: SoilInterval,
    /// Pressure-sinkage moduli as multiples of the known soil's.
    pub stiffness: SoilInterval,
    /// Angle of internal friction, rad.
    pub friction_angle: SoilInterval,
    /// Readings that entered.
    pub readings: u32,
    /// How many of them had a sinkage or an entry angle.
    pub contact_readings: u32,
    /// Sinkages and entry angles that were refused: not finite, below 0 or beyond the radius.
    pub contacts_refused: u32,
    /// Readings of a wheel that were left out because its sensor repeated itself.
    pub contacts_stuck: u32,
    /// How often the belief in use changed.
    pub changes: u32,
    /// Width of the intervals of the pull over the computed one: it follows how often they missed.
    pub error_scale: f64,
}

impl SoilBelief {
    /// Before anything is learnt.
    pub(super) fn prior(settings: &SoilLearnSettings, family: &SoilFamily) -> Self {
        let [strength, stiffness] = settings.prior_sigma_ln;
        let mut weights = [0.0; LEVELS];
        for (weight, member) in weights.iter_mut().zip(family.members()) {
            let a = Real::ln(member.strength) / strength;
            let b = Real::ln(member.stiffness) / stiffness;
            *weight = Real::exp(-0.5 * (a * a + b * b));
        }
        let mut out = Self {
            weights,
            error_scale: 1.0,
        };
        // a Gaussian of finite numbers vanishes nowhere
        let _ = out.normalise();
        out
    }

    /// Checks numbers that come from outside.
    pub(in crate::onboard) fn check(&self) -> Result<()> {
        const OF: &str = "soil belief";
        for weight in self.weights {
            check_range(OF, "weight", weight, (0.0, 1.0), "1")?;
        }
        let sum = self.weights.iter().sum();
        check_range(OF, "sum of the weights", sum, (0.999, 1.001), "1")?;
        check_range(OF, "error_scale", self.error_scale, ERROR_SCALE_LIMITS, "1")
    }

    /// False where all weights have vanished.
    pub(super) fn normalise(&mut self) -> bool {
        let sum: f64 = self.weights.iter().sum();
        for weight in &mut self.weights {
            *weight /= sum;
        }
        sum > 0.0
    }

    /// The total variation between two beliefs.
    pub(super) fn difference(&self, other: &Self) -> f64 {
        let pairs = self.weights.iter().zip(&other.weights);
        pairs.map(|(a, b)| 0.5 * (a - b).abs()).sum()
    }

    /// Strength, by its own weights.
    pub(super) fn strength(&self) -> SoilInterval {
        let mut of = [0.0; STRENGTHS.len()];
        for (index, weight) in self.weights.iter().enumerate() {
            of[index / STIFFNESSES.len()] += weight;
        }
        interval(&STRENGTHS, &of)
    }

    /// Stiffness, by its own weights.
    pub(super) fn stiffness(&self) -> SoilInterval {
        let mut of = [0.0; STIFFNESSES.len()];
        for (index, weight) in self.weights.iter().enumerate() {
            of[index % STIFFNESSES.len()] += weight;
        }
        interval(&STIFFNESSES, &of)
    }
}

/// Limits of the intervals' width over the computed one.
pub(super) const ERROR_SCALE_LIMITS: (f64, f64) = (0.2, 5.0);

/// Mean and interval of a multiple: each level stands for the multiples that are nearest to it by their logarithm, so that
/// no interval is narrower than the levels lie apart.
fn interval<const N: usize>(levels: &[f64; N], weights: &[f64; N]) -> SoilInterval {
    let ln = levels.map(Real::ln);
    let bounds = |index: usize| {
        let below = if index == 0 {
            ln[1] - ln[0]
        } else {
            ln[index] - ln[index - 1]
        };
        let above = if index + 1 == N {
            below
        } else {
            ln[index + 1] - ln[index]
        };
        (ln[index] - 0.5 * below, ln[index] + 0.5 * above)
    };
    let quantile = |share: f64| {
        let mut sum = 0.0;
        for (index, weight) in weights.iter().enumerate() {
            if sum + weight >= share && *weight > 0.0 {
                let (low, high) = bounds(index);
                return Real::exp(low + (high - low) * (share - sum) / weight);
            }
            sum += weight;
        }
        Real::exp(bounds(N - 1).1)
    };
    SoilInterval {
        mean: levels.iter().zip(weights).map(|(a, w)| a * w).sum(),
        low: quantile(TAIL_PROBABILITY),
        high: quantile(1.0 - TAIL_PROBABILITY),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_covers_its_level_and_no_more() {
        let one = interval(&STRENGTHS, &[0.0, 1.0, 0.0, 0.0]);
        // half-way to 0.45 and to 1.0 by the logarithm: 0.561 and 0.837, less 5 % of that on either side
        let (low, high) = ((0.45_f64 * 0.7).sqrt(), 0.7_f64.sqrt());
        let ratio = high / low;
        assert!((one.low - low * ratio.powf(0.05)).abs() < 1e-12);
        assert!((one.high - low * ratio.powf(0.95)).abs() < 1e-12);
        assert!((one.mean - 0.7).abs() < 1e-12);
    }

    /// Quantiles of a density that is flat in the logarithm over each level's cell, by sums over small pieces of it.
    #[test]
    fn intervals_are_quantiles_of_cells_in_the_logarithm() {
        let levels = [0.5, 1.0, 3.0];
        // half-way to the neighbours, and as far outwards as inwards
        let bounds = [
            0.5 / 2.0_f64.sqrt(),
            0.5_f64.sqrt(),
            3.0_f64.sqrt(),
            3.0 * 3.0_f64.sqrt(),
        ];
        for weights in [
            [0.2, 0.5, 0.3],
            [0.0, 0.04, 0.96],
            [0.7, 0.3, 0.0],
            [0.05, 0.9, 0.05],
        ] {
            let found = interval(&levels, &weights);
            let mean: f64 = levels.iter().zip(weights).map(|(a, w)| a * w).sum();
            assert!((found.mean - mean).abs() < 1e-12);
            let below = |x: f64| -> f64 {
                let share = |k: usize| {
                    let (low, high) = (bounds[k].ln(), bounds[k + 1].ln());
                    ((x.ln() - low) / (high - low)).clamp(0.0, 1.0)
                };
                (0..3).map(|k| weights[k] * share(k)).sum()
            };
            assert!(
                (below(found.low) - TAIL_PROBABILITY).abs() < 1e-12,
                "{weights:?}"
            );
            assert!(
                (below(found.high) - 1.0 + TAIL_PROBABILITY).abs() < 1e-12,
                "{weights:?}"
            );
        }
    }

    #[test]
    fn without_any_weight_an_interval_ends_above_the_last_cell() {
        let none = interval(&[0.5, 1.0, 3.0], &[0.0; 3]);
        assert_eq!((none.low, none.high), (none.high, none.low));
        assert!((none.low - 3.0 * 3.0_f64.sqrt()).abs() < 1e-12);
    }
}
