//! Standard errors, correlation, and what the data do not determine.

use super::between_tests::quantile_between;
use super::eigen::symmetric;
use super::fit::Fit;
use super::loss::Loss;
use super::profile::Interval;
use super::student::student_quantile;

/// A direction of the scaled parameters along which the residuals change by less than this share of what
/// they change along the best one is not seen by the data.
const BLIND_SINGULAR_RATIO: f64 = 1e-8;

/// A number whose standard error exceeds this share of it is not called identified: its 95 % interval then spans a
/// factor of five.
const MAX_RELATIVE_ERROR: f64 = 1.0 / 3.0;

/// What the data say about one parameter.
///
/// ```
/// use grouser_identify::least_squares::Verdict;
///
/// assert_eq!(Verdict::NotIdentifiable.key(), "not-identifiable");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Verdict {
    /// The data determine it.
    Identified,
    /// It lies on a bound: the data would have it beyond.
    OnBound,
    /// It can be exchanged for others without a trace in the residuals, or has no effect at all.
    NotIdentifiable,
    /// It is seen, but its 95 % interval is as wide as its bounds or open, its standard error exceeds a third of it, or
    /// another number that was fitted with it lies on a bound other than 0.
    Loose,
}

impl Verdict {
    /// Itself, but loose where an identified number's standard error is too great a `share` of it.
    pub(crate) fn of_share(self, share: f64) -> Self {
        if self == Self::Identified && !(share <= MAX_RELATIVE_ERROR) {
            Self::Loose
        } else {
            self
        }
    }

    /// Its name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::OnBound => "on-bound",
            Self::NotIdentifiable => "not-identifiable",
            Self::Loose => "loose",
        }
    }
}

/// The uncertainty of a fit, linear about its answer.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Uncertainty {
    /// Residuals less parameters that were free.
    pub freedom: usize,
    /// Standard deviation of the residuals, in the standard deviations that they were divided by.
    pub residual_deviation: f64,
    /// Standard error of each parameter; NaN where it is not identifiable or held on a bound.
    pub standard_errors: Vec<f64>,
    /// Correlation of each pair; NaN where one of them has no standard error.
    pub correlation: Vec<Vec<f64>>,
    /// What the data say about each parameter.
    pub verdicts: Vec<Verdict>,
    /// Greatest over least singular value of the scaled Jacobian.
    pub condition: f64,
    /// (JᵀWJ)⁻¹ without what the data do not see; 0 on bounds.
    inverse: Vec<Vec<f64>>,
    /// How far all parameters move with one standard deviation of each independent mixture of those that lie on a bound.
    bound_mixtures: Vec<Vec<f64>>,
    /// Degrees of freedom of each parameter's standard error: fewer than `freedom` where few tests determine it.
    pub(super) freedoms: Vec<f64>,
}

