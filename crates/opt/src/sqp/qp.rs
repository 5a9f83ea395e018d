//! The quadratic subproblem in (d, γ), solved on its dual by a dense active-set method.
//!
//! ```text
//! minimise  γ + ½ dᵀB d + Σ_j cap_j · (how far row j is above 0)
//! such that g_j·d + b_j ≤ γ   for objective rows
//! ```
//! where a row with an infinite cap must hold. With B = L Lᵀ, y = Lᵀd and a_j = L⁻¹g_j its dual is
//! ```text
//! maximise  −½ ‖Σ u_j a_j‖² + Σ u_j b_j   such that   Σ_objectives u_j = 1,   low_j ≤ u_j ≤ cap_j
//! ```
//! The bounds of u do not depend on the point, so the multipliers of one iteration are a feasible start
//! for the next: near the solution a subproblem costs one small triangular solve. The curvature is
//! in d alone (γ has none); the sum rule keeps one objective row, the `base`, in every working set,
//! and differences against it remove γ exactly instead of by a small artificial curvature.

use super::factor::Factor;
use super::pieces::Blend;
use super::subspace::{Member, Outcome, Subspace};

/// What a row does in the subproblem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RowKind {
    /// g·d + b ≤ γ.
    Objective,
    /// g·d + b ≤ 0, at `cap` a unit of violation.
    Inequality { cap: f64 },
    /// g·d + b = 0, at `cap` a unit of violation.
    Equality { cap: f64 },
    /// Not there.
    Ignored,
}

impl RowKind {
    pub(super) fn range(self) -> (f64, f64) {
        match self {
            Self::Objective => (0.0, f64::INFINITY),
            Self::Inequality { cap } => (0.0, cap),
            Self::Equality { cap } => (-cap, cap),
            Self::Ignored => (0.0, 0.0),
        }
    }
}

/// The linearised functions.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    pub(super) kinds: Vec<RowKind>,
    /// Row-major, one gradient per row.
    pub(super) gradients: Vec<f64>,
    pub(super) offsets: Vec<f64>,
    /// Values of the parts that the functions are combinations of, at the point of the offsets.
    pub(super) parts: Vec<f64>,
}

/// One subproblem. After the rows come two simple bounds per variable: lower, upper.
pub(super) struct Qp<'a> {
    pub(super) factor: &'a Factor,
    pub(super) rows: &'a Rows,
    /// Bounds of the step.
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
}

/// A solved subproblem.
#[derive(Clone, Debug)]
pub(super) struct QpSolution {
    pub(super) step: Vec<f64>,
    /// One per row, then (lower, upper) per variable.
    pub(super) multipliers: Vec<f64>,
    /// Do all rows hold, and every multiplier its sign?
    pub(super) exact: bool,
    /// Did the callback stop the search?
    pub(super) stopped: bool,
    /// The rows that functions of parts have in it.
    pub(super) blends: Vec<Blend>,
}

/// The callback is called after about this many products, a tenth of a second: of thousands of rows one
/// factorisation takes a minute.
const PRODUCTS_PER_CALL: usize = 100_000_000;
/// A subproblem takes about as many rounds as rows enter; one that takes this many for each row of it goes round in a circle, by
/// rounding.
const MAX_ROUNDS_PER_ROW: usize = 20;
/// Residuals below this times the size of their terms are rounding.
const ROUNDING_SHARE: f64 = 1e-12;

/// Calls `stop` at most once per [`PRODUCTS_PER_CALL`].
struct Pace<'a> {
    /// Products since the last call.
    products: usize,
    stop: &'a mut dyn FnMut() -> bool,
}

impl Pace<'_> {
    /// Did `stop` end the search before these `products`?
    fn is_stopped(&mut self, products: usize) -> bool {
        self.products += products;
        if self.products <= PRODUCTS_PER_CALL {
            return false;
        }
        self.products = 0;
        (self.stop)()
    }
}

