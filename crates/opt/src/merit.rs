//! How good a point is.

use crate::method::Method;
use crate::program::Program;
use crate::{sqp, weighted};

/// What a solve minimises and what it must not violate, at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Merit {
    /// What is minimised: the greatest (scaled) objective, or their weighted sum.
    pub utility: f64,
    /// The greatest violation of any constraint or bound; 0 where all hold.
    pub violation: f64,
}

impl Merit {
    /// The merit of a point whose functions are known: NaN, or a violation without limit, where one has no value.
    pub(crate) fn at(program: &Program<'_>, method: &Method, x: &[f64], functions: &[f64]) -> Self {
        let greater = |m: f64, v: f64| if v > m || v.is_nan() { v } else { m };
        let (mut utility, mut worst) = (f64::NEG_INFINITY, 0.0_f64);
        for row in &program.rows {
            let value = row.value(functions[row.function]);
            if row.kind.is_objective() {
                utility = greater(utility, value);
            } else {
                worst = worst.max(sqp::violation(row.kind, value));
            }
        }
        if let Method::Weighted { weights } = method {
            utility = weighted::utility(program.problem, weights, functions);
        }
        let linear = program.linear.iter().map(|row| {
            let sum: f64 = row.coefficients.iter().zip(x).map(|(a, x)| a * x).sum();
            let off = sum - row.bound;
            if row.equal { off.abs() } else { off }
        });
        let bounds = program.lower.iter().zip(&program.upper).zip(x);
        let bounds = bounds.flat_map(|((low, high), x)| [low - x, x - high]);
        Self {
            utility,
            violation: linear.chain(bounds).fold(worst, f64::max),
        }
    }
}
