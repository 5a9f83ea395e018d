//! A function followed along its argument: samples, and more of them wherever it may turn and pass zero unseen.

/// Samples at most: a search begins with 11 to 34.
const CAPACITY: usize = 96;

/// By how much a cubic through both ends of an interval leaves their chord, per difference of its end slopes from the chord's
/// and per length: the maximum of t (1 − t)².
const CUBIC_BULGE: f64 = 4.0 / 27.0;

/// Slopes of samples are known to about this factor.
const SLOPE_DOUBT: f64 = 2.0;

/// Does a cubic between two ends, with slopes there and its chord's, only rise or only fall? (Fritsch & Carlson, *Monotone
/// piecewise cubic interpolation*, SIAM J. Numer. Anal. 17, 1980.)
pub(crate) fn is_monotone(chord: f64, slopes: [f64; 2]) -> bool {
    slopes
        .iter()
        .all(|slope| (0.0..=3.0).contains(&(slope / chord)))
}

/// Samples (place, value) in rising order of their places.
pub(crate) struct Followed {
    samples: [(f64, f64); CAPACITY],
    len: usize,
    /// Intervals below this are not divided.
    resolution: f64,
}

impl Followed {
    pub(crate) const fn new(resolution: f64) -> Self {
        Self {
            samples: [(0.0, 0.0); CAPACITY],
            len: 0,
            resolution,
        }
    }

    fn samples(&self) -> &[(f64, f64)] {
        &self.samples[..self.len]
    }

    /// Adds a sample, while there is room and no other one within the resolution; −∞ where the function has no value.
    pub(crate) fn add(&mut self, place: f64, value: f64) {
        let at = self.samples().partition_point(|sample| sample.0 < place);
        let mut beside = self.samples()[at.saturating_sub(1)..].iter().take(2);
        let is_new = beside.all(|sample| (sample.0 - place).abs() >= self.resolution);
        if self.len < CAPACITY && is_new {
            self.samples.copy_within(at..self.len, at + 1);
            self.samples[at] = (place, value);
            self.len += 1;
        }
    }

    /// The slope of the chord behind a sample; `None` behind the last one and beside one without a value.
    fn chord(&self, at: usize) -> Option<f64> {
        let pair = self.samples().get(at..at + 2)?;
        let chord = (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
        chord.is_finite().then_some(chord)
    }

    /// The slope at a sample: of the parabola through its neighbours.
    fn slope(&self, at: usize) -> f64 {
        let before = at.checked_sub(1).and_then(|before| self.chord(before));
        match (before, self.chord(at)) {
            (Some(before), Some(behind)) => {
                let place = |at: usize| self.samples[at].0;
                let share = (place(at) - place(at - 1)) / (place(at + 1) - place(at - 1));
                before + share * (behind - before)
            }
            (Some(only), None) | (None, Some(only)) => only,
            (None, None) => 0.0,
        }
    }

    /// May the function turn behind a sample, before the next one, and pass zero there?
    fn may_pass_unseen(&self, at: usize, chord: f64) -> bool {
        let [(from, a), (to, b)] = [self.samples[at], self.samples[at + 1]];
        let slopes = [self.slope(at), self.slope(at + 1)];
        if to - from <= 2.0 * self.resolution || is_monotone(chord, slopes) {
            return false;
        }
        let off: f64 = slopes.iter().map(|slope| (slope - chord).abs()).sum();
        let bulge = CUBIC_BULGE * off * (to - from);
        (a < 0.0) != (b < 0.0) || a.abs().min(b.abs()) <= SLOPE_DOUBT * bulge
    }

    /// The middle of the first interval in which the function may pass zero unseen, or in which its values begin or end; `None` once
    /// it is followed.
    pub(crate) fn next_place(&self) -> Option<f64> {
        let unseen = |at: &usize| match (self.chord(*at), self.samples().get(at + 1)) {
            (Some(chord), _) => self.may_pass_unseen(*at, chord),
            (None, Some(behind)) => {
                let before = self.samples[*at];
                before.1.is_finite() != behind.1.is_finite()
                    && behind.0 - before.0 > 2.0 * self.resolution
            }
            (None, None) => false,
        };
        let at = (0..self.len).find(unseen)?;
        (self.len < CAPACITY).then(|| 0.5 * (self.samples[at].0 + self.samples[at + 1].0))
    }

    /// Does it only rise from sample to sample, each with a value?
    pub(crate) fn only_rises(&self) -> bool {
        let chords = (1..self.len).map(|behind| self.chord(behind - 1));
        chords
            .into_iter()
            .all(|chord| chord.is_some_and(|chord| chord > 0.0))
    }

    /// The samples between which the function first rises from below zero to zero or above; `None` too where its first value is
    /// not below zero.
    pub(crate) fn first_rise(&self) -> Option<[(f64, f64); 2]> {
        let valued = self
            .samples()
            .iter()
            .position(|sample| sample.1.is_finite())?;
        let behind = valued
            + self.samples()[valued..]
                .iter()
                .position(|sample| sample.1 >= 0.0)?;
        (behind > valued).then(|| [self.samples[behind - 1], self.samples[behind]])
    }

    /// How often it passes zero.
    pub(crate) fn passes(&self) -> usize {
        let pairs = self.samples().windows(2);
        pairs
            .filter(|pair| (pair[0].1 < 0.0) != (pair[1].1 < 0.0))
            .count()
    }
}

#[cfg(test)]
mod tests;