impl Uncertainty {
    /// Of a fit that was found with `loss`.
    ///
    /// Covariance s² (JᵀWJ)⁻¹ with s² = Σ w r²/(m − n), on the parameters that lie on no bound. The matrix is
    /// scaled to unit diagonal and taken apart into eigenvectors; those whose eigenvalue is nothing beside the
    /// greatest belong to what the data do not determine, and every parameter with a share in them is named.
    ///
    /// A parameter on a bound is not known exactly: the errors of the others include how they move when it leaves the
    /// bound, by as much as the data let it and at most by the width of its bounds.
    #[must_use]
    pub fn from_fit(fit: &Fit, loss: Loss) -> Self {
        let n = fit.x.len();
        let free: Vec<usize> = (0..n).filter(|k| !fit.on_bound(*k)).collect();
        let weights: Vec<f64> = fit.residuals.iter().map(|r| loss.weight(*r)).collect();
        let product = |a: usize, b: usize| -> f64 {
            let rows = fit.jacobian.iter().zip(&weights);
            rows.map(|(row, w)| w * row[a] * row[b]).sum()
        };
        let norms: Vec<f64> = free.iter().map(|k| product(*k, *k).sqrt()).collect();
        let seen: Vec<usize> = (0..free.len()).filter(|i| norms[*i] > 0.0).collect();
        let scaled: Vec<Vec<f64>> = seen
            .iter()
            .map(|&i| {
                let row = seen.iter();
                row.map(|&j| product(free[i], free[j]) / (norms[i] * norms[j]))
                    .collect()
            })
            .collect();
        let modes = symmetric(scaled);
        let greatest = modes.iter().fold(0.0, |m: f64, (value, _)| m.max(*value));
        let least = modes.iter().fold(greatest, |m, (value, _)| m.min(*value));
        let freedom = fit.residuals.len() - free.len();
        let squares: f64 = fit
            .residuals
            .iter()
            .zip(&weights)
            .map(|(r, w)| w * r * r)
            .sum();
        let residual_deviation = if freedom > 0 {
            (squares / freedom as f64).sqrt()
        } else {
            f64::NAN
        };
        let mut out = Self {
            freedom,
            residual_deviation,
            standard_errors: vec![f64::NAN; n],
            correlation: vec![vec![f64::NAN; n]; n],
            verdicts: (0..n)
                .map(|k| {
                    if fit.on_bound(k) {
                        Verdict::OnBound
                    } else {
                        Verdict::NotIdentifiable
                    }
                })
                .collect(),
            condition: (greatest / least.max(0.0)).sqrt(),
            inverse: vec![vec![0.0; n]; n],
            bound_mixtures: Vec::new(),
            freedoms: vec![freedom as f64; n],
        };
        let blind = |value: f64| !(value > BLIND_SINGULAR_RATIO * BLIND_SINGULAR_RATIO * greatest);
        for (place, &i) in seen.iter().enumerate() {
            let lost = modes
                .iter()
                .any(|(value, vector)| blind(*value) && vector[place].abs() > 1e-3);
            if lost {
                continue;
            }
            let k = free[i];
            let variance: f64 = determined(&modes, &blind, place, place);
            out.standard_errors[k] = residual_deviation * variance.sqrt() / norms[i];
            out.verdicts[k] = Verdict::Identified;
            for (other, &j) in seen.iter().enumerate() {
                let shared = determined(&modes, &blind, place, other);
                out.inverse[k][free[j]] = shared / (norms[i] * norms[j]);
                let apart = (variance * determined(&modes, &blind, other, other)).sqrt();
                out.correlation[k][free[j]] = shared / apart;
            }
        }
        let on_bound = out.on_bound_mixtures(fit, &product);
        let changes: Vec<Vec<f64>> = on_bound
            .iter()
            .map(|mixture| {
                let of = |row: &Vec<f64>| row.iter().zip(mixture).map(|(a, b)| a * b).sum();
                fit.jacobian.iter().map(of).collect()
            })
            .collect();
        let answers = out.moved(fit, loss, &changes);
        out.add(&answers);
        out.bound_mixtures = on_bound;
        for (mixture, answer) in out.bound_mixtures.iter_mut().zip(&answers) {
            for (x, moved) in mixture.iter_mut().zip(answer) {
                *x += moved;
            }
        }
        out.find_loose(fit);
        // a bound of 0 is one of nature, any other is where a search was stopped
        let is_stopped = |k: usize| fit.on_bound(k) && fit.x[k] != 0.0 && product(k, k) > 0.0;
        if (0..n).any(is_stopped) {
            let verdicts = out.verdicts.iter_mut();
            for verdict in verdicts.filter(|verdict| **verdict == Verdict::Identified) {
                *verdict = Verdict::Loose;
            }
        }
        out
    }

