//! How tests of the same soil differ, as a part of the errors.

use grouser_real::Real;

use super::Uncertainty;
use super::eigen::symmetric;
use super::fit::Fit;
use super::loss::Loss;
use super::student::student_quantile;

/// Without one test, a direction of the scaled parameters whose eigenvalue is below this share of the greatest is one that
/// the other tests do not determine: rounding leaves 1e-16, and two plates of widths that differ by 1e-5 leave 1e-10.
const MIN_EIGENVALUE_SHARE: f64 = 1e-12;
/// A unit vector's component that is more than rounding.
const MIN_COMPONENT: f64 = 1e-3;

/// More tests than these are taken together, neighbour with neighbour: the work grows with their square, and they have all
/// degrees of freedom that matter.
const MAX_TESTS: usize = 200;

type Matrix = Vec<Vec<f64>>;

/// The inverse without directions that `matrix` does not determine, and these directions.
fn pseudo_inverse(matrix: Matrix) -> (Matrix, Matrix) {
    let n = matrix.len();
    let modes = symmetric(matrix);
    let greatest = modes.iter().fold(0.0, |m: f64, (value, _)| m.max(*value));
    let (seen, blind): (Vec<_>, Vec<_>) = modes
        .into_iter()
        .partition(|(value, _)| *value > MIN_EIGENVALUE_SHARE * greatest);
    let entry = |i: usize, j: usize| seen.iter().map(|(value, v)| v[i] * v[j] / value).sum();
    let inverse = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect());
    (
        inverse.collect(),
        blind.into_iter().map(|(_, v)| v).collect(),
    )
}

