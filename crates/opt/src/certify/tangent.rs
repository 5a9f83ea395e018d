//! Bounds of second order: where to take the tangent, with which multipliers and curvature.

use grouser_real::Interval;

use super::bound::{Multipliers, Tangent, Weights, exceeds_curvature};
use super::expansion::Expansion;
use super::process::{Aim, Examined, Examiner, allowed};
use super::rows::Rows;
use crate::sqp::LinearModel;

/// How many quadratic models a bound of second order is tried with.
const MAX_TANGENTS: usize = 4;
/// A curvature of this size, relative to the level, costs less than rounding.
const CURVATURE_SLACK: f64 = 1e-9;
/// Steps of the search for the greatest curvature that is proved.
const CURVATURE_STEPS: usize = 5;
/// How often the curvature of a model is raised, and from what share of its size by what factor, until it is positive definite.
const MAX_SHIFTS: usize = 8;
const MIN_SHIFT: f64 = 1e-9;
const SHIFT_FACTOR: f64 = 20.0;

impl Examiner {
    /// Bounds of second order, with multipliers from quadratic models at points that approach the best of the box.
    pub(super) fn bound_by_tangents(
        &mut self,
        rows: &Rows,
        expansion: &Expansion,
        examined: &mut Examined,
        aim: &Aim<'_>,
    ) {
        let target = aim.target;
        let x = examined.rest.clone();
        let n = x.len();
        if target == f64::INFINITY {
            return;
        }
        let inside = |p: &&[f64]| x.iter().zip(*p).all(|(x, p)| x.contains(*p));
        let mut at: Vec<f64> = aim
            .best
            .filter(inside)
            .map_or_else(|| x.iter().map(|x| x.middle()).collect(), <[f64]>::to_vec);
        let radii: Vec<f64> = x.iter().map(|x| 0.5 * x.width()).collect();
        let mut weights = examined.weights.rows.clone();
        let Some(mut hessian) = self.bounder.hessian(rows, &weights, &x) else {
            return;
        };
        for _ in 0..MAX_TANGENTS {
            let scaled = scaled_middle(&hessian, &radii);
            let Some((next, step, promised)) =
                self.quadratic_step(rows, expansion, &at, &x, &radii, &scaled)
            else {
                return;
            };
            let moved: Vec<f64> = (0..n)
                .map(|d| (at[d] + step[d] * radii[d]).clamp(x[d].low(), x[d].high()))
                .collect();
            let still = moved == at;
            (weights, at) = (next, moved);
            let Some(over) = self.bounder.hessian(rows, &weights, &x) else {
                return;
            };
            hessian = over;
            if promised >= target {
                let curvature =
                    max_curvature(&hessian, &x, CURVATURE_SLACK * target.abs().max(1.0));
                for p in [&at, &examined.middle] {
                    let tangent = Tangent {
                        at: p.clone(),
                        curvature,
                    };
                    let bound = self
                        .bounder
                        .second_order(rows, &weights, &x, &hessian, &tangent);
                    if bound > examined.bound {
                        examined.bound = bound;
                        examined.weights = Weights {
                            rows: weights.clone(),
                            tangent: Some(tangent),
                            is_cleared: false,
                        };
                    }
                    if examined.bound >= target {
                        return;
                    }
                }
            }
            if still {
                return;
            }
        }
    }

