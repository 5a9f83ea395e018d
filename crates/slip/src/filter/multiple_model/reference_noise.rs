//! The noise of a reference, learnt from its own readings.

use grouser_real::Real;

/// Number of second differences kept.
const KEPT: usize = 32;
/// The noise is learnt from at least this many.
const ENOUGH: usize = 8;
/// Step of the logarithm of the lasting median per second difference: its own deviation is then 5 %, its memory some 200.
const LASTING_STEP: f64 = 0.005;
/// The lasting median follows that of the kept differences where they differ by more than this factor: the noise itself has
/// changed. The kept ones' median deviates by some 25 % of itself.
const MAX_FACTOR: f64 = 2.0;
/// The median of |N(0, 1)|.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_75;
/// Variance of the second difference of white noise over that of the noise.
const SECOND_DIFFERENCE: f64 = 6.0;

/// Standard deviation of readings (positions, headings) about the way or the turn of the wheels and the gyro, by the median of second differences: a constant slip
/// drops out, and outliers and changes of slip are few. The median is followed in small steps: that of few differences would
/// make the noise itself noisy.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceNoise<const AXES: usize> {
    last: [[f64; AXES]; 2],
    seen: usize,
    sizes: [f64; KEPT],
    next: usize,
    count: usize,
    /// The median over a long time.
    lasting: Option<f64>,
}

impl<const AXES: usize> ReferenceNoise<AXES> {
    pub(crate) const fn new() -> Self {
        Self {
            last: [[0.0; AXES]; 2],
            seen: 0,
            sizes: [0.0; KEPT],
            next: 0,
            count: 0,
            lasting: None,
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
            self.sizes[self.next] = size;
            self.next = (self.next + 1) % KEPT;
            self.count = (self.count + 1).min(KEPT);
            if let Some(lasting) = &mut self.lasting {
                let up = f64::from(u8::from(size > *lasting)) - 0.5;
                *lasting *= 1.0 + 2.0 * LASTING_STEP * up;
            }
        }
        if self.count >= ENOUGH {
            let mut sorted = self.sizes;
            let sorted = &mut sorted[..self.count];
            sorted.sort_unstable_by(f64::total_cmp);
            let median = sorted[self.count / 2];
            let follows = self.lasting.is_none_or(|lasting| {
                self.count < KEPT || median > MAX_FACTOR * lasting || lasting > MAX_FACTOR * median
            });
            if follows {
                self.lasting = Some(median);
            }
        }
    }

    /// Restarts the differences after a gap or in a new frame; what was learnt stays.
    pub(crate) fn interrupt(&mut self) {
        self.seen = 0;
    }

    /// The learnt standard deviation, in the unit of the readings.
    pub(crate) fn learnt(&self) -> Option<f64> {
        self.lasting
            .map(|median| median / (MEDIAN_OF_NORMAL * Real::sqrt(SECOND_DIFFERENCE)))
    }

    /// Standard deviation of one reading on one axis.
    pub(crate) fn sigma(&self, prior: f64) -> f64 {
        self.learnt().unwrap_or(prior)
    }
}
