//! One box: bounded, trimmed where that can be proved, and divided.

use grouser_real::Interval;

use super::bound::{Bounder, Multipliers, Weights};
use super::expansion::Expansion;
use super::propagate::Propagator;
use super::rows::Rows;
use super::trim::Trim;
use crate::sqp::{LinearKind, LinearModel};
use crate::tape::Enclosures;

/// A box that lost less than this share of its volume is divided rather than examined again.
const MIN_VOLUME_LOSS: f64 = 0.3;
/// How often a box is examined at most before it is divided.
const MAX_PASSES: usize = 6;
/// A box is divided here: off the middle, so that optima at round numbers do not lie on the faces of many boxes.
const DIVISION_SHARE: f64 = 0.487;
/// What an objective without a multiplier counts beside the others in the choice of the side to divide.
const IDLE_SHARE: f64 = 0.05;

/// What becomes of the rest.
#[derive(Clone, Debug)]
pub(super) enum End {
    /// No better point is in it.
    Closed,
    /// It is divided here.
    Divided { variable: usize, at: f64 },
    /// It cannot be divided further.
    Stuck,
}

/// A box after its examination.
#[derive(Clone, Debug)]
pub(super) struct Examined {
    pub(super) trims: Vec<Trim>,
    /// What is left after the trims.
    pub(super) rest: Vec<Interval>,
    pub(super) end: End,
    /// The bound of the rest, with its certificate.
    pub(super) bound: f64,
    pub(super) weights: Weights,
    /// A point that may be better than the best: the middle of a box.
    pub(super) middle: Vec<f64>,
    /// γ there; ∞ where a row is not met.
    pub(super) middle_level: f64,
    /// Was a bound of second order tried?
    pub(super) tried_second_order: bool,
}

/// What a box is examined for: points with γ < `target` that violate no row by more than `tolerance`.
pub(super) struct Aim<'a> {
    pub(super) target: f64,
    pub(super) tolerance: f64,
    /// The best point so far.
    pub(super) best: Option<&'a [f64]>,
}

/// Memory for the examination of boxes, one per thread.
#[derive(Default)]
pub(super) struct Examiner {
    pub(super) bounder: Bounder,
    pub(super) propagator: Propagator,
    pub(super) over: Enclosures,
    pub(super) at: Enclosures,
}

impl Examiner {
    /// Examines a box for points that are better than `aim`; with bounds of second order where `second_order` is set, and
    /// without divisors where they may vanish.
    pub(super) fn examine(
        &mut self,
        rows: &Rows,
        cleared: Option<&Rows>,
        x: &[Interval],
        aim: &Aim<'_>,
        second_order: bool,
    ) -> Examined {
        let Some(cleared) = cleared.filter(|_| aim.target < f64::INFINITY) else {
            return self.examine_rows(rows, x, aim, second_order);
        };
        let mut examined = self.examine_rows(rows, x, aim, false);
        if matches!(examined.end, End::Closed) {
            return examined;
        }
        let with_level = |x: &[Interval]| [x, &[Interval::point(aim.target)]].concat();
        let best = aim.best.map(|best| [best, &[aim.target]].concat());
        let beyond = Aim {
            target: f64::MIN_POSITIVE,
            tolerance: aim.tolerance,
            best: best.as_deref(),
        };
        let again = self.examine_rows(cleared, &with_level(&examined.rest), &beyond, second_order);
        let flagged = |weights: Weights| Weights {
            is_cleared: true,
            ..weights
        };
        examined.rest = again.rest[..x.len()].to_vec();
        examined
            .trims
            .extend(again.trims.into_iter().map(|trim| Trim {
                bound: aim.target,
                weights: flagged(trim.weights),
                ..trim
            }));
        if matches!(again.end, End::Closed) {
            examined.bound = aim.target;
            examined.weights = flagged(again.weights);
        }
        examined.end = again.end;
        examined.tried_second_order = again.tried_second_order;
        examined
    }

    /// As [`Self::examine`], with these rows alone.
    fn examine_rows(
        &mut self,
        rows: &Rows,
        x: &[Interval],
        aim: &Aim<'_>,
        second_order: bool,
    ) -> Examined {
        let target = aim.target;
        let mut examined = Examined {
            trims: Vec::new(),
            rest: x.to_vec(),
            end: End::Stuck,
            bound: f64::NEG_INFINITY,
            weights: Weights::default(),
            middle: x.iter().map(|x| x.middle()).collect(),
            middle_level: f64::INFINITY,
            tried_second_order: false,
        };
        for pass in 0..MAX_PASSES {
            if self.bound_each_row(rows, &mut examined, target) {
                return examined;
            }
            if self.propagate(rows, &mut examined, target) >= MIN_VOLUME_LOSS
                && pass + 1 < MAX_PASSES
            {
                continue;
            }
            let expansion = self.expand(rows, &examined.rest);
            examined.middle = examined.rest.iter().map(|x| x.middle()).collect();
            let level = rows.level_of(&self.at, aim.tolerance);
            examined.middle_level = level.map_or(f64::INFINITY, |(level, _)| level);
            let scales = self.relax(rows, &expansion, &mut examined, target);
            if examined.bound >= target {
                examined.end = End::Closed;
                return examined;
            }
            let loss = self.trim(rows, &expansion, &mut examined, target);
            if loss < MIN_VOLUME_LOSS || pass + 1 == MAX_PASSES {
                if second_order {
                    examined.tried_second_order = true;
                    self.bound_by_tangents(rows, &expansion, &mut examined, aim);
                }
                if examined.bound >= target {
                    examined.end = End::Closed;
                    return examined;
                }
                examined.end = divide(rows, &expansion, &examined, &scales);
                return examined;
            }
        }
        examined
    }

