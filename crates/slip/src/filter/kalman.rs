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
    /// Row after row, symmetric.
    covariance: Box<[f64]>,
    /// P hᵀ of the measurement at hand.
    spread: Box<[f64]>,
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
        Self {
            n,
            mean: vec![0.0; n].into_boxed_slice(),
            covariance: vec![0.0; n * n].into_boxed_slice(),
            spread: vec![0.0; n].into_boxed_slice(),
            considered: vec![false; n].into_boxed_slice(),
        }
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
        self.covariance[i * self.n + j] = value;
        self.covariance[j * self.n + i] = value;
    }

    /// Keeps a mean within limits.
    pub(crate) fn clamp_mean(&mut self, i: usize, low: f64, high: f64) {
        self.mean[i] = self.mean[i].clamp(low, high);
    }

    pub(crate) fn set_mean(&mut self, i: usize, value: f64) {
        self.mean[i] = value;
    }

    pub(crate) fn covariance(&self, i: usize, j: usize) -> f64 {
        self.covariance[i * self.n + j]
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
        for j in 0..self.n {
            self.covariance[i * self.n + j] = 0.0;
            self.covariance[j * self.n + i] = 0.0;
        }
        self.mean[i] = mean;
        self.covariance[i * self.n + i] = variance;
    }

    /// Adds to the variance of number `i`, up to `limit`.
    pub(crate) fn inflate(&mut self, i: usize, variance: f64, limit: f64) {
        let slot = &mut self.covariance[i * self.n + i];
        if *slot < limit {
            *slot = (*slot + variance).min(limit);
        }
    }

    /// Keeps the variance of number `i` from growing past `limit`.
    pub(crate) fn limit_variance(&mut self, i: usize, limit: f64) {
        let slot = &mut self.covariance[i * self.n + i];
        *slot = slot.min(limit);
    }

    /// Number `i` decays towards `rest`: x ← rest + a (x − rest).
    pub(crate) fn decay(&mut self, i: usize, rest: f64, a: f64) {
        self.mean[i] = rest + a * (self.mean[i] - rest);
        for j in 0..self.n {
            self.covariance[i * self.n + j] *= a;
            self.covariance[j * self.n + i] *= a;
        }
    }

    /// Propagates the covariance by x_i ← x_i + coefficient x_j; the caller sets the means.
    pub(crate) fn propagate(&mut self, i: usize, j: usize, coefficient: f64) {
        let n = self.n;
        for k in 0..n {
            self.covariance[i * n + k] += coefficient * self.covariance[j * n + k];
        }
        for k in 0..n {
            self.covariance[k * n + i] += coefficient * self.covariance[k * n + j];
        }
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

    /// Updates the state by a measurement; returns its normalised innovation squared.
    pub(crate) fn update(&mut self, measured: &ScalarMeasurement<'_>) -> f64 {
        let n = self.n;
        self.spread.fill(0.0);
        for &(j, coefficient) in measured.jacobian {
            let column = &self.covariance[j * n..(j + 1) * n];
            for (slot, entry) in self.spread.iter_mut().zip(column) {
                *slot += coefficient * entry;
            }
        }
        let mut total = measured.variance;
        for &(j, coefficient) in measured.jacobian {
            total += coefficient * self.spread[j];
        }
        if !(total > 0.0) {
            return 0.0;
        }
        let inverse = 1.0 / total;
        for i in 0..n {
            let gain = self.spread[i] * inverse;
            if gain == 0.0 || self.considered[i] {
                continue;
            }
            self.mean[i] += gain * measured.residual;
            let row = &mut self.covariance[i * n..(i + 1) * n];
            for (slot, spread) in row.iter_mut().zip(&self.spread) {
                *slot -= gain * spread;
            }
        }
        for i in (0..n).filter(|&i| self.considered[i]) {
            for j in (0..n).filter(|&j| !self.considered[j]) {
                self.covariance[i * n + j] = self.covariance[j * n + i];
            }
        }
        for i in 0..n {
            let slot = &mut self.covariance[i * n + i];
            *slot = slot.max(VARIANCE_FLOOR);
        }
        measured.residual * measured.residual * inverse
    }

    /// Keeps the covariance symmetric and correlations within ±1 against rounding.
    pub(crate) fn symmetrise(&mut self) {
        for i in 0..self.n {
            self.spread[i] =
                Real::sqrt(MAX_SQUARED_CORRELATION * self.covariance(i, i).max(VARIANCE_FLOOR));
        }
        for i in 0..self.n {
            for j in 0..i {
                let limit = self.spread[i] * self.spread[j];
                let (a, b) = (self.covariance(i, j), self.covariance(j, i));
                let mean = (0.5 * (a + b)).clamp(-limit, limit);
                self.covariance[i * self.n + j] = mean;
                self.covariance[j * self.n + i] = mean;
            }
        }
    }
}
