//! What a search has evaluated: every solver sees the functions of a problem through a model that notes each evaluation, so that
//! no search returns less than the best feasible point that it has seen.

use std::sync::{Mutex, PoisonError};

use crate::jacobian::Jacobian;
use crate::method::Method;
use crate::model::Model;
use crate::parts::{Parts, functions};
use crate::problem::Problem;
use crate::program::Program;
use crate::settings::Settings;
use crate::solution::{Kkt, Solution};
use crate::solve::Merit;
use crate::sqp;
use crate::status::Status;
use crate::watch::Watch;

/// A decrease of the utility beyond this · (1 + |utility|) refutes a solution. The optimality conditions themselves leave 1e-8 of
/// it open ([`Settings::optimality_tolerance`]).
pub(crate) const REFUTING_DECREASE: f64 = 1e-7;
/// A point that violates a constraint by more than this is no solution, whatever its optimality.
pub(crate) const MAX_SOLVED_VIOLATION: f64 = 1e-6;

/// Notes evaluations, from any thread.
pub(crate) trait Record: Sync {
    /// All functions have these values at `x`.
    fn note(&self, x: &[f64], functions: &[f64]);
}

/// A model whose evaluations are noted.
pub(crate) struct Recorded<'a> {
    model: &'a dyn Model,
    functions: usize,
    record: &'a dyn Record,
}

impl<'a> Recorded<'a> {
    pub(crate) fn new(problem: &'a Problem<'_>, record: &'a dyn Record) -> Self {
        Self {
            model: problem.model(),
            functions: problem.function_count(),
            record,
        }
    }
}

/// Passes on what an evaluation reports, and notes points that the derivatives needed.
struct Followed<'a> {
    watch: &'a mut dyn Watch,
    record: &'a dyn Record,
    stopped: bool,
}

impl Watch for Followed<'_> {
    fn stop(&mut self) -> bool {
        self.stopped |= self.watch.stop();
        self.stopped
    }

    fn seen(&mut self, x: &[f64], functions: &[f64]) {
        self.record.note(x, functions);
        self.watch.seen(x, functions);
    }
}

impl Model for Recorded<'_> {
    fn failure(&self, x: &[f64]) -> Option<String> {
        self.model.failure(x)
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        Model::evaluate(self, x, values, None, &mut || false);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        Model::evaluate(self, x, values, Some(jacobian), &mut || false);
    }

    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        let (record, stopped) = (self.record, false);
        let mut followed = Followed {
            watch,
            record,
            stopped,
        };
        self.model.evaluate(x, values, jacobian, &mut followed);
        if !followed.stopped {
            self.record.note(x, values);
        }
    }

    fn parts(&self) -> Option<&dyn Parts> {
        self.model.parts().map(|_| self as &dyn Parts)
    }
}

impl Parts for Recorded<'_> {
    fn count(&self) -> usize {
        self.model.parts().map_or(0, Parts::count)
    }

    fn evaluate(
        &self,
        x: &[f64],
        parts: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        let Some(source) = self.model.parts() else {
            return;
        };
        let (record, stopped) = (self.record, false);
        let mut followed = Followed {
            watch,
            record,
            stopped,
        };
        source.evaluate(x, parts, jacobian, &mut followed);
        if !followed.stopped {
            let mut values = vec![f64::NAN; self.functions];
            functions(source, parts, &mut values);
            self.record.note(x, &values);
        }
    }

    fn combination(&self, function: usize, parts: &[f64]) -> Vec<(usize, f64)> {
        let source = self.model.parts();
        source.map_or_else(Vec::new, |source| source.combination(function, parts))
    }
}

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
