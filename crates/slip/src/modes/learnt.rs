//! The noise of the reference, learnt from its readings.

use super::table::MODES;
use crate::motion::{Evidence, KINDS, Levels, Noise};

/// The prior weighs as much as this many readings.
const PRIOR_READINGS: f64 = 2.0;
/// The first level is the square of this many described sigmas. Learning comes from the wide side: where noise is taken for too
/// small, slip that jumps explains all of it, and nothing is left to learn from.
const WIDE: f64 = 2.0;
/// The level follows the last readings, this many.
const MEMORY_READINGS: f64 = 100.0;
/// A level is within these factors of its prior: a sensor is not ten times better nor a hundred times worse than described. Outliers
/// are 30 times as large, so that a reference that stays elsewhere is followed.
const FACTORS: [f64; 2] = [1e-2, 1e4];

/// The kinds that are learnt.
pub(super) const LEARNT: [Noise; 3] = [Noise::Place, Noise::Heading, Noise::SpeedReading];

/// The levels of noise. Those of readings are the mean of the squared noise that each reading is expected to have after its update
/// (Särkkä and Nummenmaa 2009), weighed by the probability that it is no outlier, next to a prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LearntNoise {
    prior: Levels,
    levels: Levels,
    /// Of each kind the number of readings, and the sum of their squared noise.
    sums: [[f64; 2]; KINDS],
}

impl LearntNoise {
    pub(super) fn new(prior: Levels) -> Self {
        let sums = prior
            .0
            .map(|level| [PRIOR_READINGS, PRIOR_READINGS * WIDE * WIDE * level]);
        let mut levels = prior;
        for kind in LEARNT {
            levels.0[kind as usize] *= WIDE * WIDE;
        }
        Self {
            prior,
            levels,
            sums,
        }
    }

    /// Forgets what was learnt.
    pub(super) fn begin(&mut self) {
        *self = Self::new(self.prior);
    }

    pub(super) const fn levels(&self) -> &Levels {
        &self.levels
    }

    pub(super) const fn set_level(&mut self, noise: Noise, level: f64) {
        self.levels.0[noise as usize] = level;
    }

    /// Learns from the evidence of each mode.
    pub(super) fn learn(&mut self, evidence: &[Evidence; MODES], weights: &[f64; MODES]) {
        for kind in LEARNT {
            let kind = kind as usize;
            let mean = |part: usize| -> f64 {
                let of = evidence.iter().zip(weights);
                of.map(|(of, weight)| weight * of.noise[kind][part]).sum()
            };
            let (count, squares) = (mean(0), mean(1));
            if count <= 0.0 {
                continue;
            }
            let sums = &mut self.sums[kind];
            let kept = 1.0 - (count / MEMORY_READINGS).min(1.0);
            *sums = [kept * sums[0] + count, kept * sums[1] + squares];
            let prior = self.prior.0[kind];
            let level = sums[1] / sums[0];
            self.levels.0[kind] = level.clamp(prior * FACTORS[0], prior * FACTORS[1]);
        }
    }
}
