//! A Gaussian belief over the state, and its update by one scalar measurement.

use super::state::SIZE;

/// One coefficient for each number of the state.
pub type Row = [f64; SIZE];

/// No number of the state is known better, in the square of its unit.
const MIN_VARIANCE: f64 = 1e-18;

/// Mean and covariance of the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    /// The mean.
    pub mean: Row,
    /// The covariance, symmetric.
    pub covariance: [Row; SIZE],
}

/// What one scalar measurement did to a belief: the backward pass of the smoother needs no more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// The measurement's Jacobian.
    pub row: Row,
    /// Kalman gain.
    pub gain: Row,
    /// Measured less predicted.
    pub innovation: f64,
    /// Variance of the innovation.
    pub variance: f64,
}

impl Belief {
    /// A belief with independent numbers.
    #[must_use]
    pub fn independent(mean: Row, sigma: Row) -> Self {
        let mut covariance = [[0.0; SIZE]; SIZE];
        for (i, sigma) in sigma.iter().enumerate() {
            covariance[i][i] = sigma * sigma;
        }
        Self { mean, covariance }
    }

    /// The Gaussian with the moments of a mixture of beliefs with these weights.
    #[must_use]
    pub fn mixture<'a>(parts: impl Iterator<Item = (f64, &'a Self)> + Clone) -> Self {
        let mut out = Self {
            mean: [0.0; SIZE],
            covariance: [[0.0; SIZE]; SIZE],
        };
        for (weight, of) in parts.clone() {
            for (out, of) in out.mean.iter_mut().zip(&of.mean) {
                *out += weight * of;
            }
        }
        for (weight, of) in parts {
            let off: Row = core::array::from_fn(|i| of.mean[i] - out.mean[i]);
            for (i, row) in out.covariance.iter_mut().enumerate() {
                for (j, p) in row.iter_mut().enumerate() {
                    *p += weight * (of.covariance[i][j] + off[i] * off[j]);
                }
            }
        }
        out
    }

    /// P h.
    #[must_use]
    pub fn spread(&self, row: &Row) -> Row {
        let mut out = [0.0; SIZE];
        for (j, &h) in row.iter().enumerate() {
            if h != 0.0 {
                for (out, p) in out.iter_mut().zip(&self.covariance[j]) {
                    *out += h * p;
                }
            }
        }
        out
    }

    /// hᵀ P h.
    #[must_use]
    pub fn variance_of(&self, row: &Row) -> f64 {
        dot(row, &self.spread(row))
    }

    /// hᵀ x.
    #[must_use]
    pub fn mean_of(&self, row: &Row) -> f64 {
        dot(row, &self.mean)
    }

    /// The Kalman update by one scalar measurement: x += K ν, P −= K S Kᵀ.
    pub fn update(&mut self, row: &Row, innovation: f64, variance: f64) -> Correction {
        let spread = self.spread(row);
        let total = dot(row, &spread) + variance;
        let mut gain = spread;
        for gain in &mut gain {
            *gain /= total;
        }
        for i in 0..SIZE {
            self.mean[i] += gain[i] * innovation;
            if spread[i] != 0.0 {
                for (p, gain) in self.covariance[i].iter_mut().zip(&gain) {
                    *p -= spread[i] * gain;
                }
            }
        }
        Correction {
            row: *row,
            gain,
            innovation,
            variance: total,
        }
    }

    /// Adds process noise to one number.
    pub fn add_noise(&mut self, index: usize, variance: f64) {
        self.covariance[index][index] += variance;
    }

    /// P ← F P Fᵀ where F is the identity with `row` in place of row `index`.
    pub fn propagate(&mut self, index: usize, row: &Row) {
        let spread = self.spread(row);
        let variance = dot(row, &spread);
        for (j, &spread) in spread.iter().enumerate() {
            self.covariance[index][j] = spread;
            self.covariance[j][index] = spread;
        }
        self.covariance[index][index] = variance;
    }
}

impl Belief {
    /// Numbers whose variance rounding has taken away, after a measurement that was far better than what was known, count as known
    /// to the smallest variance and independent.
    pub fn floor_variances(&mut self) {
        for i in 0..SIZE {
            if self.covariance[i][i] < MIN_VARIANCE {
                self.covariance[i] = [0.0; SIZE];
                for row in &mut self.covariance {
                    row[i] = 0.0;
                }
                self.covariance[i][i] = MIN_VARIANCE;
            }
        }
    }
}

/// aᵀ b.
#[must_use]
pub fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
