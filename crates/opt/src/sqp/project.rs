//! The start, moved into the linear constraints: the nearest point that meets them.

use grouser_real::Real;

use super::factor::Factor;
use super::qp::{Qp, RowKind, Rows};
use super::subspace::dot;
use crate::program::Program;
use crate::settings::Settings;
use crate::status::Violation;

/// Minimises ½ ‖d‖² + ρ Σ violations of A x ≤ b, A_eq x = b_eq within the bounds.
///
/// Where `stop` returns `true` meanwhile, the nearest point so far. `Err` holds the least-infeasible point and what is violated there.
pub(super) fn onto_linear(
    program: &Program<'_>,
    settings: &Settings,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Vec<f64>, (Vec<f64>, Vec<Violation>)> {
    let violated = |x: &[f64]| -> Vec<f64> {
        program
            .linear
            .iter()
            .map(|row| {
                let value = dot(&row.coefficients, x) - row.bound;
                if row.equal {
                    value.abs()
                } else {
                    value.max(0.0)
                }
            })
            .collect()
    };
    let worst = |x: &[f64]| violated(x).into_iter().fold(0.0, f64::max);
    let mut x = program.start.clone();
    let scale = program
        .linear
        .iter()
        .map(|row| row.bound.abs())
        .fold(1.0, f64::max);
    let tolerance = settings.constraint_tolerance * scale;
    if worst(&x) <= 1e-3 * tolerance {
        return Ok(x);
    }
    let n = x.len();
    let mut identity = vec![0.0; n * n];
    (0..n).for_each(|i| identity[i * n + i] = 1.0);
    let Some(factor) = Factor::new(&identity, n) else {
        return Ok(x);
    };
    // The price must exceed the multipliers of the nearest point, which grow with its distance.
    for exponent in [3, 6, 9, 12] {
        let cap = Real::powi(10.0_f64, exponent);
        let mut rows = Rows::default();
        for row in &program.linear {
            rows.kinds.push(if row.equal {
                RowKind::Equality { cap }
            } else {
                RowKind::Inequality { cap }
            });
            rows.offsets.push(dot(&row.coefficients, &x) - row.bound);
            rows.gradients.extend(&row.coefficients);
        }
        let lower: Vec<f64> = program.lower.iter().zip(&x).map(|(b, x)| b - x).collect();
        let upper: Vec<f64> = program.upper.iter().zip(&x).map(|(b, x)| b - x).collect();
        let solution = Qp {
            factor: &factor,
            rows: &rows,
            lower: &lower,
            upper: &upper,
        }
        .solve(&[], stop);
        for (i, x) in x.iter_mut().enumerate() {
            *x = (*x + solution.step[i]).clamp(program.lower[i], program.upper[i]);
        }
        if solution.stopped || worst(&x) <= 1e-3 * tolerance {
            return Ok(x);
        }
    }
    if worst(&x) <= tolerance {
        return Ok(x);
    }
    let violations = program
        .problem
        .linear()
        .iter()
        .zip(violated(&x))
        .filter(|(_, amount)| *amount > tolerance)
        .map(|(row, amount)| Violation {
            name: row.name.clone(),
            amount,
        })
        .collect();
    Err((x, violations))
}
