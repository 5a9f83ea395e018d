//! The Cholesky factor of the curvature matrix: B = L Lᵀ.

/// A lower triangular matrix, row-major.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    n: usize,
    l: Vec<f64>,
}

impl Factor {
    /// Factors a symmetric matrix; `None` if it is not positive definite to rounding.
    pub(crate) fn new(b: &[f64], n: usize) -> Option<Self> {
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let mut sum = b[i * n + j];
                for k in 0..j {
                    sum -= l[i * n + k] * l[j * n + k];
                }
                if i == j {
                    if !(sum > f64::EPSILON * 4.0 * b[i * n + i]) || !sum.is_finite() {
                        return None;
                    }
                    l[i * n + i] = sum.sqrt();
                } else {
                    l[i * n + j] = sum / l[j * n + j];
                }
            }
        }
        Some(Self { n, l })
    }

    /// L⁻¹ v.
    pub(crate) fn forward(&self, v: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut y = v.to_vec();
        for i in 0..n {
            let row = &self.l[i * n..=i * n + i];
            let mut sum = y[i];
            for k in 0..i {
                sum -= row[k] * y[k];
            }
            y[i] = sum / row[i];
        }
        y
    }

    /// L⁻ᵀ v.
    pub(crate) fn backward(&self, v: &[f64]) -> Vec<f64> {
        let n = self.n;
        let mut y = v.to_vec();
        for i in (0..n).rev() {
            y[i] /= self.l[i * n + i];
            let value = y[i];
            for (y, l) in y.iter_mut().zip(&self.l[i * n..i * n + i]) {
                *y -= l * value;
            }
        }
        y
    }
}
