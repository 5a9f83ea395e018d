//! A problem with its method applied: rows that the solver pushes below one level γ, or below zero.

use crate::method::Method;
use crate::problem::{Problem, Relation};

/// What a row represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Row value ≤ γ, and γ is minimised.
    Objective(usize),
    /// Row value ≤ 0: an objective whose goal is a limit.
    HardGoal(usize),
    /// Row value ≤ 0.
    Inequality(usize),
    /// Row value = 0.
    Equality(usize),
}

impl Kind {
    pub(crate) fn is_objective(self) -> bool {
        matches!(self, Self::Objective(_))
    }
}

/// One row: (sign · f − shift) · scale of one of the model's functions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub(crate) function: usize,
    pub(crate) sign: f64,
    pub(crate) shift: f64,
    pub(crate) scale: f64,
    pub(crate) kind: Kind,
}

impl Row {
    /// The row's value, given the function's.
    pub(crate) fn value(&self, function: f64) -> f64 {
        (self.sign * function - self.shift) * self.scale
    }

    /// The derivative of the row by its function.
    pub(crate) fn slope(&self) -> f64 {
        self.sign * self.scale
    }
}

/// A row of A x ≤ b or A x = b.
#[derive(Clone, Debug)]
pub(crate) struct LinearRow {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) equal: bool,
    pub(crate) bound: f64,
}

/// What the solver sees.
pub(crate) struct Program<'p> {
    pub(crate) problem: &'p Problem<'p>,
    pub(crate) rows: Vec<Row>,
    pub(crate) linear: Vec<LinearRow>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    pub(crate) start: Vec<f64>,
}

impl<'p> Program<'p> {
    /// Applies goals and weights; the method must not be a weighted sum, which is a problem of its own.
    pub(crate) fn new(problem: &'p Problem<'p>, method: &Method) -> Self {
        let objectives = problem.objectives().len();
        let mut rows = Vec::new();
        for i in 0..objectives {
            let (goal, weight) = match method {
                Method::Minimax | Method::Weighted { .. } => (0.0, 1.0),
                Method::Attain { goals, weights } => (goals[i], weights[i]),
                Method::Chebyshev { ideal, weights } if weights[i] > 0.0 => {
                    (ideal[i], 1.0 / weights[i])
                }
                Method::Chebyshev { .. } => continue,
            };
            let (kind, scale) = if weight > 0.0 {
                (Kind::Objective(i), 1.0 / weight)
            } else {
                (Kind::HardGoal(i), 1.0)
            };
            let signs: &[f64] = if i < problem.absolute() {
                &[1.0, -1.0]
            } else {
                &[1.0]
            };
            rows.extend(signs.iter().map(|&sign| Row {
                function: i,
                sign,
                shift: goal,
                scale,
                kind,
            }));
        }
        let plain = |function, kind| Row {
            function,
            sign: 1.0,
            shift: 0.0,
            scale: 1.0,
            kind,
        };
        let inequalities = problem.inequalities().len();
        rows.extend((0..inequalities).map(|j| plain(objectives + j, Kind::Inequality(j))));
        rows.extend(
            (0..problem.equalities().len())
                .map(|k| plain(objectives + inequalities + k, Kind::Equality(k))),
        );
        let variables = problem.variables();
        Self {
            rows,
            linear: problem
                .linear()
                .iter()
                .map(|row| LinearRow {
                    coefficients: row.coefficients.clone(),
                    equal: row.relation == Relation::Equal,
                    bound: row.bound,
                })
                .collect(),
            lower: variables.iter().map(|v| v.lower).collect(),
            upper: variables.iter().map(|v| v.upper).collect(),
            start: variables
                .iter()
                .map(|v| v.start.clamp(v.lower, v.upper))
                .collect(),
            problem,
        }
    }

    pub(crate) fn dimension(&self) -> usize {
        self.start.len()
    }
}
