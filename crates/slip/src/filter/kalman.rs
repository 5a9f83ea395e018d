//! A Kalman filter of fixed size that takes one scalar at a time.

use alloc::{boxed::Box, vec};

use grouser_real::Real;

/// No variance falls below this: a filter that is certain learns nothing any more.
const FLOOR: f64 = 1e-14;

/// Means and covariance of `n` numbers. Nothing is allocated after construction.
#[derive(Clone, Debug)]
pub(crate) struct Kalman {
    n: usize,
    mean: Box<[f64]>,
    /// Row after row, symmetric.
    covariance: Box<[f64]>,
    /// P hᵀ of the measurement at hand.
    spread: Box<[f64]>,
    /// Which numbers are not estimated, though what is not known of them counts (Schmidt's filter).
    considered: Box<[bool]>,
}

/// One measurement, linear in a few of the numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScalarMeasurement<'a> {
    /// Which numbers, each with its coefficient.
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

    pub(crate) fn set_mean(&mut self, i: usize, value: f64) {
        self.mean[i] = value;
    }

    pub(crate) fn covariance(&self, i: usize, j: usize) -> f64 {
        self.covariance[i * self.n + j]
    }

    pub(crate) fn sigma(&self, i: usize) -> f64 {
        Real::sqrt(self.covariance(i, i))
    }

    /// Is number `i` to be estimated, or only its uncertainty to be counted with?
    pub(crate) fn set_considered(&mut self, i: usize, only_counted: bool) {
        self.considered[i] = only_counted;
    }

    /// Number `i` is known anew, apart from all others.
    pub(crate) fn reset(&mut self, i: usize, mean: f64, variance: f64) {
        for j in 0..self.n {
            self.covariance[i * self.n + j] = 0.0;
            self.covariance[j * self.n + i] = 0.0;
        }
        self.mean[i] = mean;
        self.covariance[i * self.n + i] = variance;
    }

    /// Adds to the variance of number `i`, at most up to `limit`.
    pub(crate) fn inflate(&mut self, i: usize, variance: f64, limit: f64) {
        let slot = &mut self.covariance[i * self.n + i];
        if *slot < limit {
            *slot = (*slot + variance).min(limit);
        }
    }

    /// Keeps the variance of number `i` from growing past `limit`.
    pub(crate) fn hold_variance(&mut self, i: usize, limit: f64) {
        let slot = &mut self.covariance[i * self.n + i];
        *slot = slot.min(limit);
    }

    /// Number `i` is drawn towards `rest`: x ← rest + a (x − rest).
    pub(crate) fn decay(&mut self, i: usize, rest: f64, a: f64) {
        self.mean[i] = rest + a * (self.mean[i] - rest);
        for j in 0..self.n {
            self.covariance[i * self.n + j] *= a;
            self.covariance[j * self.n + i] *= a;
        }
    }

    /// Number `i` takes `coefficient` times number `j` in addition: x_i ← x_i + coefficient x_j, the covariance alone; means that
    /// follow a curve are set by the caller.
    pub(crate) fn propagate(&mut self, i: usize, j: usize, coefficient: f64) {
        let n = self.n;
        for k in 0..n {
            self.covariance[i * n + k] += coefficient * self.covariance[j * n + k];
        }
        for k in 0..n {
            self.covariance[k * n + i] += coefficient * self.covariance[k * n + j];
        }
    }

    /// Variance of Σ coefficient x.
    pub(crate) fn variance_of(&self, jacobian: &[(usize, f64)]) -> f64 {
        let mut sum = 0.0;
        for &(i, a) in jacobian {
            for &(j, b) in jacobian {
                sum += a * b * self.covariance(i, j);
            }
        }
        sum.max(0.0)
    }

    /// Residual and its variance, before it enters.
    pub(crate) fn innovation(&self, seen: &ScalarMeasurement<'_>) -> (f64, f64) {
        (seen.residual, self.variance_of(seen.jacobian) + seen.variance)
    }

    /// Takes a measurement; gives its squared residual over its variance (NIS).
    pub(crate) fn update(&mut self, seen: &ScalarMeasurement<'_>) -> f64 {
        let n = self.n;
        self.spread.fill(0.0);
        for &(j, coefficient) in seen.jacobian {
            let column = &self.covariance[j * n..(j + 1) * n];
            for (slot, entry) in self.spread.iter_mut().zip(column) {
                *slot += coefficient * entry;
            }
        }
        let mut total = seen.variance;
        for &(j, coefficient) in seen.jacobian {
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
            self.mean[i] += gain * seen.residual;
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
            *slot = slot.max(FLOOR);
        }
        seen.residual * seen.residual * inverse
    }

    /// Keeps the covariance symmetric and correlations within ±1, whatever rounding did.
    pub(crate) fn tidy(&mut self) {
        for i in 0..self.n {
            self.spread[i] = Real::sqrt(0.999_999 * self.covariance(i, i).max(FLOOR));
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