fn times(matrix: &[Vec<f64>], vector: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| dot(row, vector)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What the fits without one test each show.
struct LeaveOneOut {
    /// The answer's movements, whose squares sum to the jackknife's variance.
    moved: Matrix,
    /// Degrees of freedom of each parameter's variance.
    freedoms: Vec<f64>,
    /// Parameters that the tests do not determine any more without one of them.
    lost: Vec<usize>,
}

impl LeaveOneOut {
    /// Without test i the answer moves by −(A − A_i)⁻¹ J_iᵀ W r_i with A = JᵀWJ, linear about the fit; the degrees of freedom
    /// are Satterthwaite's for residuals that are independent and alike.
    ///
    /// Source: Bell & McCaffrey, Survey Methodology 28 (2002), the jackknife and its degrees of freedom.
    fn from_fit(fit: &Fit, loss: Loss, lengths: &[usize]) -> Self {
        let n = fit.x.len();
        let weights: Vec<f64> = fit.residuals.iter().map(|r| loss.weight(*r)).collect();
        let norm = |k: &usize| {
            let rows = fit.jacobian.iter().zip(&weights);
            Real::sqrt(rows.map(|(row, w)| w * row[*k] * row[*k]).sum::<f64>())
        };
        let free: Vec<usize> = (0..n)
            .filter(|k| !fit.on_bound(*k) && norm(k) > 0.0)
            .collect();
        let norms: Vec<f64> = free.iter().map(norm).collect();
        let p = free.len();
        let count = lengths.len();
        let mut own = vec![vec![vec![0.0; p]; p]; count];
        let mut pulls = vec![vec![0.0; p]; count];
        let mut readings = fit.jacobian.iter().zip(&weights).zip(&fit.residuals);
        for ((own, pull), length) in own.iter_mut().zip(&mut pulls).zip(lengths) {
            for ((row, weight), residual) in readings.by_ref().take(*length) {
                let scaled: Vec<f64> = free
                    .iter()
                    .zip(&norms)
                    .map(|(k, norm)| row[*k] / norm)
                    .collect();
                for ((sums, sum), x) in own.iter_mut().zip(pull.iter_mut()).zip(&scaled) {
                    *sum += weight * x * residual;
                    sums.iter_mut()
                        .zip(&scaled)
                        .for_each(|(sum, y)| *sum += weight * x * y);
                }
            }
        }
        let without = |left_out: Option<usize>| -> Matrix {
            let others = own.iter().enumerate();
            let others = others.filter(|(index, _)| Some(*index) != left_out);
            let mut sum = vec![vec![0.0; p]; p];
            for (_, matrix) in others {
                for (row, added) in sum.iter_mut().zip(matrix) {
                    row.iter_mut().zip(added).for_each(|(a, b)| *a += b);
                }
            }
            sum
        };
        let (whole, _) = pseudo_inverse(without(None));
        let parts: Vec<(Matrix, Matrix)> = (0..count)
            .map(|index| pseudo_inverse(without(Some(index))))
            .collect();
        let share = (count as f64 - 1.0) / count as f64;
        let movement = |(inverse, _): &(Matrix, Matrix), pull: &Vec<f64>| {
            let mut moved = vec![0.0; n];
            for ((place, norm), x) in free.iter().zip(&norms).zip(times(inverse, pull)) {
                moved[*place] = -share.sqrt() * x / norm;
            }
            moved
        };
        let moved = parts
            .iter()
            .zip(&pulls)
            .map(|(part, pull)| movement(part, pull));
        let is_lost = |i: &usize| {
            let mut blind = parts.iter().flat_map(|(_, blind)| blind);
            blind.any(|vector| vector[*i].abs() > MIN_COMPONENT)
        };
        let freedom = |i: usize| {
            let slopes: Vec<Vec<f64>> = parts
                .iter()
                .map(|(inverse, _)| inverse[i].clone())
                .collect();
            let carried: Vec<Vec<f64>> =
                own.iter().zip(&slopes).map(|(a, v)| times(a, v)).collect();
            let moved: Vec<Vec<f64>> = carried.iter().map(|v| times(&whole, v)).collect();
            let entry = |a: usize, b: usize| {
                let alone = if a == b {
                    dot(&slopes[a], &carried[a])
                } else {
                    0.0
                };
                alone - dot(&carried[a], &moved[b])
            };
            let trace: f64 = (0..count).map(|a| entry(a, a)).sum();
            let squares: f64 = (0..count)
                .flat_map(|a| (0..count).map(move |b| (a, b)))
                .map(|(a, b)| entry(a, b) * entry(a, b))
                .sum();
            (trace * trace / squares).max(1.0)
        };
        let mut freedoms = vec![1.0; n];
        for (i, k) in free.iter().enumerate() {
            freedoms[*k] = freedom(i);
        }
        Self {
            moved: moved.collect(),
            freedoms,
            lost: (0..p).filter(is_lost).map(|i| free[i]).collect(),
        }
    }
}

impl Uncertainty {
    /// Adds how tests differ beyond what their residuals explain, test after test of these `lengths`: the covariance becomes
    /// the wider one, in each direction, of the own one and the jackknife's over tests. Returns the parameters whose errors
    /// do not contain it, since only one test determines them.
    pub(crate) fn add_tests(&mut self, fit: &Fit, loss: Loss, lengths: &[usize]) -> Vec<usize> {
        let n = fit.x.len();
        let known: Vec<usize> = (0..n)
            .filter(|k| !fit.on_bound(*k) && self.standard_errors[*k] > 0.0)
            .collect();
        if lengths.len() < 2 {
            return known;
        }
        let together = lengths.chunks(lengths.len().div_ceil(MAX_TESTS));
        let lengths: Vec<usize> = together.map(|lengths| lengths.iter().sum()).collect();
        let without = LeaveOneOut::from_fit(fit, loss, &lengths);
        let own = self.standard_errors.clone();
        let correlation = |i: &usize| known.iter().map(|j| self.correlation[*i][*j]).collect();
        let modes = symmetric(known.iter().map(correlation).collect());
        let greatest = modes.iter().fold(0.0, |m: f64, (value, _)| m.max(*value));
        // columns of a root of the covariance, in own errors
        let roots: Matrix = modes
            .into_iter()
            .filter(|(value, _)| *value > MIN_EIGENVALUE_SHARE * greatest)
            .map(|(value, v)| v.iter().map(|x| x * value.sqrt()).collect())
            .collect();
        let whitened = |moved: &Vec<f64>| -> Vec<f64> {
            let scaled: Vec<f64> = known.iter().map(|k| moved[*k] / own[*k]).collect();
            let along = roots
                .iter()
                .map(|root| dot(root, &scaled) / dot(root, root));
            along.collect()
        };
        let whitened: Matrix = without.moved.iter().map(whitened).collect();
        let entry = |i: usize, j: usize| whitened.iter().map(|w| w[i] * w[j]).sum();
        let m = roots.len();
        let ratios = symmetric(
            (0..m)
                .map(|i| (0..m).map(|j| entry(i, j)).collect())
                .collect(),
        );
        let added = |(ratio, vector): &(f64, Vec<f64>)| {
            let mut moved = vec![0.0; n];
            for (place, k) in known.iter().enumerate() {
                let along = roots
                    .iter()
                    .zip(vector)
                    .map(|(root, share)| root[place] * share);
                moved[*k] = own[*k] * (ratio - 1.0).sqrt() * along.sum::<f64>();
            }
            moved
        };
        let wider: Matrix = ratios
            .iter()
            .filter(|(ratio, _)| *ratio > 1.0)
            .map(added)
            .collect();
        self.add(&wider);
        for k in known {
            // Welch-Satterthwaite
            let (own, all) = (
                own[k] * own[k],
                self.standard_errors[k] * self.standard_errors[k],
            );
            let (residual, tests) = (own / all, 1.0 - own / all);
            let spread =
                residual * residual / self.freedoms[k] + tests * tests / without.freedoms[k];
            self.freedoms[k] = (1.0 / spread).min(self.freedoms[k]);
        }
        self.find_loose(fit);
        without.lost
    }

    /// By how much the 95 % interval of parameter `index` is wider than that of `before`.
    pub(crate) fn widening(&self, before: &Self, index: usize) -> f64 {
        let ratio = self.half_width(index, 0.95) / before.half_width(index, 0.95);
        if ratio.is_finite() { ratio } else { 1.0 }
    }
}

/// [`student_quantile`] of degrees of freedom that are no whole number, between its neighbours linear in 1/ν: within 4 %.
pub(super) fn quantile_between(p: f64, freedom: f64) -> f64 {
    let (below, above) = (freedom.floor(), freedom.ceil());
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole, and at most the number of readings"
    )]
    let of = |freedom: f64| student_quantile(p, freedom as usize);
    if !(above > below && below >= 1.0) {
        return of(freedom);
    }
    let share = (1.0 / freedom - 1.0 / above) / (1.0 / below - 1.0 / above);
    share * of(below) + (1.0 - share) * of(above)
}
