//! A Kalman filter of fixed size with sequential scalar updates.

use alloc::{boxed::Box, vec};

use grouser_real::Real;

/// Variances are floored so that the filter keeps adapting: far below any sensor's, in m², rad² and slip².
const VARIANCE_FLOOR: f64 = 1e-14;
/// The largest correlation of two numbers, squared; below 1 so that the covariance stays positive definite.
const MAX_SQUARED_CORRELATION: f64 = 0.999_999;

/// Means and covariance of `n` numbers. Nothing is allocated after construction.
#[derive(Clone, Debug)]
pub(crate) struct Kalman {
    n: usize,
    mean: Box<[f64]>,
    /// Row after row, each from the diagonal on: the matrix is symmetric, and a pair is stored once.
    covariance: Box<[f64]>,
    /// P hᵀ of the measurement at hand.
    spread: Box<[f64]>,
    /// Its gain, 0 for considered parameters.
    gain: Box<[f64]>,
    /// Considered parameters: not estimated, but their uncertainty counts (Schmidt's filter).
    considered: Box<[bool]>,
}

/// One measurement, linear in a few of the numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScalarMeasurement<'a> {
    /// The numbers that are measured, each with its coefficient.
    pub(crate) jacobian: &'a [(usize, f64)],
    /// Measured less predicted.
    pub(crate) residual: f64,
    /// Variance of the measurement.
    pub(crate) variance: f64,
}

impl Kalman {
    pub(crate) fn new(n: usize) -> Self {
        let zeros = |count: usize| vec![0.0; count].into_boxed_slice();
        Self {
            n,
            mean: zeros(n),
            covariance: zeros(n * (n + 1) / 2),
            spread: zeros(n),
            gain: zeros(n),
            considered: vec![false; n].into_boxed_slice(),
        }
    }

    /// Where the covariance of two numbers is stored.
    const fn place(&self, i: usize, j: usize) -> usize {
        let (low, high) = if i < j { (i, j) } else { (j, i) };
        low * (2 * self.n - low - 1) / 2 + high
    }

    pub(crate) fn mean(&self, i: usize) -> f64 {
        self.mean[i]
    }

    /// Σ coefficient x.
    pub(crate) fn mean_of(&self, row: &[(usize, f64)]) -> f64 {
        row.iter().map(|&(i, a)| a * self.mean[i]).sum()
    }

    /// Sets the covariance of two numbers.
    pub(crate) fn set_covariance(&mut self, i: usize, j: usize, value: f64) {
        self.covariance[self.place(i, j)] = value;
    }

    /// Keeps a mean within limits.
    pub(crate) fn clamp_mean(&mut self, i: usize, low: f64, high: f64) {
        self.mean[i] = self.mean[i].clamp(low, high);
    }

    pub(crate) fn set_mean(&mut self, i: usize, value: f64) {
        self.mean[i] = value;
    }

    pub(crate) fn covariance(&self, i: usize, j: usize) -> f64 {
        self.covariance[self.place(i, j)]
    }

    fn variance_mut(&mut self, i: usize) -> &mut f64 {
        &mut self.covariance[self.place(i, i)]
    }

    pub(crate) fn sigma(&self, i: usize) -> f64 {
        Real::sqrt(self.covariance(i, i))
    }

    /// Makes number `i` a considered parameter, or an estimated one.
    pub(crate) fn set_considered(&mut self, i: usize, considered: bool) {
        self.considered[i] = considered;
    }

    /// Sets number `i`, without correlation to the others.
    pub(crate) fn reset(&mut self, i: usize, mean: f64, variance: f64) {
        self.change_row(i, |slot| *slot = 0.0);
        self.mean[i] = mean;
        *self.variance_mut(i) = variance;
    }

    /// Adds to the variance of number `i`, up to `limit`.
    pub(crate) fn inflate(&mut self, i: usize, variance: f64, limit: f64) {
        let slot = self.variance_mut(i);
        if *slot < limit {
            *slot = (*slot + variance).min(limit);
        }
    }

    /// Raises the variance of number `i` to at least this.
    pub(crate) fn raise_variance(&mut self, i: usize, least: f64) {
        let slot = self.variance_mut(i);
        *slot = slot.max(least);
    }

    /// Keeps the variance of number `i` from growing past `limit`.
    pub(crate) fn limit_variance(&mut self, i: usize, limit: f64) {
        let slot = self.variance_mut(i);
        *slot = slot.min(limit);
    }

    /// Number `i` decays towards `rest`: x ← rest + a (x − rest).
    pub(crate) fn decay(&mut self, i: usize, rest: f64, a: f64) {
        self.mean[i] = rest + a * (self.mean[i] - rest);
        self.change_row(i, |slot| *slot *= a);
        *self.variance_mut(i) *= a;
    }

    /// Changes the covariances of number `i`, its variance among them.
    fn change_row(&mut self, i: usize, change: impl Fn(&mut f64)) {
        let mut place = i;
        for k in 0..i {
            change(&mut self.covariance[place]);
            place += self.n - 1 - k;
        }
        for slot in &mut self.covariance[place..place + self.n - i] {
            change(slot);
        }
    }

