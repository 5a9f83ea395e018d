//! The weighted sum Σ w_i f_i as a problem with one objective.
//!
//! Objectives that count with their absolute value, and those of several worlds, of which the worst counts, get a variable
//! each, t_i ≥ ±f_i in every world, and Σ w_i t_i is minimised: smooth, and exact at the optimum.

use crate::callback::Callback;
use crate::error::Result;
use crate::jacobian::Jacobian;
use crate::method::Method;
use crate::model::Model;
use crate::parts::Parts;
use crate::problem::{LinearConstraint, Problem, ProblemParams, Variable};
use crate::settings::Settings;
use crate::solution::{Counts, Solution};
use crate::sqp;
use crate::watch::Watch;

/// The names of added variables and rows begin with it: those of the problem, which are reported, do not.
const MARK: char = '\u{2502}';

/// An objective with a variable t of its own: Σ has weight · t, and each row's share · f ≤ t.
struct Lifted {
    weight: f64,
    /// Places of objectives, with their shares.
    rows: Vec<(usize, f64)>,
}

struct Sum<'a> {
    problem: &'a Problem<'a>,
    lifted: Vec<Lifted>,
    /// Places and weights of the objectives that are summed as they are.
    plain: Vec<(usize, f64)>,
}

impl Sum<'_> {
    /// t_i, each with the rows below it.
    fn rows(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let lifted = self.lifted.iter().enumerate();
        lifted.flat_map(|(t, lifted)| lifted.rows.iter().map(move |(i, share)| (t, *i, *share)))
    }

    /// The functions in their new order, from the old values and x.
    fn arrange(&self, x: &[f64], old: &[f64], new: &mut [f64]) {
        let n = self.problem.variables().len();
        let m = self.problem.objectives().len();
        let lifted = self
            .lifted
            .iter()
            .zip(&x[n..])
            .map(|(own, t)| own.weight * t);
        let plain = self.plain.iter().map(|(i, weight)| weight * old[*i]);
        new[0] = lifted.chain(plain).sum();
        let rows = self.rows().map(|(t, i, share)| share * old[i] - x[n + t]);
        let all = rows.chain(old[m..].iter().copied());
        for (new, value) in new[1..].iter_mut().zip(all) {
            *new = value;
        }
    }
}

impl Model for Sum<'_> {
    fn parts(&self) -> Option<&dyn Parts> {
        self.problem.model().parts().map(|_| self as &dyn Parts)
    }

    fn failure(&self, x: &[f64]) -> Option<String> {
        let n = self.problem.variables().len();
        self.problem.model().failure(&x[..n])
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
        let n = self.problem.variables().len();
        let m = self.problem.objectives().len();
        let mut old = vec![f64::NAN; self.problem.function_count()];
        let mut slopes = jacobian.is_some().then(|| Jacobian::zeros(old.len(), n));
        let model = self.problem.model();
        model.evaluate(&x[..n], &mut old, slopes.as_mut(), watch);
        self.arrange(x, &old, values);
        let (Some(jacobian), Some(slopes)) = (jacobian, slopes) else {
            return;
        };
        let mut row = 0;
        let sum = jacobian.row_mut(row);
        sum.fill(0.0);
        for (i, weight) in &self.plain {
            for (out, g) in sum.iter_mut().zip(slopes.row(*i)) {
                *out += weight * g;
            }
        }
        for (t, lifted) in self.lifted.iter().enumerate() {
            sum[n + t] = lifted.weight;
        }
        for (t, i, share) in self.rows() {
            row += 1;
            let out = jacobian.row_mut(row);
            out.fill(0.0);
            for (out, g) in out.iter_mut().zip(slopes.row(i)) {
                *out = share * g;
            }
            out[n + t] = -1.0;
        }
        for constraint in m..old.len() {
            row += 1;
            let out = jacobian.row_mut(row);
            out.fill(0.0);
            out[..n].copy_from_slice(slopes.row(constraint));
        }
    }
}

/// The parts are those of the problem. Its objectives are then neither absolute nor of several worlds: all are summed as they are.
impl Parts for Sum<'_> {
    fn count(&self) -> usize {
        self.problem.model().parts().map_or(0, Parts::count)
    }

    fn evaluate(
        &self,
        x: &[f64],
        parts: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        if let Some(own) = self.problem.model().parts() {
            own.evaluate(x, parts, jacobian, watch);
        }
    }

    fn combination(&self, function: usize, parts: &[f64]) -> Vec<(usize, f64)> {
        let of = |own: usize| {
            let model = self.problem.model();
            model
                .parts()
                .map_or(Vec::new(), |own_parts| own_parts.combination(own, parts))
        };
        if function > 0 {
            return of(self.problem.objectives().len() + function - 1);
        }
        let terms = self.plain.iter().flat_map(|(i, weight)| {
            of(*i)
                .into_iter()
                .map(move |(part, share)| (part, weight * share))
        });
        terms.collect()
    }
}

