//! A point with its row values, and the counted evaluation of such points.

use crate::jacobian::Jacobian;
use crate::parts;
use crate::program::{Kind, Program};
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

/// By how much a row of this kind is violated at this value.
pub(super) fn violation(kind: Kind, value: f64) -> f64 {
    match kind {
        Kind::Objective(_) => 0.0,
        Kind::HardGoal(_) | Kind::Inequality(_) => value.max(0.0),
        Kind::Equality(_) => value.abs(),
    }
}

/// The model behind a counter.
pub(super) struct Evaluator<'a> {
    pub(super) program: &'a Program<'a>,
    pub(super) counts: Counts,
}

impl Evaluator<'_> {
    fn rows(&self, functions: &[f64]) -> Vec<f64> {
        self.program
            .rows
            .iter()
            .map(|row| row.value(functions[row.function]))
            .collect()
    }

    pub(super) fn values(&mut self, x: &[f64]) -> Point {
        let problem = self.program.problem;
        let mut functions = vec![f64::NAN; problem.function_count()];
        let mut parts = Vec::new();
        match problem.model().parts() {
            Some(source) => {
                parts.resize(source.count(), f64::NAN);
                source.values(x, &mut parts);
                parts::functions(source, &parts, &mut functions);
            }
            None => problem.model().values(x, &mut functions),
        }
        self.counts.values += 1;
        Point {
            x: x.to_vec(),
            rows: self.rows(&functions),
            functions,
            parts,
        }
    }

    /// Values at a probe, which has a count of its own.
    pub(super) fn probe(&mut self, x: &[f64]) -> Point {
        let counts = self.counts;
        let point = self.values(x);
        self.counts = Counts {
            probes: counts.probes + 1,
            ..counts
        };
        point
    }

    /// Derivatives at a point whose values are known: of the functions, and of their parts. Its values are refreshed.
    pub(super) fn derivatives(&mut self, point: &mut Point) -> (Jacobian, Jacobian) {
        let problem = self.program.problem;
        let n = point.x.len();
        let mut jacobian = Jacobian::zeros(point.functions.len(), n);
        let mut slopes = Jacobian::zeros(point.parts.len(), n);
        if let Some(source) = problem.model().parts() {
            source.derivatives(&point.x, &mut point.parts, &mut slopes);
            parts::functions(source, &point.parts, &mut point.functions);
            parts::gradients(source, (&point.parts, &slopes), &mut jacobian);
        } else {
            let functions = &mut point.functions;
            let model = problem.model();
            model.derivatives(&point.x, functions, &mut jacobian);
        }
        self.counts.jacobians += 1;
        point.rows = self.rows(&point.functions);
        (jacobian, slopes)
    }
}
