//! The noise of a reference, learnt from its own readings.

use grouser_real::Real;

use crate::sample::Measurement;

/// Number of second differences kept.
const KEPT: usize = 32;
/// The noise is learnt from at least this many.
const ENOUGH: usize = 8;
/// Step of the logarithm of the lasting median per second difference: its own deviation is then 5 %, its memory some 200.
const LASTING_STEP: f64 = 0.005;
/// The lasting median follows that of the kept differences where they differ by more than this factor, to within the smaller
/// one: the noise itself has changed. The kept ones' median deviates by some 25 % of itself, and by chance by more.
const MAX_FACTOR: f64 = 2.0;
const FOLLOWED_FACTOR: f64 = core::f64::consts::SQRT_2;
/// The median of |N(0, 1)|.
pub(super) const MEDIAN_OF_NORMAL: f64 = 0.674_489_75;
/// Variance of the second difference over that of the noise where each reading has its own, and where each adds its own to a sum.
pub(super) const SECOND_DIFFERENCE: f64 = 6.0;
const SECOND_DIFFERENCE_OF_SUM: f64 = 2.0;
/// A sum of displacements is read with this share of the error that one adds to it: an outlier is some ten times that error.
const SUM_SHARE: f64 = 0.3;

/// How the errors of a reference's readings depend on one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Errors {
    /// Each reading has its own: positions, headings, speeds.
    Independent,
    /// Each reading adds its own to those before: sums of displacements.
    Summed,
}

impl Errors {
    /// Of a kind of measurement.
    pub(crate) const fn of(measurement: &Measurement) -> Self {
        match measurement {
            Measurement::Displacement { .. } => Self::Summed,
            _ => Self::Independent,
        }
    }
}

/// Standard deviations of a reference, in the unit of its readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Of one reading.
    pub(crate) reading: f64,
    /// Of what its frame wanders from one reading to the next.
    pub(crate) wander: f64,
}

/// The size of second differences: their median, followed in small steps. That of few would make the noise itself noisy.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    sizes: [f64; KEPT],
    next: usize,
    count: usize,
    /// The median over a long time.
    pub(super) lasting: Option<f64>,
}

impl Scale {
    pub(super) const NEW: Self = Self {
        sizes: [0.0; KEPT],
        next: 0,
        count: 0,
        lasting: None,
    };

    /// Adds a size; one below `least` is no evidence of less.
    pub(super) fn push(&mut self, size: f64, least: f64) {
        self.sizes[self.next] = size.max(least);
        self.next = (self.next + 1) % KEPT;
        self.count = (self.count + 1).min(KEPT);
        if let Some(lasting) = self.lasting.as_mut().filter(|_| size >= least) {
            let up = f64::from(u8::from(size > *lasting)) - 0.5;
            *lasting *= 1.0 + 2.0 * LASTING_STEP * up;
        }
    }

    /// Follows the kept sizes where they have changed.
    pub(super) fn follow(&mut self) {
        if self.count < ENOUGH {
            return;
        }
        let mut sorted = self.sizes;
        let sorted = &mut sorted[..self.count];
        sorted.sort_unstable_by(f64::total_cmp);
        let median = sorted[self.count / 2];
        self.lasting = Some(match self.lasting.filter(|_| self.count == KEPT) {
            Some(lasting) if median > MAX_FACTOR * lasting => median / FOLLOWED_FACTOR,
            Some(lasting) if lasting > MAX_FACTOR * median => median * FOLLOWED_FACTOR,
            Some(lasting) => lasting,
            None => median,
        });
    }

    /// The standard deviation of a second difference.
    pub(super) fn deviation(&self) -> Option<f64> {
        self.lasting.map(|median| median / MEDIAN_OF_NORMAL)
    }
}

/// Standard deviation of readings (headings, speeds, forces) about the turn or the speed of the wheels and the gyro, by the median of
/// second differences: a constant slip drops out, and outliers and changes of slip are few.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceNoise<const AXES: usize> {
    last: [[f64; AXES]; 2],
    seen: usize,
    scale: Scale,
}

impl<const AXES: usize> ReferenceNoise<AXES> {
    pub(crate) const fn new() -> Self {
        Self {
            last: [[0.0; AXES]; 2],
            seen: 0,
            scale: Scale::NEW,
        }
    }

    /// Adds a reading less what the wheels or the gyro say.
    pub(crate) fn push(&mut self, reading: [f64; AXES]) {
        let [before, last] = self.last;
        self.last = [last, reading];
        self.seen += 1;
        if self.seen < 3 {
            return;
        }
        for axis in 0..AXES {
            let size = (reading[axis] - 2.0 * last[axis] + before[axis]).abs();
            self.scale.push(size, 0.0);
        }
        self.scale.follow();
    }

    /// The learnt standard deviation, in the unit of the readings.
    pub(crate) fn learnt(&self) -> Option<f64> {
        self.scale
            .deviation()
            .map(|deviation| deviation / Real::sqrt(SECOND_DIFFERENCE))
    }

    /// Standard deviation of one reading on one axis; `prior` until it is learnt.
    pub(crate) fn sigma(&self, prior: f64) -> f64 {
        self.learnt().unwrap_or(prior)
    }

    /// The noise of one reading on one axis, by how errors depend on one another; `prior` until it is learnt.
    pub(crate) fn noise(&self, errors: Errors, prior: f64) -> Noise {
        Noise::of(errors, self.learnt(), prior)
    }
}

impl Noise {
    /// By how errors depend on one another, for a learnt standard deviation of independent ones; `prior` until it is learnt.
    pub(super) fn of(errors: Errors, learnt: Option<f64>, prior: f64) -> Self {
        match errors {
            Errors::Independent => Self {
                reading: learnt.unwrap_or(prior),
                wander: 0.0,
            },
            Errors::Summed => {
                let own = SECOND_DIFFERENCE_OF_SUM + SECOND_DIFFERENCE * SUM_SHARE * SUM_SHARE;
                let factor = Real::sqrt(SECOND_DIFFERENCE / own);
                let wander = learnt.map_or(prior, |learnt| factor * learnt);
                Self {
                    reading: SUM_SHARE * wander,
                    wander,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