/// Σ w_i f_i, |f_i| where absolute, of several worlds the worst.
pub(crate) fn utility(problem: &Problem<'_>, weights: &[f64], values: &[f64]) -> f64 {
    let term = |(i, weight): (usize, f64)| {
        let f = values[i];
        weight * if i < problem.absolute() { f.abs() } else { f }
    };
    let worse = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
    let groups = problem.weighted(weights);
    groups
        .filter_map(|group| group.into_iter().map(term).reduce(worse))
        .sum()
}

/// The objectives with a variable of their own, and the others with their weights.
fn divided(problem: &Problem<'_>, weights: &[f64]) -> (Vec<Lifted>, Vec<(usize, f64)>) {
    let (mut lifted, mut plain) = (Vec::new(), Vec::new());
    for group in problem.weighted(weights) {
        let is_absolute = group.first().is_some_and(|(i, _)| *i < problem.absolute());
        if group.len() < 2 && !is_absolute {
            plain.extend(group);
            continue;
        }
        let weight = group
            .iter()
            .fold(0.0, |most: f64, (_, weight)| most.max(*weight));
        let signs: &[f64] = if is_absolute { &[1.0, -1.0] } else { &[1.0] };
        let rows = group
            .iter()
            .flat_map(|(i, own)| signs.iter().map(move |sign| (*i, sign * own / weight)));
        let rows: Vec<_> = rows.collect();
        if !rows.is_empty() {
            lifted.push(Lifted { weight, rows });
        }
    }
    (lifted, plain)
}

pub(crate) fn solve(
    problem: &Problem<'_>,
    weights: &[f64],
    settings: &Settings,
    callback: &mut Callback<'_>,
    counts: Counts,
) -> Result<Solution> {
    let n = problem.variables().len();
    let m = problem.objectives().len();
    let (lifted, plain) = divided(problem, weights);
    let start: Vec<f64> = problem.variables().iter().map(|v| v.start).collect();
    let mut values = vec![f64::NAN; problem.function_count()];
    problem.model().values(&start, &mut values);
    let mut variables = problem.variables().to_vec();
    let mut inequalities = Vec::new();
    for own in &lifted {
        let sizes = own.rows.iter().map(|(i, share)| share * values[*i]);
        let size = sizes.fold(f64::NEG_INFINITY, f64::max);
        let start = if size.is_finite() { size } else { 0.0 };
        let name = |i: usize| format!("{MARK}{}{MARK}", problem.objectives()[i]);
        variables.push(Variable::free(name(own.rows[0].0), start));
        let rows = own.rows.iter().enumerate();
        inequalities.extend(rows.map(|(k, (i, _))| format!("{}{k}", name(*i))));
    }
    let added = inequalities.len();
    inequalities.extend_from_slice(problem.inequalities());
    let linear = problem
        .linear()
        .iter()
        .map(|row| {
            let mut row: LinearConstraint = row.clone();
            row.coefficients.resize(variables.len(), 0.0);
            row
        })
        .collect();
    let sum = Sum {
        problem,
        lifted,
        plain,
    };
    let rows: Vec<_> = sum.rows().map(|(_, i, share)| (i, share)).collect();
    let inner = Problem::new(ProblemParams {
        variables,
        objectives: vec!["weighted sum".to_owned()],
        inequalities,
        equalities: problem.equalities().to_vec(),
        linear,
        absolute: 0,
        worlds: 1,
        model: Box::new(sum),
    })?
    .with_curved(n);
    let mut solution = sqp::solve(&inner, &Method::Minimax, settings, callback, counts);
    // Back to the variables and objectives of the original problem.
    solution.x.truncate(n);
    problem.model().values(&solution.x, &mut values);
    solution.objectives = values[..m].to_vec();
    solution.maximum = sqp::greatest(problem, &values);
    // that of the objectives themselves: their variables may be above them within the tolerance
    let own = utility(problem, weights, &values);
    if !own.is_nan() {
        solution.utility = own;
    }
    // a world's share of its objective's weight is the multiplier of its row
    let mut prices = weights.to_vec();
    for group in problem.weighted(weights).filter(|group| group.len() > 1) {
        for (i, _) in group {
            let own = rows.iter().zip(&solution.multipliers.inequalities);
            let own = own.filter(|((row, _), _)| *row == i);
            prices[i] = own.map(|((_, share), price)| share.abs() * price).sum();
        }
    }
    let total: f64 = prices.iter().sum();
    solution.multipliers.objectives = prices.iter().map(|w| w / total).collect();
    solution.multipliers.hard_goals = vec![0.0; m];
    solution.multipliers.inequalities.drain(..added);
    solution.inequalities.drain(..added);
    solution.multipliers.lower.truncate(n);
    solution.multipliers.upper.truncate(n);
    solution.active.retain(|name| !name.starts_with(MARK));
    Ok(solution)
}

#[cfg(test)]
#[path = "weighted_tests.rs"]
mod tests;
