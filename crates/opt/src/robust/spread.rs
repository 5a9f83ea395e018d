//! Mean plus κ standard deviations: `F = μ + κ σ`, `μ = Σ f_k / K`, `σ² = Σ (f_k − μ)² / K`,
//! with `∇σ = Σ (f_k − μ) ∇f_k / (K σ)`.

use super::{Values, Worlds};
use crate::error::Result;
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::problem::{Problem, ProblemParams};
use crate::watch::Watch;

/// A σ below this share of the mean is rounding.
const ROUNDING_SHARE: f64 = 1e-12;

struct Spread<'a> {
    worlds: Worlds<'a>,
    kappa: f64,
}

impl Spread<'_> {
    fn sign(&self, objective: usize, value: f64) -> f64 {
        if objective < self.worlds.absolute && value < 0.0 {
            -1.0
        } else {
            1.0
        }
    }

    /// μ and σ of an objective.
    fn moments(&self, objective: usize, all: &[f64]) -> (f64, f64) {
        let count = all.len() as f64;
        let value = |f: f64| self.sign(objective, f) * f;
        let mean = all.iter().map(|&f| value(f)).sum::<f64>() / count;
        let variance = all
            .iter()
            .map(|&f| (value(f) - mean) * (value(f) - mean))
            .sum::<f64>()
            / count;
        (mean, variance.sqrt())
    }
}

impl Spread<'_> {
    /// The functions, from those of every world.
    fn join(&self, worlds: &[Values], values: &mut [f64], mut jacobian: Option<&mut Jacobian>) {
        let m = self.worlds.m;
        let count = worlds.len() as f64;
        for (i, slot) in values[..m].iter_mut().enumerate() {
            let all: Vec<f64> = worlds.iter().map(|w| w.0[i]).collect();
            let (mean, sigma) = self.moments(i, &all);
            *slot = mean + self.kappa * sigma;
            let Some(jacobian) = &mut jacobian else {
                continue;
            };
            let row = jacobian.row_mut(i);
            row.fill(0.0);
            for (f, world) in all.iter().zip(worlds) {
                let sign = self.sign(i, *f);
                // Without any spread but rounding σ has no slope of its own.
                let outlying = if sigma > ROUNDING_SHARE * mean.abs() {
                    self.kappa * (sign * f - mean) / sigma
                } else {
                    0.0
                };
                let weight = sign * (1.0 + outlying) / count;
                for (out, g) in row.iter_mut().zip(world.1.row(i)) {
                    *out += weight * g;
                }
            }
        }
        let mut row = m;
        for function in m..self.worlds.functions {
            for world in worlds {
                values[row] = world.0[function];
                if let Some(jacobian) = &mut jacobian {
                    jacobian.row_mut(row).copy_from_slice(world.1.row(function));
                }
                row += 1;
            }
        }
    }
}

impl Model for Spread<'_> {
    fn failure(&self, x: &[f64]) -> Option<String> {
        self.worlds.failure(x)
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.evaluate(x, values, None, &mut || false);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.evaluate(x, values, Some(jacobian), &mut || false);
    }

    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        let join = |worlds: &[Values]| {
            let m = self.worlds.m;
            let mut values = vec![f64::NAN; m + (self.worlds.functions - m) * worlds.len()];
            self.join(worlds, &mut values, None);
            values
        };
        let worlds = self.worlds.evaluate(x, jacobian.is_some(), watch, &join);
        self.join(&worlds, values, jacobian);
    }
}

pub(super) fn problem<'a>(
    params: ProblemParams<'a>,
    worlds: Worlds<'a>,
    kappa: f64,
) -> Result<Problem<'a>> {
    Problem::new(ProblemParams {
        inequalities: worlds.names(&params.inequalities),
        equalities: worlds.names(&params.equalities),
        absolute: 0,
        worlds: 1,
        objectives: params.objectives,
        variables: params.variables,
        linear: params.linear,
        model: Box::new(Spread { worlds, kappa }),
    })
}
