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

/// A minimax problem that is linear but for a common curvature, over a box of steps.
pub(crate) struct LinearModel<'a> {
    pub(crate) kinds: &'a [LinearKind],
    /// Row-major.
    pub(crate) gradients: &'a [f64],
    pub(crate) offsets: &'a [f64],
    /// The curvature ½ dᵀB d that is added to γ, symmetric; `None` for next to none.
    pub(crate) curvature: Option<&'a [f64]>,
    pub(crate) lower: &'a [f64],
    pub(crate) upper: &'a [f64],
}

impl LinearModel<'_> {
    /// Minimises γ; gives one multiplier per row, those of the objectives ≥ 0 with the sum 1, and the step. The
    /// multipliers are nearly optimal, and any such numbers give a valid bound. `None` without an objective that
    /// varies, and for a curvature that is not positive definite.
    pub(crate) fn solve(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let n = self.lower.len();
        let variation = |row: usize| -> f64 {
            let gradient = &self.gradients[row * n..(row + 1) * n];
            gradient.iter().map(|g| g.abs()).sum()
        };
        let count = self.kinds.len();
        let objectives = || (0..count).filter(|row| self.kinds[*row] == LinearKind::Objective);
        let size = objectives().map(variation).fold(0.0, f64::max);
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let sizes: Vec<f64> = (0..count)
            .map(|row| match self.kinds[row] {
                LinearKind::Objective => size,
                _ => Some(variation(row)).filter(|v| *v > 0.0).unwrap_or(1.0),
            })
            .collect();
        let cap = VIOLATION_WEIGHT;
        let kind = |kind: &LinearKind| match kind {
            LinearKind::Objective => RowKind::Objective,
            LinearKind::AtMost => RowKind::Inequality { cap },
            LinearKind::Equal => RowKind::Equality { cap },
        };
        let gradients = self.gradients.iter().enumerate();
        let rows = Rows {
            kinds: self.kinds.iter().map(kind).collect(),
            gradients: gradients.map(|(at, g)| g / sizes[at / n]).collect(),
            offsets: self
                .offsets
                .iter()
                .zip(&sizes)
                .map(|(b, size)| b / size)
                .collect(),
            parts: Vec::new(),
        };
        let mut curvature = match self.curvature {
            Some(curvature) => curvature.iter().map(|b| b / size).collect(),
            None => vec![0.0; n * n],
        };
        if self.curvature.is_none() {
            for d in 0..n {
                curvature[d * n + d] = CURVATURE_SHARE;
            }
        }
        let qp = Qp {
            factor: &Factor::new(&curvature, n)?,
            rows: &rows,
            lower: self.lower,
            upper: self.upper,
        };
        let solution = qp.solve(&[], &mut || false);
        let mut multipliers = solution.multipliers;
        multipliers.truncate(count);
        for (multiplier, own) in multipliers.iter_mut().zip(&sizes) {
            *multiplier *= size / own;
        }
        Some((multipliers, solution.step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(
        kinds: &[LinearKind],
        gradients: &[f64],
        offsets: &[f64],
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        LinearModel {
            kinds,
            gradients,
            offsets,
            curvature: None,
            lower: &[-1.0],
            upper: &[1.0],
        }
        .solve()
    }

    /// max(2 d, −d/2) is least at 0 with the multipliers 0.2 and 0.8; a limit of 1000 (d + 1/2) costs 2/1000 of the first.
    #[test]
    fn multipliers_of_lines() {
        use LinearKind::{AtMost, Objective};
        let near = |found: &[f64], expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-6, "{found} {expected}");
            }
        };
        let (multipliers, step) = solve(&[Objective; 2], &[2.0, -0.5], &[0.0; 2]).unwrap();
        near(&multipliers, &[0.2, 0.8]);
        near(&step, &[0.0]);
        // a limit that does not vary costs nothing, met or not
        for offset in [-1.0, 1.0] {
            let found = solve(&[Objective, AtMost], &[2.0, 0.0], &[0.0, offset]).unwrap();
            near(&found.0[..1], &[1.0]);
            near(&found.1, &[-1.0]);
            assert!(found.0[1].is_finite());
        }
        // −2 d pulls up to d = −1/2
        let (multipliers, step) =
            solve(&[Objective, AtMost], &[-2.0, 1000.0], &[0.0, 500.0]).unwrap();
        near(&multipliers, &[1.0, 2e-3]);
        near(&step, &[-0.5]);
        // so it does up to 1e-6 (d + 1/2), whose violation costs as much as that of d + 1/2
        let (_, step) = solve(&[Objective, AtMost], &[-2.0, 1e-6], &[0.0, 0.5e-6]).unwrap();
        near(&step, &[-0.5]);
        for gradient in [0.0, f64::INFINITY, f64::NAN] {
            assert_eq!(solve(&[Objective], &[gradient], &[1.0]), None);
        }
    }
}