    /// Independent mixtures of the parameters on bounds, each as far as one standard deviation of it, the free ones at 0.
    ///
    /// Their precision is the Schur complement S/s² of JᵀWJ, and 1/w² for bounds of width w, beyond which none can move.
    fn on_bound_mixtures(
        &self,
        fit: &Fit,
        product: &impl Fn(usize, usize) -> f64,
    ) -> Vec<Vec<f64>> {
        /// Where bounds are open on one side: multiples of the error that a number has with all others held.
        const MAX_ERROR_GROWTH: f64 = 1e6;
        let n = fit.x.len();
        let s = self.residual_deviation;
        if !(s > 0.0) {
            return Vec::new();
        }
        let held: Vec<usize> = (0..n)
            .filter(|k| fit.on_bound(*k) && product(*k, *k) > 0.0)
            .collect();
        let width = |k: usize| {
            let bound = &fit.bounds[k];
            (bound.upper - bound.lower).min(MAX_ERROR_GROWTH * s / product(k, k).sqrt())
        };
        let schur = |a: usize, b: usize| {
            let rows = self.inverse.iter().enumerate();
            let carried = rows.map(|(i, row)| {
                let right: f64 = (0..n).map(|j| row[j] * product(j, b)).sum();
                product(a, i) * right
            });
            product(a, b) - carried.sum::<f64>()
        };
        let precision = |&a: &usize| {
            let entry = |&b: &usize| {
                f64::from(u8::from(a == b)) + schur(a, b) * width(a) * width(b) / (s * s)
            };
            held.iter().map(entry).collect()
        };
        let mixture = |(value, vector): (f64, Vec<f64>)| {
            let mut mixture = vec![0.0; n];
            for (k, share) in held.iter().zip(vector) {
                // rounding may leave a complement below 0
                mixture[*k] = width(*k) * share / value.max(1.0).sqrt();
            }
            mixture
        };
        let modes = symmetric(held.iter().map(precision).collect());
        modes.into_iter().map(mixture).collect()
    }

    /// The half width of a confidence interval of parameter `index`: t times its standard error.
    #[must_use]
    pub fn half_width(&self, index: usize, confidence: f64) -> f64 {
        self.quantile(index, confidence) * self.standard_errors[index]
    }

    /// Half width of a confidence interval of parameter `index` over its standard error.
    pub(crate) fn quantile(&self, index: usize, confidence: f64) -> f64 {
        quantile_between(0.5 + 0.5 * confidence, self.freedoms[index])
    }

    /// The same where `redundancy` readings count as one.
    pub(crate) fn of_alike(mut self, fit: &Fit, redundancy: f64) -> Self {
        let mixtures = self.bound_mixtures.iter_mut().flatten();
        for error in self.standard_errors.iter_mut().chain(mixtures) {
            *error *= redundancy.sqrt();
        }
        self.find_loose(fit);
        self
    }

    /// Calls no number identified whose `intervals` reach further than a third of it allows, or are open on both sides.
    pub(crate) fn judge_intervals(&mut self, fit: &Fit, intervals: &[Interval]) {
        let quantile = student_quantile(0.975, self.freedom);
        for (k, interval) in intervals.iter().enumerate() {
            let reach = |end: Option<f64>| end.map_or(0.0, |end| (end - fit.x[k]).abs());
            let reach = reach(interval.low).max(reach(interval.high));
            let is_wide = reach > quantile * MAX_RELATIVE_ERROR * fit.x[k].abs();
            let is_open = interval.low.is_none() && interval.high.is_none();
            if self.verdicts[k] == Verdict::Identified
                && (is_open || (is_wide && !fit.is_offset(k)))
            {
                self.verdicts[k] = Verdict::Loose;
            }
        }
    }

    /// Independent mixtures of these parameters, each as far as one standard deviation of it: the columns of a root of their
    /// covariance. `None` where the data do not determine one of them.
    pub(crate) fn scatter(&self, parameters: &[usize]) -> Option<Vec<Vec<f64>>> {
        let on_bound = |k: usize| self.verdicts[k] == Verdict::OnBound;
        let together = |k: usize, j: usize| -> f64 {
            let mixtures = self.bound_mixtures.iter();
            mixtures.map(|mixture| mixture[k] * mixture[j]).sum()
        };
        let error = |k: usize| {
            if on_bound(k) {
                together(k, k).sqrt()
            } else {
                self.standard_errors[k]
            }
        };
        let moves = |k: &usize| !on_bound(*k) || error(*k) > 0.0;
        let free: Vec<usize> = parameters.iter().copied().filter(moves).collect();
        if free.iter().any(|k| !error(*k).is_finite()) {
            return None;
        }
        let alike = |k: usize, j: usize| {
            if on_bound(k) || on_bound(j) {
                together(k, j) / (error(k) * error(j))
            } else {
                self.correlation[k][j]
            }
        };
        let correlation = |k: usize| free.iter().map(move |j| alike(k, *j)).collect();
        let modes = symmetric(free.iter().map(|k| correlation(*k)).collect());
        let mixture = |(value, vector): (f64, Vec<f64>)| {
            let mut mixture = vec![0.0; self.standard_errors.len()];
            for (k, share) in free.iter().zip(vector) {
                mixture[*k] = error(*k) * share * value.max(0.0).sqrt();
            }
            mixture
        };
        Some(modes.into_iter().map(mixture).collect())
    }