    /// Propagates the covariance by x_i ← x_i + coefficient x_j, i ≠ j; the caller sets the means.
    pub(crate) fn propagate(&mut self, i: usize, j: usize, coefficient: f64) {
        let before = self.covariance(i, j);
        let (low, high) = if i < j { (i, j) } else { (j, i) };
        // above both, the pairs lie in one row each
        let mut row = 0;
        for k in 0..low {
            self.covariance[row + i] += coefficient * self.covariance[row + j];
            row += self.n - 1 - k;
        }
        let lowest = row;
        for k in low..=high {
            let (of_low, of_high) = (lowest + k, row + high);
            if k != i {
                let (to, from) = if i < j {
                    (of_low, of_high)
                } else {
                    (of_high, of_low)
                };
                self.covariance[to] += coefficient * self.covariance[from];
            }
            row += self.n - 1 - k;
        }
        // beyond both, the two rows lie in one piece each
        let count = self.n - 1 - high;
        let (ends, starts) = (self.place(low, high) + 1, self.place(high, high) + 1);
        let (lows, highs) = self.covariance.split_at_mut(starts);
        let (lows, highs) = (&mut lows[ends..ends + count], &mut highs[..count]);
        if i < j {
            add_multiple(lows, coefficient, highs);
        } else {
            add_multiple(highs, coefficient, lows);
        }
        let after = self.covariance(i, j);
        *self.variance_mut(i) += coefficient * (before + after);
    }

    /// The variance of Σ coefficient x.
    pub(crate) fn variance_of(&self, jacobian: &[(usize, f64)]) -> f64 {
        let mut sum = 0.0;
        for &(i, a) in jacobian {
            for &(j, b) in jacobian {
                sum += a * b * self.covariance(i, j);
            }
        }
        sum.max(0.0)
    }

    /// The innovation of a measurement and its variance, before an update.
    pub(crate) fn innovation(&self, measured: &ScalarMeasurement<'_>) -> (f64, f64) {
        (
            measured.residual,
            self.variance_of(measured.jacobian) + measured.variance,
        )
    }

    /// P hᵀ.
    fn set_spread(&mut self, jacobian: &[(usize, f64)]) {
        self.spread.fill(0.0);
        for &(j, coefficient) in jacobian
            .iter()
            .filter(|(_, coefficient)| *coefficient != 0.0)
        {
            let (before, after) = self.spread.split_at_mut(j);
            let mut place = j;
            for (k, slot) in before.iter_mut().enumerate() {
                *slot += coefficient * self.covariance[place];
                place += self.n - 1 - k;
            }
            add_multiple(after, coefficient, &self.covariance[place..]);
        }
    }

    /// Updates the state by a measurement; returns its normalised innovation squared.
    pub(crate) fn update(&mut self, measured: &ScalarMeasurement<'_>) -> f64 {
        self.set_spread(measured.jacobian);
        let mut total = measured.variance;
        for &(j, coefficient) in measured.jacobian {
            total += coefficient * self.spread[j];
        }
        if !(total > 0.0) {
            return 0.0;
        }
        let inverse = 1.0 / total;
        let numbers = self.mean.iter_mut().zip(&self.considered).zip(&self.spread);
        for (gain, ((mean, considered), spread)) in self.gain.iter_mut().zip(numbers) {
            *gain = if *considered { 0.0 } else { spread * inverse };
            *mean += *gain * measured.residual;
        }
        let (mut rest, mut gain, mut spread) =
            (&mut self.covariance[..], &self.gain[..], &self.spread[..]);
        for considered in &self.considered {
            let (row, below) = rest.split_at_mut(gain.len());
            let (factor, entries) = if *considered {
                (spread[0], gain)
            } else {
                (gain[0], spread)
            };
            if factor != 0.0 {
                add_multiple(row, -factor, entries);
            }
            row[0] = row[0].max(VARIANCE_FLOOR);
            (rest, gain, spread) = (below, &gain[1..], &spread[1..]);
        }
        measured.residual * measured.residual * inverse
    }

    /// Keeps correlations within ±1 against rounding.
    pub(crate) fn limit_correlations(&mut self) {
        for i in 0..self.n {
            let variance = self.covariance(i, i).max(VARIANCE_FLOOR);
            self.spread[i] = Real::sqrt(MAX_SQUARED_CORRELATION * variance);
        }
        let mut rest = &mut self.covariance[..];
        for i in 0..self.n {
            let (row, below) = rest.split_at_mut(self.n - i);
            limit_row(&mut row[1..], self.spread[i], &self.spread[i + 1..]);
            rest = below;
        }
    }
}

/// Limits each entry to ± the product of the sigmas. Not inlined, as [`add_multiple`].
#[inline(never)]
fn limit_row(row: &mut [f64], sigma: f64, sigmas: &[f64]) {
    for (slot, other) in row.iter_mut().zip(sigmas) {
        let limit = sigma * other;
        let upper = if *slot > limit { limit } else { *slot };
        *slot = if upper < -limit { -limit } else { upper };
    }
}

/// `to += factor * from`, element by element, as long as `to` is. Not inlined: only of arguments does the compiler know that they
/// do not overlap, so that it makes lanes of the loop.
#[inline(never)]
fn add_multiple(to: &mut [f64], factor: f64, from: &[f64]) {
    for (slot, entry) in to.iter_mut().zip(from) {
        *slot += factor * entry;
    }
}

#[cfg(test)]
pub(super) mod tests;
