//! The price ρ of a violation, raised only where that buys feasibility.
//!
//! Source: Byrd, Nocedal & Waltz 2008, "Steering exact penalty methods for nonlinear programming".

use super::point::violation;
use super::qp::{QpSolution, RowKind, Rows};
use super::{Expansion, MAX_PRICE, Phase, Sqp, subspace};
use crate::program::Program;

/// A tenfold price must lower the linearised violation at least to this share to be worth it.
const MIN_FEASIBILITY_GAIN: f64 = 0.9;

impl Sqp<'_, '_, '_, '_> {
    /// Linearises and solves the subproblem, raising the price while that lowers the violation.
    pub(super) fn priced_step(&mut self, model: &Expansion) -> (Rows, QpSolution) {
        let price = match self.phase {
            Phase::Optimality => self.price,
            Phase::Elastic => 1.0,
        };
        let mut rows = self.linearise(model, price);
        let warm = std::mem::take(&mut self.multipliers);
        let mut best = self.subproblem(model, &rows, &warm);
        if best.stopped || self.phase == Phase::Elastic {
            return (rows, best);
        }
        let tolerance = 0.1 * self.settings.constraint_tolerance;
        let mut left = linear_violation(self.program, &rows, &best.step);
        let mut trial_price = price;
        while left > tolerance && trial_price < MAX_PRICE {
            trial_price *= 10.0;
            set_price(&mut rows, trial_price);
            let trial = self.subproblem(model, &rows, &best.multipliers);
            if trial.stopped {
                return (rows, trial);
            }
            let trial_left = linear_violation(self.program, &rows, &trial.step);
            if trial_left > MIN_FEASIBILITY_GAIN * left && trial_price > 1e3 * self.price {
                break;
            }
            if trial_left <= MIN_FEASIBILITY_GAIN * left {
                (best, left) = (trial, trial_left);
                self.price = trial_price;
            }
        }
        set_price(&mut rows, self.price);
        (rows, best)
    }
}

fn set_price(rows: &mut Rows, price: f64) {
    for kind in &mut rows.kinds {
        match kind {
            RowKind::Inequality { cap } | RowKind::Equality { cap } if cap.is_finite() => {
                *cap = price;
            }
            _ => {}
        }
    }
}

/// What the linearised nonlinear constraints are violated by after a step, together.
pub(super) fn linear_violation(program: &Program<'_>, rows: &Rows, step: &[f64]) -> f64 {
    let n = step.len();
    program
        .rows
        .iter()
        .enumerate()
        .map(|(index, row)| {
            let gradient = &rows.gradients[index * n..(index + 1) * n];
            violation(
                row.kind,
                rows.offsets[index] + subspace::dot(gradient, step),
            )
        })
        .sum()
}