impl Qp<'_> {
    fn n(&self) -> usize {
        self.lower.len()
    }

    fn count(&self) -> usize {
        self.rows.kinds.len() + 2 * self.n()
    }

    fn kind(&self, row: usize) -> RowKind {
        if let Some(&kind) = self.rows.kinds.get(row) {
            return kind;
        }
        // The two bounds of a fixed variable are one equality, kept in the place of the lower one.
        let cap = f64::INFINITY;
        let (variable, sign) = self.bound_row(row);
        match (self.lower[variable] == self.upper[variable], sign < 0.0) {
            (false, _) if self.offset(row).is_infinite() => RowKind::Ignored,
            (false, _) => RowKind::Inequality { cap },
            (true, true) => RowKind::Equality { cap },
            (true, false) => RowKind::Ignored,
        }
    }

    fn bound_row(&self, row: usize) -> (usize, f64) {
        let index = row - self.rows.kinds.len();
        (index / 2, if index.is_multiple_of(2) { -1.0 } else { 1.0 })
    }

    fn offset(&self, row: usize) -> f64 {
        if let Some(&b) = self.rows.offsets.get(row) {
            return b;
        }
        let (variable, sign) = self.bound_row(row);
        if sign < 0.0 {
            self.lower[variable]
        } else {
            -self.upper[variable]
        }
    }

    fn gradient(&self, row: usize) -> &[f64] {
        &self.rows.gradients[row * self.n()..(row + 1) * self.n()]
    }

    fn member(&self, row: usize) -> Member {
        let vector = if row < self.rows.kinds.len() {
            self.factor.forward(self.gradient(row))
        } else {
            let (variable, sign) = self.bound_row(row);
            let mut unit = vec![0.0; self.n()];
            unit[variable] = sign;
            self.factor.forward(&unit)
        };
        Member {
            row,
            vector,
            offset: self.offset(row),
            objective: self.kind(row) == RowKind::Objective,
            range: self.kind(row).range(),
        }
    }

    /// The residual of a row at a step and the size of the terms it is made of.
    fn residual(&self, row: usize, step: &[f64], level: f64) -> (f64, f64) {
        if row < self.rows.kinds.len() {
            let (mut sum, mut size) = (self.offset(row), self.offset(row).abs());
            for (g, d) in self.gradient(row).iter().zip(step) {
                sum += g * d;
                size += (g * d).abs();
            }
            if self.kind(row) == RowKind::Objective {
                sum -= level;
                size += level.abs();
            }
            (sum, size)
        } else {
            let (variable, sign) = self.bound_row(row);
            let (d, b) = (sign * step[variable], self.offset(row));
            let size = step.iter().fold(b.abs(), |m, d| m.max(d.abs()));
            (d + b, size)
        }
    }

    /// Solves from the multipliers `warm` (of any length; a bad start only costs time), unless `stop` returns `true` meanwhile.
    pub(super) fn solve(&self, warm: &[f64], stop: &mut dyn FnMut() -> bool) -> QpSolution {
        let mut u = self.feasible_start(warm);
        let mut pace = Pace { products: 0, stop };
        let (mut members, mut held) = (Vec::new(), Vec::new());
        let mut stopped = !self.gather(&u, &mut pace, (&mut members, &mut held));
        // rows that left as soon as they entered, until a multiplier moves
        let mut barred = Vec::new();
        let (mut step, mut level) = (vec![0.0; self.n()], 0.0);
        let mut exact = false;
        let mut entered = None;
        for _ in 0..self.count().saturating_mul(MAX_ROUNDS_PER_ROW) {
            if stopped {
                break;
            }
            let subspace = Subspace::new(&members, &held, &u, self.n());
            let Some(outcome) = subspace.solve(|products| pace.is_stopped(products)) else {
                stopped = true;
                break;
            };
            let (direction, length) = match outcome {
                Outcome::Best { y, gamma, targets } => {
                    step = self.factor.backward(&y);
                    level = gamma;
                    let targets = members.iter().zip(&targets);
                    (targets.map(|(m, t)| t - u[m.row]).collect(), 1.0)
                }
                Outcome::Dependent { direction } => (direction, f64::INFINITY),
            };
            let (length, blocking) = blocked(&members, &u, &direction, length);
            if length.is_infinite() {
                // Rows that repeat others and must hold anyway: one of them is redundant.
                let last = direction.iter().rposition(|&v| v != 0.0);
                let redundant = members.remove(last.unwrap_or(0));
                barred.extend(entered.filter(|row| *row == redundant.row));
                if u[redundant.row] != 0.0 {
                    held.push(redundant);
                }
                continue;
            }
            for (member, change) in members.iter().zip(&direction) {
                u[member.row] += length * change;
            }
            let moved = members
                .iter()
                .zip(&direction)
                .any(|(m, change)| (length * change).abs() > ROUNDING_SHARE * u[m.row].abs());
            if moved {
                barred.clear();
            }
            // To the best multipliers of the working set, leaving rows behind at bounds.
            if let Some((index, bound)) = blocking {
                let left = members.remove(index);
                u[left.row] = bound;
                barred.extend(entered.filter(|row| *row == left.row));
                if bound != 0.0 {
                    held.push(left);
                }
                continue;
            }
            let Some(entering) = self.most_violated(&u, &members, &barred, &step, level) else {
                exact = true;
                break;
            };
            held.retain(|m| m.row != entering);
            members.push(self.member(entering));
            entered = Some(entering);
        }
        for (d, (low, high)) in step.iter_mut().zip(self.lower.iter().zip(self.upper)) {
            *d = d.clamp(*low, *high);
        }
        self.split_fixed(&mut u);
        QpSolution {
            step,
            multipliers: u,
            exact,
            stopped,
            blends: Vec::new(),
        }
    }

    /// The rows whose multipliers lie within their bounds, and those that are held at one but 0. Was `pace` not stopped?
    fn gather(
        &self,
        u: &[f64],
        pace: &mut Pace<'_>,
        (members, held): (&mut Vec<Member>, &mut Vec<Member>),
    ) -> bool {
        for (row, &multiplier) in u.iter().enumerate() {
            let (low, high) = self.kind(row).range();
            let list = if multiplier > low && multiplier < high {
                &mut *members
            } else if multiplier != 0.0 {
                &mut *held
            } else {
                continue;
            };
            // a triangle of products for each row
            if pace.is_stopped(self.n() * self.n() / 2) {
                return false;
            }
            list.push(self.member(row));
        }
        true
    }

    /// Gives the negative part of a fixed variable's multiplier to its upper bound.
    fn split_fixed(&self, u: &mut [f64]) {
        for (variable, pair) in u[self.rows.kinds.len()..].chunks_exact_mut(2).enumerate() {
            if self.lower[variable] == self.upper[variable] {
                (pair[0], pair[1]) = (pair[0].max(0.0), (-pair[0]).max(0.0));
            }
        }
    }

    /// Multipliers within their bounds, those of the objectives adding up to 1.
    fn feasible_start(&self, warm: &[f64]) -> Vec<f64> {
        let mut u: Vec<f64> = (0..self.count())
            .map(|row| {
                let (low, high) = self.kind(row).range();
                let mut start = warm.get(row).copied().unwrap_or(0.0);
                if row >= self.rows.kinds.len() && low < 0.0 {
                    start -= warm.get(row + 1).copied().unwrap_or(0.0);
                }
                if start.is_finite() {
                    start.clamp(low, high)
                } else {
                    0.0
                }
            })
            .collect();
        let objectives = || {
            self.rows
                .kinds
                .iter()
                .enumerate()
                .filter(|(_, kind)| **kind == RowKind::Objective)
                .map(|(row, _)| row)
        };
        let sum: f64 = objectives().map(|row| u[row]).sum();
        if sum > 0.0 {
            objectives().for_each(|row| u[row] /= sum);
        } else if let Some(highest) =
            objectives().max_by(|&a, &b| self.offset(a).total_cmp(&self.offset(b)))
        {
            u[highest] = 1.0;
        }
        u
    }

    /// The row outside the working set whose multiplier has most to gain.
    fn most_violated(
        &self,
        u: &[f64],
        members: &[Member],
        barred: &[usize],
        step: &[f64],
        level: f64,
    ) -> Option<usize> {
        let mut worst = None;
        let mut most = 0.0;
        for (row, &multiplier) in u.iter().enumerate() {
            let (low, high) = self.kind(row).range();
            let (residual, size) = self.residual(row, step, level);
            let bound = if residual > 0.0 { high } else { low };
            let gain = residual.abs();
            if multiplier != bound
                && gain > most
                && gain > ROUNDING_SHARE * size
                && !barred.contains(&row)
                && members.iter().all(|m| m.row != row)
            {
                most = gain;
                worst = Some(row);
            }
        }
        worst
    }
}

/// How far the multipliers may go along `direction`, and which one stops them at which bound.
fn blocked(
    members: &[Member],
    u: &[f64],
    direction: &[f64],
    length: f64,
) -> (f64, Option<(usize, f64)>) {
    let mut shortest = length;
    let mut blocking = None;
    for (index, (member, &change)) in members.iter().zip(direction).enumerate() {
        let bound = if change < 0.0 {
            member.range.0
        } else {
            member.range.1
        };
        if change == 0.0 {
            continue;
        }
        let room = ((bound - u[member.row]) / change).max(0.0);
        if room < shortest {
            shortest = room;
            blocking = Some((index, bound));
        }
    }
    (shortest, blocking)
}

#[cfg(test)]
#[path = "qp_tests.rs"]
mod tests;
