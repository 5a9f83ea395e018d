//! Conditional value at risk: the mean of the worst 1 − α of the worlds.
//!
//! ```text
//! CVaR_α(f) = min over η of  η + Σ_k max(0, f_k − η) / ((1 − α) K)  =  max over w of  Σ_k w_k f_k,
//! where Σ w_k = 1 and 0 ≤ w_k ≤ 1/((1 − α) K)
//! ```
//! The second form needs no variables beside the problem's own: the worst worlds have the greatest weight, and a solver that
//! knows the worlds' functions as [`Parts`] chooses the weights anew wherever it looks.
//!
//! Source: Rockafellar & Uryasev 2000, J. Risk 2; the second form: Rockafellar, Uryasev & Zabarankin 2006, Finance Stoch. 10.

use super::{Values, Worlds};
use crate::error::Result;
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::parts::{Parts, functions, gradients};
use crate::problem::{Problem, ProblemParams};
use crate::watch::Watch;

struct Cvar<'a> {
    worlds: Worlds<'a>,
    /// 1/((1 − α) K).
    share: f64,
}

/// The parts are the functions, each in every world.
impl Parts for Cvar<'_> {
    fn count(&self) -> usize {
        self.worlds.functions * self.worlds.count()
    }

    fn evaluate(
        &self,
        x: &[f64],
        parts: &mut [f64],
        mut jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        let count = self.worlds.count();
        let join = |worlds: &[Values]| {
            let functions_of = 0..self.worlds.functions;
            let own = functions_of.flat_map(|f| worlds.iter().map(move |world| world.0[f]));
            let (m, parts) = (self.worlds.m, own.collect::<Vec<_>>());
            let mut values = vec![f64::NAN; m + (self.worlds.functions - m) * count];
            functions(self, &parts, &mut values);
            values
        };
        let worlds = self.worlds.evaluate(x, jacobian.is_some(), watch, &join);
        for (k, (values, gradients)) in worlds.iter().enumerate() {
            for (function, value) in values.iter().enumerate() {
                let part = function * count + k;
                parts[part] = *value;
                if let Some(jacobian) = &mut jacobian {
                    let gradient = gradients.row(function);
                    jacobian.row_mut(part).copy_from_slice(gradient);
                }
            }
        }
    }

    fn combination(&self, function: usize, parts: &[f64]) -> Vec<(usize, f64)> {
        let (m, count) = (self.worlds.m, self.worlds.count());
        if function >= m {
            return vec![(m * count + function - m, 1.0)];
        }
        let first = function * count;
        let own = &parts[first..first + count];
        if let Some(k) = own.iter().position(|value| value.is_nan()) {
            return vec![(first + k, 1.0)];
        }
        let is_absolute = function < self.worlds.absolute;
        let size = |k: &usize| if is_absolute { own[*k].abs() } else { own[*k] };
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| size(b).total_cmp(&size(a)));
        let mut left = 1.0;
        let mut tail: Vec<(usize, f64)> = Vec::new();
        for k in order {
            let weight = self.share.min(left);
            if !(weight > 0.0) {
                break;
            }
            left -= weight;
            let sign = if is_absolute && own[k] < 0.0 {
                -1.0
            } else {
                1.0
            };
            tail.push((first + k, sign * weight));
        }
        tail.sort_by_key(|(part, _)| *part);
        tail
    }
}

impl Model for Cvar<'_> {
    fn parts(&self) -> Option<&dyn Parts> {
        Some(self)
    }

    fn failure(&self, x: &[f64]) -> Option<String> {
        self.worlds.failure(x)
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        let mut parts = vec![f64::NAN; self.count()];
        Parts::evaluate(self, x, &mut parts, None, &mut || false);
        functions(self, &parts, values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        let mut parts = vec![f64::NAN; self.count()];
        let mut slopes = Jacobian::zeros(parts.len(), self.worlds.n);
        Parts::evaluate(self, x, &mut parts, Some(&mut slopes), &mut || false);
        functions(self, &parts, values);
        gradients(self, (&parts, &slopes), jacobian);
    }
}

pub(super) fn problem<'a>(
    params: ProblemParams<'a>,
    worlds: Worlds<'a>,
    alpha: f64,
) -> Result<Problem<'a>> {
    let share = 1.0 / ((1.0 - alpha) * worlds.count() as f64);
    Problem::new(ProblemParams {
        inequalities: worlds.names(&params.inequalities),
        equalities: worlds.names(&params.equalities),
        absolute: 0,
        worlds: 1,
        objectives: params.objectives,
        variables: params.variables,
        linear: params.linear,
        model: Box::new(Cvar { worlds, share }),
    })
}