    /// The multipliers and the step (in half sides) of the model with this curvature at a point, and the level that
    /// it promises.
    #[allow(clippy::type_complexity, reason = "the three answers of one model")]
    fn quadratic_step(
        &mut self,
        rows: &Rows,
        expansion: &Expansion,
        at: &[f64],
        x: &[Interval],
        radii: &[f64],
        scaled: &[f64],
    ) -> Option<(Multipliers, Vec<f64>, f64)> {
        let n = at.len();
        let point: Vec<Interval> = at.iter().map(|p| Interval::point(*p)).collect();
        self.at.forward(&rows.tape, &point, &rows.needed);
        let mut gradient = vec![Interval::ZERO; n];
        let kinds = &expansion.kinds;
        let (mut gradients, mut offsets) = (Vec::new(), Vec::new());
        for own in &expansion.rows {
            let (terms, needed) = (rows.terms(own), rows.needed_by(own));
            offsets.push(self.at.sum(&rows.tape, &needed, &terms).middle());
            // the rows of an expansion are continuous over the whole box
            self.at.gradient(&rows.tape, &needed, &terms, &mut gradient);
            gradients.extend(gradient.iter().zip(radii).map(|(g, r)| g.middle() * r));
        }
        let size = scaled.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
        let side = |end: fn(Interval) -> f64| -> Vec<f64> {
            (0..n)
                .map(|d| {
                    if radii[d] > 0.0 {
                        (end(x[d]) - at[d]) / radii[d]
                    } else {
                        0.0
                    }
                })
                .collect()
        };
        let (lower, upper) = (side(Interval::low), side(Interval::high));
        let size = gradients.iter().fold(size, |m, g| m.max(g.abs()));
        let mut shift = MIN_SHIFT * size.max(f64::MIN_POSITIVE);
        for _ in 0..MAX_SHIFTS {
            let mut curvature = scaled.to_vec();
            for d in 0..n {
                curvature[d * n + d] += shift;
            }
            let model = LinearModel {
                kinds,
                gradients: &gradients,
                offsets: &offsets,
                curvature: Some(&curvature),
                lower: &lower,
                upper: &upper,
            };
            let solved = model.solve();
            let Some((multipliers, step)) = solved.filter(|(_, s)| s.iter().all(|s| s.is_finite()))
            else {
                shift *= SHIFT_FACTOR;
                continue;
            };
            let mut promised = 0.0;
            let mut weights = Vec::new();
            for (at, &multiplier) in multipliers.iter().enumerate() {
                let multiplier = allowed(kinds[at], multiplier);
                if multiplier == 0.0 || !multiplier.is_finite() {
                    continue;
                }
                expansion.add(&mut weights, at, multiplier);
                let change: f64 = gradients[at * n..(at + 1) * n]
                    .iter()
                    .zip(&step)
                    .map(|(g, d)| g * d)
                    .sum();
                promised += multiplier * (offsets[at] + change);
            }
            for i in 0..n {
                for j in 0..n {
                    promised += 0.5 * scaled[i * n + j] * step[i] * step[j];
                }
            }
            return Some((weights, step, promised));
        }
        None
    }
}

/// The middle of a Hessian in half sides, as a full matrix.
fn scaled_middle(hessian: &[Interval], radii: &[f64]) -> Vec<f64> {
    let n = radii.len();
    let mut full = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let h = hessian[i * (i + 1) / 2 + j].middle() * radii[i] * radii[j];
            full[i * n + j] = h;
            full[j * n + i] = h;
        }
    }
    full
}

/// A curvature μ ≤ 0 that is proved for the box and nearly the greatest. Below `slack` it costs nothing that counts.
pub(super) fn max_curvature(hessian: &[Interval], x: &[Interval], slack: f64) -> f64 {
    let full = scaled_middle(
        hessian,
        &x.iter().map(|x| 0.5 * x.width()).collect::<Vec<_>>(),
    );
    let size = full.iter().fold(0.0_f64, |m, h| m.max(h.abs()));
    let mut low = -slack;
    while !exceeds_curvature(hessian, x, low) {
        if !(-low < 1e3 * size * x.len() as f64) {
            return low;
        }
        low *= 8.0;
    }
    if low == -slack {
        return low;
    }
    let mut high = low / 8.0;
    for _ in 0..CURVATURE_STEPS {
        let middle = -(low * high).sqrt();
        if exceeds_curvature(hessian, x, middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    // a checker with other widths of the same enclosures proves a little less
    low * (1.0 + 1e-6)
}

#[cfg(test)]
#[path = "tangent_tests.rs"]
mod tests;
