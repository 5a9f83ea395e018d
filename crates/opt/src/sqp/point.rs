//! A point with its row values, and the counted evaluation of such points.

use crate::jacobian::Jacobian;
use crate::program::{Kind, Program};
use crate::solution::Counts;

/// The rows at a point.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) x: Vec<f64>,
    pub(super) functions: Vec<f64>,
    /// One per row of the program.
    pub(super) rows: Vec<f64>,
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
        let mut functions = vec![f64::NAN; self.program.problem.function_count()];
        self.program.problem.model().values(x, &mut functions);
        self.counts.values += 1;
        Point {
            x: x.to_vec(),
            rows: self.rows(&functions),
            functions,
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

    /// Derivatives at a point whose values are known; its values are refreshed.
    pub(super) fn derivatives(&mut self, point: &mut Point) -> Jacobian {
        let mut jacobian = Jacobian::zeros(point.functions.len(), point.x.len());
        self.program
            .problem
            .model()
            .derivatives(&point.x, &mut point.functions, &mut jacobian);
        self.counts.jacobians += 1;
        point.rows = self.rows(&point.functions);
        jacobian
    }
}