    /// Bounds by each row alone; `true` where that closes the box.
    pub(super) fn bound_each_row(
        &mut self,
        rows: &Rows,
        examined: &mut Examined,
        target: f64,
    ) -> bool {
        self.over.forward(&rows.tape, &examined.rest, &rows.needed);
        if let Some(weights) = rows.nonnegative().filter(|_| target <= 0.0) {
            examined.bound = self.bounder.bound(rows, &weights, &examined.rest);
            examined.weights = weights;
        }
        for (index, row) in rows.list.iter().enumerate() {
            let value = self.over.values[row.node as usize];
            let (bound, weight) = if value.is_empty() {
                (f64::INFINITY, 1.0)
            } else {
                match row.kind {
                    LinearKind::Objective => (value.low(), 1.0),
                    _ if value.low() > 0.0 => (f64::INFINITY, 1.0),
                    LinearKind::Equal if value.high() < 0.0 => (f64::INFINITY, -1.0),
                    _ => continue,
                }
            };
            if bound > examined.bound || examined.weights.rows.is_empty() {
                examined.bound = examined.bound.max(bound);
                examined.weights = vec![(index, weight)].into();
            }
        }
        if examined.bound >= target {
            examined.end = End::Closed;
            return true;
        }
        false
    }

    /// Bounds by multipliers of the linear problem at the middle; returns how much each row counts.
    fn relax(
        &mut self,
        rows: &Rows,
        expansion: &Expansion,
        examined: &mut Examined,
        target: f64,
    ) -> Vec<f64> {
        let n = examined.rest.len();
        let radii: Vec<f64> = examined.rest.iter().map(|x| 0.5 * x.width()).collect();
        let slopes: Vec<f64> = expansion
            .gradients
            .iter()
            .enumerate()
            .map(|(at, g)| g.middle() * radii[at % n])
            .collect();
        let offsets: Vec<f64> = expansion.offsets.iter().map(|b| b.middle()).collect();
        let idle = IDLE_SHARE / expansion.rows.len().max(1) as f64;
        let mut scales = vec![idle; expansion.rows.len()];
        let model = LinearModel {
            kinds: &expansion.kinds,
            gradients: &slopes,
            offsets: &offsets,
            curvature: None,
            lower: &vec![-1.0; n],
            upper: &vec![1.0; n],
        };
        let Some((multipliers, _)) = model.solve() else {
            return scales;
        };
        let mut weights: Multipliers = Vec::new();
        let mut limits: Multipliers = Vec::new();
        for (at, &multiplier) in multipliers.iter().enumerate() {
            let multiplier = allowed(expansion.kinds[at], multiplier);
            if multiplier == 0.0 || !multiplier.is_finite() {
                continue;
            }
            scales[at] += multiplier.abs();
            expansion.add(&mut weights, at, multiplier);
            if expansion.kinds[at] != LinearKind::Objective {
                expansion.add(&mut limits, at, multiplier);
            }
        }
        for candidate in [weights, limits] {
            if candidate.is_empty() || examined.bound >= target {
                continue;
            }
            let candidate = Weights::from(candidate);
            let bound = self.bounder.bound(rows, &candidate, &examined.rest);
            if bound > examined.bound {
                examined.bound = bound;
                examined.weights = candidate;
            }
        }
        scales
    }
}

/// A multiplier with the sign that its row allows.
pub(super) fn allowed(kind: LinearKind, multiplier: f64) -> f64 {
    if kind == LinearKind::Equal {
        multiplier
    } else {
        multiplier.max(0.0)
    }
}

/// The side whose division promises most: the one along which the rows that count vary most.
fn divide(rows: &Rows, expansion: &Expansion, examined: &Examined, scales: &[f64]) -> End {
    let n = examined.rest.len();
    let relative = |d: usize| examined.rest[d].width() / (rows.upper[d] - rows.lower[d]);
    let variation = |d: usize| -> f64 {
        let width = examined.rest[d].width();
        expansion
            .rows
            .iter()
            .enumerate()
            .map(|(at, _)| scales[at] * expansion.gradients[at * n + d].magnitude() * width)
            .sum()
    };
    let splits = |d: usize| {
        let side = examined.rest[d];
        let at = side.low() + DIVISION_SHARE * (side.high() - side.low());
        (side.low() < at && at.is_finite()).then_some(at)
    };
    let score = |d: usize| {
        let v = variation(d);
        if expansion.rows.is_empty() || !v.is_finite() {
            relative(d)
        } else {
            v
        }
    };
    let mut best: Option<(f64, usize, f64)> = None;
    for d in 0..n {
        let Some(at) = splits(d) else { continue };
        let own = score(d);
        if best.is_none_or(|(old, ..)| own > old) {
            best = Some((own, d, at));
        }
    }
    best.map_or(End::Stuck, |(_, variable, at)| End::Divided {
        variable,
        at,
    })
}

#[cfg(test)]
#[path = "process_tests.rs"]
pub(super) mod tests;
