//! The weighted sum Σ w_i f_i as a problem with one objective.
//!
//! Objectives that count with their absolute value get a variable each, t_i ≥ ±f_i, and Σ w_i t_i is
//! minimised: smooth, and exact at the optimum.

use crate::callback::Callback;
use crate::error::Result;
use crate::jacobian::Jacobian;
use crate::method::Method;
use crate::model::Model;
use crate::problem::{LinearConstraint, Problem, ProblemParams, Variable};
use crate::settings::Settings;
use crate::solution::Solution;
use crate::sqp;

struct Sum<'a> {
    problem: &'a Problem<'a>,
    weights: &'a [f64],
    /// Of each lifted objective.
    lifted: Vec<usize>,
}

impl Sum<'_> {
    /// The functions in their new order, from the old values and x.
    fn arrange(&self, x: &[f64], old: &[f64], new: &mut [f64]) {
        let n = self.problem.variables().len();
        let m = self.problem.objectives().len();
        let mut sum = 0.0;
        for (t, &i) in self.lifted.iter().enumerate() {
            sum += self.weights[i] * x[n + t];
        }
        let plain = self.problem.absolute()..m;
        for (weight, value) in self.weights[plain.clone()].iter().zip(&old[plain]) {
            // An objective that does not count may have no value.
            if *weight > 0.0 {
                sum += weight * value;
            }
        }
        new[0] = sum;
        let mut rows = new[1..].iter_mut();
        for (t, &i) in self.lifted.iter().enumerate() {
            for sign in [1.0, -1.0] {
                if let Some(row) = rows.next() {
                    *row = sign * old[i] - x[n + t];
                }
            }
        }
        for (row, old) in rows.zip(&old[m..]) {
            *row = *old;
        }
    }
}

impl Model for Sum<'_> {
    fn failure(&self, x: &[f64]) -> Option<String> {
        let n = self.problem.variables().len();
        self.problem.model().failure(&x[..n])
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        let n = self.problem.variables().len();
        let mut old = vec![f64::NAN; self.problem.function_count()];
        self.problem.model().values(&x[..n], &mut old);
        self.arrange(x, &old, values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        let n = self.problem.variables().len();
        let m = self.problem.objectives().len();
        let mut old = vec![f64::NAN; self.problem.function_count()];
        let mut slopes = Jacobian::zeros(old.len(), n);
        self.problem
            .model()
            .derivatives(&x[..n], &mut old, &mut slopes);
        self.arrange(x, &old, values);
        let mut row = 0;
        let sum = jacobian.row_mut(row);
        sum.fill(0.0);
        for i in self.problem.absolute()..m {
            if self.weights[i] > 0.0 {
                for (out, g) in sum.iter_mut().zip(slopes.row(i)) {
                    *out += self.weights[i] * g;
                }
            }
        }
        for (t, &i) in self.lifted.iter().enumerate() {
            sum[n + t] = self.weights[i];
        }
        for (t, &i) in self.lifted.iter().enumerate() {
            for sign in [1.0, -1.0] {
                row += 1;
                let out = jacobian.row_mut(row);
                out.fill(0.0);
                for (out, g) in out.iter_mut().zip(slopes.row(i)) {
                    *out = sign * g;
                }
                out[n + t] = -1.0;
            }
        }
        for constraint in m..old.len() {
            row += 1;
            let out = jacobian.row_mut(row);
            out.fill(0.0);
            out[..n].copy_from_slice(slopes.row(constraint));
        }
    }
}

/// Σ w_i f_i at a point, |f_i| where absolute.
pub(crate) fn utility(problem: &Problem<'_>, weights: &[f64], x: &[f64]) -> f64 {
    let mut values = vec![f64::NAN; problem.function_count()];
    problem.model().values(x, &mut values);
    let sized = |(i, f): (usize, &f64)| if i < problem.absolute() { f.abs() } else { *f };
    let counted = values.iter().enumerate().zip(weights);
    let counted = counted.filter(|(_, weight)| **weight > 0.0);
    counted.map(|(f, weight)| weight * sized(f)).sum()
}

pub(crate) fn solve(
    problem: &Problem<'_>,
    weights: &[f64],
    settings: &Settings,
    callback: &mut Callback<'_>,
) -> Result<Solution> {
    let n = problem.variables().len();
    let m = problem.objectives().len();
    let lifted: Vec<usize> = (0..problem.absolute())
        .filter(|&i| weights[i] > 0.0)
        .collect();
    let start: Vec<f64> = problem.variables().iter().map(|v| v.start).collect();
    let mut values = vec![f64::NAN; problem.function_count()];
    problem.model().values(&start, &mut values);
    let mut variables = problem.variables().to_vec();
    let mut inequalities = Vec::new();
    for &i in &lifted {
        let size = values[i].abs();
        let start = if size.is_finite() { size } else { 0.0 };
        variables.push(Variable::free(
            format!("\u{2502}{}\u{2502}", problem.objectives()[i]),
            start,
        ));
        inequalities.push(format!("+ {}", problem.objectives()[i]));
        inequalities.push(format!("- {}", problem.objectives()[i]));
    }
    let added = inequalities.len();
    inequalities.extend_from_slice(problem.inequalities());
    let linear = problem
        .linear()
        .iter()
        .map(|row| {
            let mut row: LinearConstraint = row.clone();
            row.coefficients.resize(n + lifted.len(), 0.0);
            row
        })
        .collect();
    let inner = Problem::new(ProblemParams {
        variables,
        objectives: vec!["weighted sum".to_owned()],
        inequalities,
        equalities: problem.equalities().to_vec(),
        linear,
        absolute: 0,
        model: Box::new(Sum {
            problem,
            weights,
            lifted: lifted.clone(),
        }),
    })?
    .linear_after(problem.curved());
    let mut solution = sqp::solve(&inner, &Method::Minimax, settings, callback);
    // Back to the variables and objectives of the original problem.
    solution.x.truncate(n);
    problem.model().values(&solution.x, &mut values);
    solution.objectives = values[..m].to_vec();
    solution.maximum = sqp::greatest(problem, &values);
    let total: f64 = weights.iter().sum();
    solution.multipliers.objectives = weights.iter().map(|w| w / total).collect();
    solution.multipliers.hard_goals = vec![0.0; m];
    solution.multipliers.inequalities.drain(..added);
    solution.inequalities.drain(..added);
    solution.multipliers.lower.truncate(n);
    solution.multipliers.upper.truncate(n);
    let own = |name: &String| {
        !name.starts_with("+ ") && !name.starts_with("- ") && !name.contains('\u{2502}')
    };
    solution.active.retain(own);
    Ok(solution)
}
