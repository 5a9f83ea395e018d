//! What is to be small when an objective has a value in every world.

use crate::error::{Error, Result};

/// A measure of risk over K equally likely worlds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Measure {
    /// Every objective in every world counts by itself: m·K partial functions.
    WorstCase,
    /// mean + κ σ of each objective over the worlds (σ² with 1/K).
    MeanPlusDeviations {
        /// κ ≥ 0.
        kappa: f64,
    },
    /// The mean of each objective over its worst share 1 − α of the worlds.
    ConditionalValueAtRisk {
        /// α in [0, 1): 0 is the plain mean, towards 1 the worst case.
        alpha: f64,
    },
}

impl Measure {
    pub(super) fn check(self) -> Result<()> {
        match self {
            Self::WorstCase => Ok(()),
            Self::MeanPlusDeviations { kappa } => Error::check_range("kappa", kappa, 0.0, 1e6),
            Self::ConditionalValueAtRisk { alpha } => {
                Error::check_range("alpha", alpha, 0.0, 1.0 - 1e-9)
            }
        }
    }
}
