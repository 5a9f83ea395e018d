//! Multipliers of a minimax problem that is linear over a small box.

use super::factor::Factor;
use super::qp::{Qp, RowKind, Rows};

/// Curvature of the subproblem as a share of the rows' variation over the box: its multipliers are those of the
/// linear problem but for this much.
const CURVATURE_SHARE: f64 = 1e-4;
/// What a unit of a constraint's violation costs, in units of the objectives' variation.
const VIOLATION_WEIGHT: f64 = 1e4;

/// What a row of the linear problem is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LinearKind {
    /// g·d + b ≤ γ.
    Objective,
    /// g·d + b ≤ 0.
    AtMost,
    /// g·d + b = 0.
    Equal,
}

/// Minimises γ over −1 ≤ d ≤ 1; gives one multiplier per row, those of the objectives ≥ 0 with the sum 1. They are
/// nearly optimal, and any such numbers give a valid bound. `None` without an objective that varies.
pub(crate) fn linear_multipliers(
    n: usize,
    kinds: &[LinearKind],
    gradients: &[f64],
    offsets: &[f64],
) -> Option<Vec<f64>> {
    let variation = |row: usize| -> f64 {
        let gradient = &gradients[row * n..(row + 1) * n];
        gradient.iter().map(|g| g.abs()).sum()
    };
    let objectives = || (0..kinds.len()).filter(|row| kinds[*row] == LinearKind::Objective);
    let size = objectives().map(variation).fold(0.0, f64::max);
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let sizes: Vec<f64> = (0..kinds.len())
        .map(|row| match kinds[row] {
            LinearKind::Objective => size,
            _ => Some(variation(row)).filter(|v| *v > 0.0).unwrap_or(1.0),
        })
        .collect();
    let rows = Rows {
        kinds: kinds
            .iter()
            .map(|kind| match kind {
                LinearKind::Objective => RowKind::Objective,
                LinearKind::AtMost => RowKind::Inequality {
                    cap: VIOLATION_WEIGHT,
                },
                LinearKind::Equal => RowKind::Equality {
                    cap: VIOLATION_WEIGHT,
                },
            })
            .collect(),
        gradients: gradients
            .iter()
            .enumerate()
            .map(|(at, g)| g / sizes[at / n])
            .collect(),
        offsets: offsets
            .iter()
            .zip(&sizes)
            .map(|(b, size)| b / size)
            .collect(),
    };
    let mut curvature = vec![0.0; n * n];
    for d in 0..n {
        curvature[d * n + d] = CURVATURE_SHARE;
    }
    let qp = Qp {
        factor: &Factor::new(&curvature, n)?,
        rows: &rows,
        lower: &vec![-1.0; n],
        upper: &vec![1.0; n],
    };
    let mut multipliers = qp.solve(&[]).multipliers;
    multipliers.truncate(kinds.len());
    for (multiplier, own) in multipliers.iter_mut().zip(&sizes) {
        *multiplier *= size / own;
    }
    Some(multipliers)
}
