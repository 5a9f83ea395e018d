//! The search along a step, with a second-order correction where the full step is refused.
//!
//! The merit function is φ = level + ρ Σ violations; the subproblem promises the decrease Δ ≥ ½ dᵀB d
//! for the full step. A point is accepted when φ falls by a fixed share of the promise, against the
//! greatest of the last few values (a kinked valley is followed faster so). When d is refused, the rows'
//! values at x + d bend it: d̂ solves the subproblem with the offsets f(x + d) − ∇f·d, and the search goes
//! along the arc x + α d + α² (d̂ − d), which stays inside the linear constraints.
//!
//! Source: Zhou & Tits 1993, SIAM J. Optim. 3 (arc, nonmonotone); Fletcher 1982 (second-order correction).

use super::point::Point;
use super::price::linear_violation;
use super::qp::{QpSolution, Rows};
use super::{Expansion, Phase, Sqp, subspace};

/// Share of the promised decrease that a step must deliver.
const MIN_DECREASE_SHARE: f64 = 1e-4;
/// Number of past merits that a step may be compared with.
const MEMORY: usize = 3;
/// So many steps in a row may promise no more than rounding: they can still improve the multipliers.
const QUIET: usize = 4;
/// ‖d̂ − d‖² may be at most this share of ‖d‖².
const MAX_BEND_SHARE: f64 = 0.5;
/// Shortest fraction of a step that is tried.
const MIN_STEP_SHARE: f64 = 1e-14;

pub(super) enum Outcome {
    /// A point with less merit.
    Step(Point),
    /// The promise is below rounding.
    NoDecrease,
    /// Every fraction of the step was refused.
    NoStep,
}

impl Sqp<'_, '_, '_, '_> {
    fn merit(&self, point: &Point) -> f64 {
        match self.phase {
            Phase::Optimality => {
                point.level(self.program) + self.price * point.total_violation(self.program)
            }
            Phase::Elastic => point.total_violation(self.program),
        }
    }

    /// The merit of the linearised rows after a step.
    fn linear_merit(&self, rows: &Rows, solution: &QpSolution) -> f64 {
        let violation = linear_violation(self.program, rows, &solution.step);
        match self.phase {
            Phase::Optimality => {
                let n = solution.step.len();
                let level = rows
                    .kinds
                    .iter()
                    .enumerate()
                    .filter(|(_, kind)| **kind == super::RowKind::Objective)
                    .map(|(i, _)| {
                        let gradient = &rows.gradients[i * n..(i + 1) * n];
                        rows.offsets[i] + subspace::dot(gradient, &solution.step)
                    })
                    .fold(f64::NEG_INFINITY, f64::max);
                level + self.price * violation
            }
            Phase::Elastic => violation,
        }
    }

    fn at(&mut self, model: &Expansion, step: &[f64], bend: Option<&[f64]>, alpha: f64) -> Point {
        let x: Vec<f64> = (0..step.len())
            .map(|i| {
                let bent = bend.map_or(0.0, |bend| alpha * alpha * (bend[i] - step[i]));
                (model.point.x[i] + alpha * step[i] + bent)
                    .clamp(self.program.lower[i], self.program.upper[i])
            })
            .collect();
        self.evaluator.values(&x)
    }

    pub(super) fn search(
        &mut self,
        model: &Expansion,
        rows: &Rows,
        solution: &QpSolution,
    ) -> Outcome {
        let merit = self.merit(&model.point);
        let rounding = 16.0 * f64::EPSILON * merit.abs().max(f64::MIN_POSITIVE);
        // The subproblem's optimality gives Δ ≥ dᵀB d; near the end the difference of merits is noise.
        let energy = self.curvature.energy(&solution.step);
        let promise = (merit - self.linear_merit(rows, solution)).max(energy);
        self.quiet = if promise > rounding {
            0
        } else {
            self.quiet + 1
        };
        if !(energy > 0.0) || self.quiet > QUIET {
            return Outcome::NoDecrease;
        }
        self.history.push(merit);
        if self.history.len() > MEMORY {
            self.history.remove(0);
        }
        let reference = self.history.iter().fold(merit, |m, &v| m.max(v));
        let accept = |sqp: &Self, point: &Point, alpha: f64| {
            point.not_finite(sqp.program).is_none()
                && sqp.merit(point) <= reference - MIN_DECREASE_SHARE * alpha * promise + rounding
        };
        let step = &solution.step;
        let full = self.at(model, step, None, 1.0);
        if accept(self, &full, 1.0) {
            return Outcome::Step(full);
        }
        let bend = self.corrected(model, rows, solution, &full);
        if let Some(bend) = &bend {
            let corrected = self.at(model, step, Some(bend), 1.0);
            if accept(self, &corrected, 1.0) {
                return Outcome::Step(corrected);
            }
        }
        let mut alpha = 0.5;
        while alpha > MIN_STEP_SHARE {
            let point = self.at(model, step, bend.as_deref(), alpha);
            if accept(self, &point, alpha) {
                return Outcome::Step(point);
            }
            if self.evaluator.counts.values >= self.settings.max_values {
                break;
            }
            alpha *= 0.5;
        }
        if promise <= rounding {
            Outcome::NoDecrease
        } else {
            Outcome::NoStep
        }
    }

    /// d̂ from the rows' values at the refused point; `None` where they are no help.
    fn corrected(
        &mut self,
        model: &Expansion,
        rows: &Rows,
        solution: &QpSolution,
        full: &Point,
    ) -> Option<Vec<f64>> {
        if full.not_finite(self.program).is_some() {
            return None;
        }
        let n = solution.step.len();
        let mut bent = rows.clone();
        for (index, &value) in full.rows.iter().enumerate() {
            let gradient = &rows.gradients[index * n..(index + 1) * n];
            bent.offsets[index] = value - subspace::dot(gradient, &solution.step);
        }
        for (k, part) in bent.parts.iter_mut().enumerate() {
            *part = full.parts[k] - subspace::dot(model.slopes.row(k), &solution.step);
        }
        let corrected = self.subproblem(model, &bent, &solution.multipliers);
        let (d, bend): (f64, f64) = corrected
            .step
            .iter()
            .zip(&solution.step)
            .map(|(a, b)| (b * b, (a - b) * (a - b)))
            .fold((0.0, 0.0), |s, t| (s.0 + t.0, s.1 + t.1));
        // A correction about as long as the step is no correction: it may even lead back to the start.
        (corrected.exact && bend <= MAX_BEND_SHARE * d).then_some(corrected.step)
    }
}