    /// Adds to the errors what numbers contribute that the fit held for exact. Each of `changes` is how far all residuals
    /// change with one standard deviation of such a number, or of a mixture of them, independent of the others; `None`:
    /// nothing bounds them. Returns the standard deviation that is added for each parameter.
    ///
    /// With the residuals' change y the answer moves by −(JᵀWJ)⁻¹ JᵀW y.
    pub(crate) fn widen(
        &mut self,
        fit: &Fit,
        loss: Loss,
        changes: Option<&[Vec<f64>]>,
    ) -> Vec<f64> {
        let n = fit.x.len();
        let Some(changes) = changes else {
            for k in 0..n {
                self.standard_errors[k] = f64::NAN;
                self.correlation[k].fill(f64::NAN);
                if self.verdicts[k] == Verdict::Identified {
                    self.verdicts[k] = Verdict::Loose;
                }
            }
            return vec![f64::NAN; n];
        };
        let moved = self.moved(fit, loss, changes);
        self.add(&moved);
        self.find_loose(fit);
        let added = |k: usize| moved.iter().map(|x| x[k] * x[k]).sum::<f64>().sqrt();
        (0..n).map(added).collect()
    }

    /// How far the answer moves with each of the residuals' `changes`.
    fn moved(&self, fit: &Fit, loss: Loss, changes: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let n = fit.x.len();
        let weights: Vec<f64> = fit.residuals.iter().map(|r| loss.weight(*r)).collect();
        let moved = |change: &Vec<f64>| -> Vec<f64> {
            let pull = |k: usize| -> f64 {
                let rows = fit.jacobian.iter().zip(&weights).zip(change);
                rows.map(|((row, weight), y)| weight * row[k] * y).sum()
            };
            let pulls: Vec<f64> = (0..n).map(pull).collect();
            let rows = self.inverse.iter();
            rows.map(|row| -row.iter().zip(&pulls).map(|(a, b)| a * b).sum::<f64>())
                .collect()
        };
        changes.iter().map(moved).collect()
    }

    /// Adds independent movements of the answer to errors and correlations.
    pub(super) fn add(&mut self, moved: &[Vec<f64>]) {
        if moved.is_empty() {
            return;
        }
        let n = self.standard_errors.len();
        let added = |k: usize, j: usize| moved.iter().map(|x| x[k] * x[j]).sum::<f64>();
        let own = self.standard_errors.clone();
        let together =
            |k: usize, j: usize, correlation: f64| correlation * own[k] * own[j] + added(k, j);
        let variance = |k: usize| together(k, k, 1.0);
        for k in 0..n {
            for j in 0..n {
                let shared = together(k, j, self.correlation[k][j]);
                self.correlation[k][j] = shared / (variance(k) * variance(j)).sqrt();
            }
            self.standard_errors[k] = variance(k).sqrt();
        }
    }

    pub(super) fn find_loose(&mut self, fit: &Fit) {
        for k in 0..fit.x.len() {
            if self.verdicts[k] != Verdict::Identified {
                continue;
            }
            let width = 2.0 * self.half_width(k, 0.95);
            let bound = &fit.bounds[k];
            let range = bound.upper - bound.lower;
            let uncertain = self.standard_errors[k] > MAX_RELATIVE_ERROR * fit.x[k].abs();
            if width > range || (uncertain && !fit.is_offset(k)) {
                self.verdicts[k] = Verdict::Loose;
            }
        }
    }
}

/// An entry of the inverse, without what is not seen.
fn determined(modes: &[(f64, Vec<f64>)], blind: &impl Fn(f64) -> bool, i: usize, j: usize) -> f64 {
    modes
        .iter()
        .filter(|(value, _)| !blind(*value))
        .map(|(value, vector)| vector[i] * vector[j] / value)
        .sum()
}

#[cfg(test)]
mod tests;
