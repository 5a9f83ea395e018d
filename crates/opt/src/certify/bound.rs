//! A lower bound over a box from multipliers.
//!
//! For any multipliers λ, at least 0 where a row is an inequality, every point of the box that meets all rows has
//! γ Σ_objectives λ ≥ Σ λ_r row_r(x). The sum is bounded in two ways, and the better one counts:
//!
//! ```text
//! natural:      Σ λ_r [row_r](box)
//! mean value:   F(c) + Σ_d G_d (x_d − c_d),   F = Σ λ_r row_r,   G = Σ λ_r [∇row_r](box)
//! ```
//! where c is the point of the box that makes the second greatest if F is taken as constant (Baumann 1988, BIT 28).
//! A certificate may add a tangent, a point p and a curvature μ ≤ 0 at which a third bound is tried:
//!
//! ```text
//! second order: F(p) + Σ_d (F_d(p) (x_d − p_d) + ½ m_d (x_d − p_d)²),   m_d = μ / (half the side d)²
//! ```
//! which holds where every matrix in [∇²F](box) − diag(m) is positive semidefinite. With the multipliers of an optimum
//! and p there, the first derivatives vanish, and the bound is as near to the optimum as rounding allows. If no objective has a multiplier and the sum is positive, the box holds no feasible point.

use grouser_real::Interval;

use super::rows::Rows;
use super::trim::Form;
use crate::sqp::LinearKind;
use crate::tape::{Curvatures, Enclosures};

/// Rows with their multipliers.
pub(super) type Multipliers = Vec<(usize, f64)>;

/// Where and with which curvature a bound of second order is taken.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tangent {
    pub(super) at: Vec<f64>,
    /// At most 0; by the square of half of each side.
    pub(super) curvature: f64,
}

/// What proves a bound.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Weights {
    pub(super) rows: Multipliers,
    pub(super) tangent: Option<Tangent>,
    /// Do the numbers mean rows without divisors?
    pub(super) is_cleared: bool,
}

impl From<Multipliers> for Weights {
    fn from(rows: Multipliers) -> Self {
        Self {
            rows,
            tangent: None,
            is_cleared: false,
        }
    }
}

/// Memory for bounds, one per thread.
#[derive(Default)]
pub(super) struct Bounder {
    over: Enclosures,
    curvatures: Curvatures,
}

/// What the rows of a certificate are over a box.
struct Sum {
    natural: Interval,
    gradient: Option<Vec<Interval>>,
}

/// The lower bound of γ that the lower end of Σ λ row gives.
fn level(rows: &Rows, weights: &[(usize, f64)], low: f64) -> f64 {
    let share = weights
        .iter()
        .filter(|(row, _)| rows.list[*row].kind == LinearKind::Objective)
        .fold(Interval::ZERO, |sum, (_, w)| sum + Interval::point(*w));
    if share.high() > 0.0 {
        let level = (Interval::point(low) / share).low();
        if level.is_nan() {
            f64::NEG_INFINITY
        } else {
            level
        }
    } else if rows.is_cleared {
        low
    } else if low > 0.0 {
        f64::INFINITY
    } else {
        f64::NEG_INFINITY
    }
}

/// The curvature along one side.
fn curvature_of(side: Interval, curvature: f64) -> f64 {
    let radius = 0.5 * (side.high() - side.low());
    curvature / (radius * radius)
}

/// Is every symmetric matrix in `hessian` − diag(m) positive definite, along the sides that have a length?
///
/// The middle of the enclosure, less what Gershgorin's circles in units of the sides allow for its width, is factored
/// in interval arithmetic.
pub(super) fn exceeds_curvature(hessian: &[Interval], x: &[Interval], curvature: f64) -> bool {
    let free: Vec<usize> = (0..x.len()).filter(|d| x[*d].width() > 0.0).collect();
    let n = free.len();
    let entry = |i: usize, j: usize| {
        let (i, j) = (free[i.max(j)], free[i.min(j)]);
        hessian[i * (i + 1) / 2 + j]
    };
    let half = |i: usize| 0.5 * (x[free[i]].high() - x[free[i]].low());
    let mut rest = vec![Interval::ZERO; n * n];
    for i in 0..n {
        let shift = curvature_of(x[free[i]], curvature);
        if !shift.is_finite() {
            return false;
        }
        let mut spread = Interval::ZERO;
        for j in 0..n {
            let h = entry(i, j);
            let middle = Interval::point(h.middle());
            rest[i * n + j] = middle;
            let share = Interval::point(half(j)) / Interval::point(half(i));
            spread += Interval::point((h - middle).magnitude()) * share;
        }
        rest[i * n + i] -= Interval::point(shift) + spread;
    }
    for k in 0..n {
        let pivot = rest[k * n + k];
        if !(pivot.low() > 0.0 && pivot.is_bounded()) {
            return false;
        }
        for i in k + 1..n {
            let share = rest[i * n + k] / pivot;
            for j in k + 1..=i {
                let less = share * rest[j * n + k];
                rest[i * n + j] -= less;
            }
        }
    }
    true
}

/// The point from which the mean value form has the greatest lower end.
pub(super) fn centre(x: Interval, slope: Interval) -> f64 {
    let (low, high) = (slope.low(), slope.high());
    if low >= 0.0 || high.is_infinite() {
        x.low()
    } else if high <= 0.0 || low.is_infinite() {
        x.high()
    } else {
        let c = (x.low() * high - x.high() * low) / (high - low);
        if c.is_finite() {
            c.clamp(x.low(), x.high())
        } else {
            x.middle()
        }
    }
}

