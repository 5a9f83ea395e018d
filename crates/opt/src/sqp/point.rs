//! A point with its row values, and the counted evaluation of such points.

use crate::callback::{Callback, Progress, Stage};
use crate::jacobian::Jacobian;
use crate::parts::{self, Parts};
use crate::program::{Kind, Program, Row};
use crate::solution::Counts;

/// The rows at a point.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) x: Vec<f64>,
    pub(super) functions: Vec<f64>,
    /// One per row of the program.
    pub(super) rows: Vec<f64>,
    /// What the functions are made of, where that is known.
    pub(super) parts: Vec<f64>,
}

impl Point {
    pub(super) fn new(
        program: &Program<'_>,
        x: Vec<f64>,
        functions: Vec<f64>,
        parts: Vec<f64>,
    ) -> Self {
        Self {
            x,
            rows: rows(program, &functions),
            functions,
            parts,
        }
    }

    /// The level γ: the greatest objective row.
    pub(super) fn level(&self, program: &Program<'_>) -> f64 {
        program
            .rows
            .iter()
            .zip(&self.rows)
            .filter(|(row, _)| row.kind.is_objective())
            .fold(f64::NEG_INFINITY, |m, (_, &v)| if v > m { v } else { m })
    }

    /// The greatest magnitude of an objective row.
    pub(super) fn objective_size(&self, program: &Program<'_>) -> f64 {
        program
            .rows
            .iter()
            .zip(&self.rows)
            .filter(|(row, _)| row.kind.is_objective())
            .fold(0.0, |m, (_, v)| v.abs().max(m))
    }

    /// The sum of all violations of rows that are not objectives.
    pub(super) fn total_violation(&self, program: &Program<'_>) -> f64 {
        program
            .rows
            .iter()
            .zip(&self.rows)
            .map(|(row, &v)| violation(row.kind, v))
            .sum()
    }

    /// The greatest of them.
    pub(super) fn worst_violation(&self, program: &Program<'_>) -> f64 {
        program
            .rows
            .iter()
            .zip(&self.rows)
            .map(|(row, &v)| violation(row.kind, v))
            .fold(0.0, f64::max)
    }

    /// The first function without a finite value.
    pub(super) fn not_finite(&self, program: &Program<'_>) -> Option<usize> {
        program
            .rows
            .iter()
            .find(|row| !self.functions[row.function].is_finite())
            .map(|row| row.function)
    }
}

fn rows(program: &Program<'_>, functions: &[f64]) -> Vec<f64> {
    let value = |row: &Row| row.value(functions[row.function]);
    program.rows.iter().map(value).collect()
}

/// By how much a row of this kind is violated at this value; without limit where it has none.
pub(crate) fn violation(kind: Kind, value: f64) -> f64 {
    match kind {
        Kind::Objective(_) => 0.0,
        _ if value.is_nan() => f64::INFINITY,
        Kind::HardGoal(_) | Kind::Inequality(_) => value.max(0.0),
        Kind::Equality(_) => value.abs(),
    }
}

/// What the callback hears of: the point that a search has reached.
#[derive(Debug)]
struct Reached {
    x: Vec<f64>,
    utility: f64,
    violation: f64,
    stationarity: Option<f64>,
}

/// The model behind a counter, and the callback, which may stop an evaluation that takes long.
pub(super) struct Evaluator<'a, 'w, 'f> {
    pub(super) program: &'a Program<'a>,
    pub(super) counts: Counts,
    callback: &'w mut Callback<'f>,
    reached: Reached,
    /// Did the callback end the search? Then nothing is evaluated any more: every value is NaN.
    pub(super) stopped: bool,
}

impl<'a, 'w, 'f> Evaluator<'a, 'w, 'f> {
    pub(super) fn new(
        program: &'a Program<'a>,
        callback: &'w mut Callback<'f>,
        counts: Counts,
    ) -> Self {
        Self {
            program,
            counts,
            callback,
            reached: Reached {
                x: program.start.clone(),
                utility: f64::INFINITY,
                violation: f64::INFINITY,
                stationarity: None,
            },
            stopped: false,
        }
    }
}

impl Evaluator<'_, '_, '_> {
    /// From now on the callback hears of this point.
    pub(super) fn reach(&mut self, point: &Point, stationarity: Option<f64>) {
        self.reached = Reached {
            x: point.x.clone(),
            utility: point.level(self.program),
            violation: point.worst_violation(self.program),
            stationarity,
        };
    }

    /// Calls the callback: does it end the search, or did it before?
    pub(super) fn is_stopped(&mut self) -> bool {
        let progress = Progress {
            stage: Stage::Solve,
            iteration: self.counts.iterations,
            x: &self.reached.x,
            utility: self.reached.utility,
            violation: self.reached.violation,
            stationarity: self.reached.stationarity,
        };
        self.stopped = self.stopped || (self.callback)(&progress).is_break();
        self.stopped
    }

    /// Functions and parts at `x`, with the gradients of both where they are wanted.
    fn evaluate(
        &mut self,
        x: &[f64],
        gradients: Option<(&mut Jacobian, &mut Jacobian)>,
    ) -> (Vec<f64>, Vec<f64>) {
        let problem = self.program.problem;
        let model = problem.model();
        let mut functions = vec![f64::NAN; problem.function_count()];
        let mut parts = vec![f64::NAN; model.parts().map_or(0, Parts::count)];
        if self.stopped {
            return (functions, parts);
        }
        let (jacobian, slopes) = gradients.unzip();
        let watch = &mut || self.is_stopped();
        match model.parts() {
            Some(source) => {
                let Some((jacobian, slopes)) = jacobian.zip(slopes) else {
                    source.evaluate(x, &mut parts, None, watch);
                    parts::functions(source, &parts, &mut functions);
                    return (functions, parts);
                };
                source.evaluate(x, &mut parts, Some(slopes), watch);
                parts::functions(source, &parts, &mut functions);
                parts::gradients(source, (&parts, slopes), jacobian);
            }
            None => model.evaluate(x, &mut functions, jacobian, watch),
        }
        (functions, parts)
    }

    pub(super) fn values(&mut self, x: &[f64]) -> Point {
        let (mut functions, parts) = self.evaluate(x, None);
        if self.stopped {
            functions.fill(f64::NAN);
        }
        self.counts.values += 1;
        Point::new(self.program, x.to_vec(), functions, parts)
    }

    /// Values at a probe, which has a count of its own.
    pub(super) fn probe(&mut self, x: &[f64]) {
        let counts = self.counts;
        self.values(x);
        self.counts = Counts {
            probes: counts.probes + 1,
            ..counts
        };
    }

    /// Derivatives at a point whose values are known: of the functions, and of their parts. Its values are refreshed, unless the
    /// callback stops the evaluation.
    pub(super) fn derivatives(&mut self, point: &mut Point) -> (Jacobian, Jacobian) {
        let n = point.x.len();
        let mut jacobian = Jacobian::zeros(point.functions.len(), n);
        let mut slopes = Jacobian::zeros(point.parts.len(), n);
        let gradients = Some((&mut jacobian, &mut slopes));
        let (functions, parts) = self.evaluate(&point.x, gradients);
        self.counts.jacobians += 1;
        if !self.stopped {
            point.rows = rows(self.program, &functions);
            (point.functions, point.parts) = (functions, parts);
        }
        (jacobian, slopes)
    }
}
