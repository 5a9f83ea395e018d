//! The best feasible point that a solve has evaluated: no search returns less.

use std::sync::{Mutex, PoisonError};

use crate::merit::Merit;
use crate::method::Method;
use crate::problem::Problem;
use crate::program::Program;
use crate::record::{MAX_SOLVED_VIOLATION, REFUTING_DECREASE, Record};
use crate::settings::Settings;
use crate::solution::{Kkt, Solution};
use crate::sqp;
use crate::status::Status;

/// A point that was evaluated.
#[derive(Clone, Debug)]
pub(crate) struct Evaluated {
    pub(crate) x: Vec<f64>,
    functions: Vec<f64>,
    merit: Merit,
}

/// The best points of a solve: of those that violate nothing, and of those that violate no constraint by more than its tolerance.
pub(crate) struct Best<'p> {
    program: Program<'p>,
    method: &'p Method,
    settings: &'p Settings,
    found: Mutex<[Option<Evaluated>; 2]>,
}

impl Record for Best<'_> {
    fn note(&self, x: &[f64], functions: &[f64]) {
        let merit = Merit::at(&self.program, self.method, x, functions);
        let limits = [0.0, self.settings.constraint_tolerance];
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        for (best, limit) in found.iter_mut().zip(limits) {
            let is_better = best
                .as_ref()
                .is_none_or(|best| merit.utility < best.merit.utility);
            if merit.violation <= limit && merit.utility.is_finite() && is_better {
                *best = Some(Evaluated {
                    x: x.to_vec(),
                    functions: functions.to_vec(),
                    merit,
                });
            }
        }
    }
}

impl<'p> Best<'p> {
    pub(crate) fn new(
        problem: &'p Problem<'p>,
        method: &'p Method,
        settings: &'p Settings,
    ) -> Self {
        Self {
            program: Program::new(problem, method),
            method,
            settings,
            found: Mutex::default(),
        }
    }

    /// A feasible point that was evaluated and is better than a solution, by more than the tolerances of a solve leave open:
    /// what a violation within its tolerance gains, at the solution's multipliers, is one of them.
    pub(crate) fn better_than(&self, solution: &Solution) -> Option<Evaluated> {
        let prices = &solution.multipliers;
        let price: f64 = [
            &prices.hard_goals,
            &prices.inequalities,
            &prices.equalities,
            &prices.linear,
        ]
        .into_iter()
        .flatten()
        .map(|price| price.abs())
        .sum();
        let allowed = MAX_SOLVED_VIOLATION.max(self.settings.constraint_tolerance);
        let is_feasible = solution.kkt.violation <= allowed
            && !matches!(solution.status, Status::NoFeasiblePoint(_));
        let level = solution.utility;
        let is_better = |best: &&Evaluated| {
            let open = REFUTING_DECREASE * (1.0 + level.abs()) + price * best.merit.violation;
            !is_feasible || level.is_nan() || best.merit.utility < level - open
        };
        let found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        found.iter().flatten().find(is_better).cloned()
    }

    /// An evaluated point as a solution, with the multipliers and the residuals of the last point with derivatives.
    pub(crate) fn solution(&self, best: Evaluated, last: Solution, status: Status) -> Solution {
        let (program, utility) = (&self.program, best.merit.utility);
        let values = (best.x, best.functions);
        let found = sqp::unexpanded(program, self.settings, last.counts, values, status);
        Solution {
            utility,
            multipliers: last.multipliers,
            kkt: Kkt {
                violation: found.kkt.violation,
                ..last.kkt
            },
            ..found
        }
    }
}