impl Bounder {
    /// Σ λ row over a box, and its gradient where it is defined and continuous there.
    fn sum(&mut self, rows: &Rows, weights: &[(usize, f64)], x: &[Interval]) -> Sum {
        let terms = rows.terms(weights);
        let nodes = rows.needed_by(weights);
        self.over.forward(&rows.tape, x, &nodes);
        let natural = self.over.sum(&rows.tape, &nodes, &terms);
        let mut gradient = vec![Interval::ZERO; x.len()];
        let regular = self
            .over
            .gradient(&rows.tape, &nodes, &terms, &mut gradient);
        Sum {
            natural,
            gradient: regular.then_some(gradient),
        }
    }

    /// Σ λ row at one point; empty where a row has no value.
    fn at(&mut self, rows: &Rows, weights: &[(usize, f64)], c: &[f64]) -> Interval {
        let point: Vec<Interval> = c.iter().map(|c| Interval::point(*c)).collect();
        let nodes = rows.needed_by(weights);
        self.over.forward(&rows.tape, &point, &nodes);
        self.over.sum(&rows.tape, &nodes, &rows.terms(weights))
    }

    /// The linear form of multipliers about the middle of a box, against a finite target; `None` where it has no bounded
    /// slopes.
    pub(super) fn form(
        &mut self,
        rows: &Rows,
        weights: &Weights,
        x: &[Interval],
        target: f64,
    ) -> Option<Form> {
        let slopes = self.sum(rows, &weights.rows, x).gradient?;
        let middle: Vec<f64> = x.iter().map(|x| x.middle()).collect();
        let offset = self.at(rows, &weights.rows, &middle).low();
        let objectives = weights
            .rows
            .iter()
            .filter(|(row, _)| rows.list[*row].kind == LinearKind::Objective);
        let share: f64 = objectives.map(|(_, weight)| weight).sum();
        slopes.iter().all(|s| s.is_bounded()).then(|| Form {
            weights: weights.clone(),
            offset,
            slopes,
            limit: share * target,
        })
    }

    /// The lower bound of γ over a box; ∞ where the box holds no feasible point.
    pub(super) fn bound(&mut self, rows: &Rows, weights: &Weights, x: &[Interval]) -> f64 {
        let first = self.first_order(rows, &weights.rows, x);
        let Some(tangent) = &weights.tangent else {
            return first;
        };
        let hessian = self.hessian(rows, &weights.rows, x);
        let second = hessian.map_or(f64::NEG_INFINITY, |hessian| {
            self.second_order(rows, &weights.rows, x, &hessian, tangent)
        });
        first.max(second)
    }

    /// The lower triangle of the Hessian of Σ λ row over a box; `None` where it may not exist.
    pub(super) fn hessian(
        &mut self,
        rows: &Rows,
        weights: &[(usize, f64)],
        x: &[Interval],
    ) -> Option<Vec<Interval>> {
        let nodes = rows.needed_by(weights);
        self.over.forward(&rows.tape, x, &nodes);
        self.curvatures
            .forward(&rows.tape, x.len(), &self.over.values, &nodes);
        let mut sum = vec![Interval::ZERO; x.len() * (x.len() + 1) / 2];
        let exists = weights.iter().all(|&(row, weight)| {
            self.curvatures
                .add_to(rows.list[row].node, Interval::point(weight), &mut sum)
        });
        (exists && sum.iter().all(|h| h.is_bounded())).then_some(sum)
    }

    /// The bound of γ from a tangent, given the Hessian over the box; −∞ where the curvature is not proved.
    pub(super) fn second_order(
        &mut self,
        rows: &Rows,
        weights: &[(usize, f64)],
        x: &[Interval],
        hessian: &[Interval],
        tangent: &Tangent,
    ) -> f64 {
        if !exceeds_curvature(hessian, x, tangent.curvature) {
            return f64::NEG_INFINITY;
        }
        // the tangent of a greater box may lie outside
        let inside = x.iter().zip(&tangent.at);
        let p: Vec<Interval> = inside
            .map(|(x, p)| Interval::point(p.clamp(x.low(), x.high())))
            .collect();
        let sum = self.sum(rows, weights, &p);
        let Some(gradient) = sum.gradient else {
            return f64::NEG_INFINITY;
        };
        let mut form = sum.natural;
        for ((x, p), g) in x.iter().zip(&p).zip(&gradient) {
            // along a side without a length, whose curvature is infinite, the step is 0
            let step = *x - *p;
            let half_curvature = Interval::point(0.5 * curvature_of(*x, tangent.curvature));
            form += *g * step + half_curvature * step.square();
        }
        let low = form.low();
        level(
            rows,
            weights,
            if low.is_nan() { f64::NEG_INFINITY } else { low },
        )
    }

    fn first_order(&mut self, rows: &Rows, weights: &[(usize, f64)], x: &[Interval]) -> f64 {
        let sum = self.sum(rows, weights, x);
        if sum.natural.is_empty() {
            // a row has a value nowhere in the box
            return f64::INFINITY;
        }
        let mut low = sum.natural.low();
        if let Some(gradient) = sum.gradient {
            let c: Vec<f64> = x
                .iter()
                .zip(&gradient)
                .map(|(x, g)| centre(*x, *g))
                .collect();
            let form = x.iter().zip(&gradient).zip(&c).fold(
                self.at(rows, weights, &c),
                |sum, ((x, g), c)| {
                    // an unbounded slope times 0 is 0 only where the box is one point
                    sum + *g * (*x - Interval::point(*c))
                },
            );
            low = low.max(form.low());
        }
        level(rows, weights, low)
    }
}

#[cfg(test)]
#[path = "bound_tests.rs"]
pub(super) mod tests;
