//! Conditional value at risk by its epigraph.
//!
//! ```text
//! CVaR_α(f) = min over η of  η + Σ_k max(0, f_k − η) / ((1 − α) K)
//! ```
//! so each objective gets the helpers η and s_k ≥ 0 with f_k − η − s_k ≤ 0, and η + Σ s_k/((1 − α) K) takes
//! its place: smooth, and linear in the helpers.
//!
//! Source: Rockafellar & Uryasev 2000, J. Risk 2.

use super::{Worlds, set_row};
use crate::error::Result;
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::problem::{LinearConstraint, Problem, ProblemParams, Variable};

struct Cvar<'a> {
    worlds: Worlds<'a>,
    /// 1/((1 − α) K).
    share: f64,
}

impl Cvar<'_> {
    /// The index of η of an objective in x; s_k of world k follows it.
    fn eta(&self, objective: usize) -> usize {
        self.worlds.n + objective * (1 + self.worlds.count())
    }

    fn signs(&self, objective: usize) -> &'static [f64] {
        if objective < self.worlds.absolute {
            &[1.0, -1.0]
        } else {
            &[1.0]
        }
    }

    /// The objectives and the excess rows, from the worlds' values.
    fn fill(&self, x: &[f64], worlds: &[&[f64]], values: &mut [f64]) {
        let (m, count) = (self.worlds.m, self.worlds.count());
        let mut row = m;
        for (i, slot) in values[..m].iter_mut().enumerate() {
            let eta = self.eta(i);
            *slot = x[eta] + self.share * x[eta + 1..=eta + count].iter().sum::<f64>();
        }
        for i in 0..m {
            let eta = self.eta(i);
            for (k, world) in worlds.iter().enumerate() {
                for sign in self.signs(i) {
                    values[row] = sign * world[i] - x[eta] - x[eta + 1 + k];
                    row += 1;
                }
            }
        }
        for function in m..self.worlds.functions {
            for world in worlds {
                values[row] = world[function];
                row += 1;
            }
        }
    }
}

impl Model for Cvar<'_> {
    fn failure(&self, x: &[f64]) -> Option<String> {
        self.worlds.failure(x)
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        let worlds = self.worlds.values(x);
        let worlds: Vec<&[f64]> = worlds.iter().map(Vec::as_slice).collect();
        self.fill(x, &worlds, values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        let worlds = self.worlds.derivatives(x);
        let plain: Vec<&[f64]> = worlds.iter().map(|w| w.0.as_slice()).collect();
        self.fill(x, &plain, values);
        let (m, count) = (self.worlds.m, self.worlds.count());
        let mut row = m;
        for i in 0..m {
            let eta = self.eta(i);
            let objective = jacobian.row_mut(i);
            objective.fill(0.0);
            objective[eta] = 1.0;
            objective[eta + 1..=eta + count].fill(self.share);
            for (k, world) in worlds.iter().enumerate() {
                for sign in self.signs(i) {
                    let excess = jacobian.row_mut(row);
                    set_row(excess, world.1.row(i));
                    excess[..self.worlds.n].iter_mut().for_each(|g| *g *= sign);
                    excess[eta] = -1.0;
                    excess[eta + 1 + k] = -1.0;
                    row += 1;
                }
            }
        }
        for function in m..self.worlds.functions {
            for world in &worlds {
                set_row(jacobian.row_mut(row), world.1.row(function));
                row += 1;
            }
        }
    }
}

pub(super) fn problem<'a>(
    params: ProblemParams<'a>,
    worlds: Worlds<'a>,
    alpha: f64,
) -> Result<Problem<'a>> {
    let (n, count) = (params.variables.len(), worlds.count());
    let share = 1.0 / ((1.0 - alpha) * count as f64);
    let start: Vec<f64> = params
        .variables
        .iter()
        .map(|v| v.start.clamp(v.lower, v.upper))
        .collect();
    let at_start = worlds.values(&start);
    let mut variables = params.variables;
    let mut excesses = Vec::new();
    for (i, name) in params.objectives.iter().enumerate() {
        let value = |w: &Vec<f64>| {
            if i < worlds.absolute {
                w[i].abs()
            } else {
                w[i]
            }
        };
        let worst = at_start.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
        // At the worst value no world exceeds η: a feasible start.
        let worst = if worst.is_finite() { worst } else { 0.0 };
        variables.push(Variable::free(format!("eta of {name}"), worst));
        for world in &worlds.list {
            let helper = format!("excess of {name} @ {}", world.name);
            variables.push(Variable::bounded(helper, 0.0, 0.0, f64::INFINITY));
            let signs: &[&str] = if i < worlds.absolute {
                &["+", "-"]
            } else {
                &["+"]
            };
            excesses.extend(
                signs
                    .iter()
                    .map(|sign| format!("{sign}{name} @ {}", world.name)),
            );
        }
    }
    excesses.extend(worlds.names(&params.inequalities));
    let total = variables.len();
    let linear = params
        .linear
        .into_iter()
        .map(|mut row: LinearConstraint| {
            row.coefficients.resize(total, 0.0);
            row
        })
        .collect();
    Ok(Problem::new(ProblemParams {
        variables,
        objectives: params.objectives,
        inequalities: excesses,
        equalities: worlds.names(&params.equalities),
        linear,
        absolute: 0,
        worlds: 1,
        model: Box::new(Cvar { worlds, share }),
    })?
    .linear_after(n))
}
