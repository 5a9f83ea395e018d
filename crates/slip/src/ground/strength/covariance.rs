//! Three numbers with their covariance, and one measurement of a line through them.

use grouser_real::Real;

/// A mean and a covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Belief {
    pub(crate) mean: [f64; 3],
    pub(crate) covariance: [[f64; 3]; 3],
}

impl Belief {
    /// Numbers that do not hang together.
    pub(crate) fn apart(mean: [f64; 3], sigma: [f64; 3]) -> Self {
        let mut covariance = [[0.0; 3]; 3];
        for (i, sigma) in sigma.iter().enumerate() {
            covariance[i][i] = sigma * sigma;
        }
        Self { mean, covariance }
    }

    /// Variance of the number that changes with `slopes`.
    pub(crate) fn variance_along(&self, slopes: &[f64; 3]) -> f64 {
        let spread = self.times(slopes);
        dot(slopes, &spread).max(0.0)
    }

    /// The Kalman gain of one measurement with `slopes` and the variance `noise`.
    pub(crate) fn gain(&self, slopes: &[f64; 3], noise: f64) -> [f64; 3] {
        let spread = self.times(slopes);
        let total = dot(slopes, &spread).max(0.0) + noise;
        spread.map(|part| part / total)
    }

    /// The belief after a measurement, its covariance by Joseph's form: positive for any gain.
    pub(crate) fn corrected(
        &self,
        mean: [f64; 3],
        slopes: &[f64; 3],
        gain: &[f64; 3],
        noise: f64,
    ) -> Self {
        let mut keep = [[0.0; 3]; 3];
        for (i, row) in keep.iter_mut().enumerate() {
            for (j, slot) in row.iter_mut().enumerate() {
                *slot = f64::from(u8::from(i == j)) - gain[i] * slopes[j];
            }
        }
        let half = product(&keep, &self.covariance);
        let mut covariance = product(&half, &transposed(&keep));
        for (i, row) in covariance.iter_mut().enumerate() {
            for (j, slot) in row.iter_mut().enumerate() {
                *slot += gain[i] * gain[j] * noise;
            }
        }
        let other = transposed(&covariance);
        for (row, other) in covariance.iter_mut().zip(other) {
            for (slot, mirrored) in row.iter_mut().zip(other) {
                *slot = 0.5 * (*slot + mirrored);
            }
        }
        Self { mean, covariance }
    }

    /// Fades towards `prior` over `steps` time constants.
    pub(crate) fn fade(&mut self, prior: &Self, steps: f64) {
        let kept = Real::exp(-steps.max(0.0));
        let gone = 1.0 - kept * kept;
        for (value, prior) in self.mean.iter_mut().zip(prior.mean) {
            *value = prior + kept * (*value - prior);
        }
        for (row, prior) in self.covariance.iter_mut().zip(prior.covariance) {
            for (slot, prior) in row.iter_mut().zip(prior) {
                *slot = kept * kept * *slot + gone * prior;
            }
        }
    }

    fn times(&self, slopes: &[f64; 3]) -> [f64; 3] {
        self.covariance.map(|row| dot(&row, slopes))
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn transposed(a: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let [[a, b, c], [d, e, f], [g, h, i]] = *a;
    [[a, d, g], [b, e, h], [c, f, i]]
}

fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let columns = transposed(b);
    a.map(|row| columns.map(|column| dot(&row, &column)))
}
