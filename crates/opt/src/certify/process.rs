//! One box: bounded, trimmed where that can be proved, and divided.

use grouser_real::Interval;

use super::bound::{Bounder, Multipliers, Weights};
use super::propagate::Propagator;
use super::rows::Rows;
use crate::sqp::{LinearKind, LinearModel};
use crate::tape::Enclosures;

/// A side of a box is trimmed where at least this share of it goes.
const MIN_TRIM: f64 = 0.1;
/// A box that lost less than this share of its volume is divided rather than examined again.
const MIN_VOLUME_LOSS: f64 = 0.3;
/// How often a box is examined at most before it is divided.
const MAX_PASSES: usize = 6;
/// The trimmed piece ends this share of its length before the place that the linear form gives, so that its own
/// bound, computed anew, confirms it.
const TRIM_MARGIN: f64 = 0.02;
/// A box is divided here: off the middle, so that optima at round numbers do not lie on the faces of many boxes.
const DIVISION_SHARE: f64 = 0.487;
/// So many rows with poles are looked at for pairs whose poles cancel.
const MAX_POLES: usize = 16;
/// Multipliers of such pairs are multiples of the inverse of this.
const PAIR_STEPS: f64 = 1_073_741_824.0;
/// What an objective without a multiplier counts beside the others in the choice of the side to divide.
const IDLE_SHARE: f64 = 0.05;

/// A piece without a better point, cut off the box at `at`.
#[derive(Clone, Debug)]
pub(super) struct Trim {
    pub(super) variable: usize,
    pub(super) at: f64,
    /// Is the piece above `at`?
    pub(super) above: bool,
    pub(super) bound: f64,
    pub(super) weights: Weights,
}

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
    pub(super) bent: bool,
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
    propagator: Propagator,
    over: Enclosures,
    pub(super) at: Enclosures,
}

/// The rows that matter in a box, to first order. A pair of rows stands for two of them whose poles cancel.
pub(super) struct Expansion {
    pub(super) rows: Vec<Multipliers>,
    pub(super) kinds: Vec<LinearKind>,
    /// Row-major enclosures of the gradients.
    gradients: Vec<Interval>,
    /// The rows at the middle.
    offsets: Vec<Interval>,
}

/// A linear form Σ λ row at the middle and its slopes, against what it must not exceed.
pub(super) struct Form {
    pub(super) weights: Weights,
    pub(super) offset: f64,
    pub(super) slopes: Vec<Interval>,
    pub(super) limit: f64,
}

impl Examiner {
    /// Examines a box for points that are better than `aim`; with bounds of second order where `bend` is set, and
    /// without divisors where they may vanish.
    pub(super) fn examine(
        &mut self,
        rows: &Rows,
        cleared: Option<&Rows>,
        x: &[Interval],
        aim: &Aim<'_>,
        bend: bool,
    ) -> Examined {
        let Some(cleared) = cleared.filter(|_| aim.target < f64::INFINITY) else {
            return self.examine_rows(rows, x, aim, bend);
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
        let again = self.examine_rows(cleared, &with_level(&examined.rest), &beyond, bend);
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
        examined.bent = again.bent;
        examined
    }

    /// As [`Self::examine`], with these rows alone.
    fn examine_rows(&mut self, rows: &Rows, x: &[Interval], aim: &Aim<'_>, bend: bool) -> Examined {
        let target = aim.target;
        let mut examined = Examined {
            trims: Vec::new(),
            rest: x.to_vec(),
            end: End::Stuck,
            bound: f64::NEG_INFINITY,
            weights: Weights::default(),
            middle: x.iter().map(|x| x.middle()).collect(),
            middle_level: f64::INFINITY,
            bent: false,
        };
        for pass in 0..MAX_PASSES {
            if self.naturally(rows, &mut examined, target) {
                return examined;
            }
            if self.propagate(rows, &mut examined, target) >= MIN_VOLUME_LOSS
                && pass + 1 < MAX_PASSES
            {
                continue;
            }
            let expansion = self.expand(rows, &examined.rest);
            examined.middle = examined.rest.iter().map(|x| x.middle()).collect();
            examined.middle_level = self.middle_level(rows, aim.tolerance);
            let scales = self.relax(rows, &expansion, &mut examined, target);
            if examined.bound >= target {
                examined.end = End::Closed;
                return examined;
            }
            let loss = self.trim(rows, &expansion, &mut examined, target);
            if loss < MIN_VOLUME_LOSS || pass + 1 == MAX_PASSES {
                if bend {
                    examined.bent = true;
                    self.bend(rows, &expansion, &mut examined, aim);
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
    fn naturally(&mut self, rows: &Rows, examined: &mut Examined, target: f64) -> bool {
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

    /// Cuts off what the limits of the rows, propagated to the variables, do not allow, as far as the enclosure of a row
    /// over the piece proves it; returns the share of the volume that went. Follows [`Self::naturally`].
    fn propagate(&mut self, rows: &Rows, examined: &mut Examined, target: f64) -> f64 {
        let before = examined.rest.clone();
        let left = self
            .propagator
            .shrink(rows, &self.over.values, &before, target);
        if left.iter().any(|side| side.is_empty()) {
            return 0.0;
        }
        for (variable, left) in left.iter().enumerate() {
            for above in [false, true] {
                let side = examined.rest[variable];
                let (end, at) = if above {
                    (side.high(), left.high())
                } else {
                    (side.low(), left.low())
                };
                let at = (at + TRIM_MARGIN * (end - at)).clamp(side.low(), side.high());
                if (end - at).abs() >= MIN_TRIM * side.width() {
                    self.cut_off(rows, examined, (variable, at, above), target);
                }
            }
        }
        if examined.rest != before {
            self.over.forward(&rows.tape, &examined.rest, &rows.needed);
        }
        lost_share(&examined.rest, &before)
    }

    /// Cuts a piece off where a row excludes it by its enclosure alone.
    fn cut_off(
        &mut self,
        rows: &Rows,
        examined: &mut Examined,
        (variable, at, above): (usize, f64, bool),
        target: f64,
    ) {
        let side = examined.rest[variable];
        if !(side.low() < at && at < side.high()) {
            return;
        }
        let (below_at, above_at) = (
            Interval::new(side.low(), at),
            Interval::new(at, side.high()),
        );
        let (piece_side, rest_side) = if above {
            (above_at, below_at)
        } else {
            (below_at, above_at)
        };
        let mut piece = Examined {
            rest: examined.rest.clone(),
            trims: Vec::new(),
            bound: f64::NEG_INFINITY,
            weights: Weights::default(),
            middle: Vec::new(),
            end: End::Stuck,
            middle_level: f64::INFINITY,
            bent: false,
        };
        piece.rest[variable] = piece_side;
        if self.naturally(rows, &mut piece, target) {
            examined.rest[variable] = rest_side;
            examined.trims.push(Trim {
                variable,
                at,
                above,
                bound: piece.bound,
                weights: piece.weights,
            });
        }
    }

    /// The rows that matter, with gradients over the box and values at its middle.
    fn expand(&mut self, rows: &Rows, x: &[Interval]) -> Expansion {
        let value = |over: &Enclosures, index: usize| over.values[rows.list[index].node as usize];
        let highest_low = (0..rows.list.len())
            .filter(|r| rows.list[*r].kind == LinearKind::Objective)
            .map(|r| value(&self.over, r).low())
            .fold(f64::NEG_INFINITY, f64::max);
        let mut expansion = Expansion {
            rows: Vec::new(),
            kinds: Vec::new(),
            gradients: Vec::new(),
            offsets: Vec::new(),
        };
        let middle: Vec<Interval> = x.iter().map(|x| Interval::point(x.middle())).collect();
        self.at.forward(&rows.tape, &middle, &rows.needed);
        let mut gradient = vec![Interval::ZERO; x.len()];
        let mut irregular: Multipliers = Vec::new();
        for (index, row) in rows.list.iter().enumerate() {
            let over = value(&self.over, index);
            let matters = match row.kind {
                LinearKind::Objective => over.high() >= highest_low,
                LinearKind::AtMost => over.high() > 0.0,
                LinearKind::Equal => true,
            };
            let offset = value(&self.at, index);
            if !matters {
                continue;
            }
            let term = [(row.node, 1.0)];
            let regular = self
                .over
                .gradient(&rows.tape, &row.needed, &term, &mut gradient);
            // the rows without divisors do better where there are opposites
            if !regular && row.kind == LinearKind::Objective && rows.opposites.is_none() {
                irregular.push((index, 0.5));
            }
            if regular && gradient.iter().all(|g| g.is_bounded()) && offset.is_bounded() {
                expansion.rows.push(vec![(index, 1.0)]);
                // the greatest of the rows without divisors is to be above 0
                let is_limit = rows.is_cleared && row.kind == LinearKind::AtMost;
                expansion.kinds.push(if is_limit {
                    LinearKind::Objective
                } else {
                    row.kind
                });
                expansion.gradients.extend(&gradient);
                expansion.offsets.push(offset);
            }
        }
        for (at, &first) in irregular.iter().enumerate().take(MAX_POLES) {
            for &second in irregular[at + 1..].iter().take(MAX_POLES) {
                let pair = vec![first, second];
                let (terms, needed) = (rows.terms(&pair), rows.needed_by(&pair));
                let regular = self
                    .over
                    .gradient(&rows.tape, &needed, &terms, &mut gradient);
                let offset = self.at.sum(&rows.tape, &needed, &terms);
                if regular && gradient.iter().all(|g| g.is_bounded()) && offset.is_bounded() {
                    expansion.rows.push(pair);
                    expansion.kinds.push(LinearKind::Objective);
                    expansion.gradients.extend(&gradient);
                    expansion.offsets.push(offset);
                }
            }
        }
        expansion
    }

    /// γ at the middle, where every row is met to the tolerance.
    fn middle_level(&self, rows: &Rows, tolerance: f64) -> f64 {
        let mut level = f64::NEG_INFINITY;
        for row in &rows.list {
            let value = self.at.values[row.node as usize];
            let met = match row.kind {
                LinearKind::Objective => {
                    level = level.max(value.high());
                    !value.is_empty()
                }
                LinearKind::AtMost => value.high() <= tolerance,
                LinearKind::Equal => value.magnitude() <= tolerance,
            };
            if !met {
                return f64::INFINITY;
            }
        }
        level
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

    /// Cuts pieces off the box that hold no better point; returns the share of the volume that went.
    fn trim(
        &mut self,
        rows: &Rows,
        expansion: &Expansion,
        examined: &mut Examined,
        target: f64,
    ) -> f64 {
        let before = examined.rest.clone();
        let mut forms = forms(expansion, target);
        if target < f64::INFINITY
            && examined.weights.rows.len() > 1
            && examined.weights.tangent.is_none()
        {
            forms.extend(self.bounder.form(rows, &examined.weights, &before, target));
        }
        for variable in 0..before.len() {
            for above in [false, true] {
                let side = examined.rest[variable];
                // the deepest cut that a form promises
                let mut deepest: Option<(f64, &Form)> = None;
                for form in &forms {
                    let Some(at) = cut(form, &before, variable, above) else {
                        continue;
                    };
                    let deeper =
                        deepest.is_none_or(|(old, _)| if above { at < old } else { at > old });
                    if deeper {
                        deepest = Some((at, form));
                    }
                }
                let Some((at, form)) = deepest else {
                    continue;
                };
                let end = if above { side.high() } else { side.low() };
                let at = (at + TRIM_MARGIN * (end - at)).clamp(side.low(), side.high());
                if !((end - at).abs() >= MIN_TRIM * side.width())
                    || at <= side.low()
                    || at >= side.high()
                {
                    continue;
                }
                let mut piece = examined.rest.clone();
                piece[variable] = if above {
                    Interval::new(at, side.high())
                } else {
                    Interval::new(side.low(), at)
                };
                let bound = self.bounder.bound(rows, &form.weights, &piece);
                if bound >= target {
                    examined.rest[variable] = if above {
                        Interval::new(side.low(), at)
                    } else {
                        Interval::new(at, side.high())
                    };
                    examined.trims.push(Trim {
                        variable,
                        at,
                        above,
                        bound,
                        weights: form.weights.clone(),
                    });
                }
            }
        }
        lost_share(&examined.rest, &before)
    }
}

/// The share of a box's volume that is not in its part.
fn lost_share(part: &[Interval], whole: &[Interval]) -> f64 {
    let share = |(part, whole): (&Interval, &Interval)| {
        if whole.width() > 0.0 {
            part.width() / whole.width()
        } else {
            1.0
        }
    };
    1.0 - part.iter().zip(whole).map(share).product::<f64>()
}

/// A multiplier with the sign that its row allows.
pub(super) fn allowed(kind: LinearKind, multiplier: f64) -> f64 {
    if kind == LinearKind::Equal {
        multiplier
    } else {
        multiplier.max(0.0)
    }
}

impl Expansion {
    /// Adds a multiple of row or pair `at` to a weighted sum.
    pub(super) fn add(&self, sum: &mut Multipliers, at: usize, multiplier: f64) {
        let multiplier = if let [(row, weight)] = self.rows[at][..] {
            debug_assert!(weight == 1.0, "row {row}");
            multiplier
        } else {
            // so that the poles of several pairs cancel without rounding
            (multiplier * PAIR_STEPS).round() / PAIR_STEPS
        };
        for &(row, weight) in &self.rows[at] {
            match sum.iter_mut().find(|(other, _)| *other == row) {
                Some((_, sum)) => *sum += weight * multiplier,
                None => sum.push((row, weight * multiplier)),
            }
        }
    }
}

/// The linear forms of each row alone that may trim a box.
fn forms(expansion: &Expansion, target: f64) -> Vec<Form> {
    let n = expansion.gradients.len() / expansion.rows.len().max(1);
    let slopes = |at: usize| &expansion.gradients[at * n..(at + 1) * n];
    let mut list = Vec::new();
    for (at, row) in expansion.rows.iter().enumerate() {
        let own = slopes(at);
        let mut push = |sign: f64, limit: f64| {
            let (offset, slopes) = if sign < 0.0 {
                (
                    -expansion.offsets[at].high(),
                    own.iter().map(|g| -*g).collect(),
                )
            } else {
                (expansion.offsets[at].low(), own.to_vec())
            };
            list.push(Form {
                weights: row
                    .iter()
                    .map(|(row, weight)| (*row, sign * weight))
                    .collect::<Multipliers>()
                    .into(),
                offset,
                slopes,
                limit,
            });
        };
        match expansion.kinds[at] {
            LinearKind::Objective if target < f64::INFINITY => push(1.0, target),
            LinearKind::Objective => {}
            LinearKind::AtMost => push(1.0, 0.0),
            LinearKind::Equal => {
                push(1.0, 0.0);
                push(-1.0, 0.0);
            }
        }
    }
    list
}

/// Where the form exceeds its limit beyond: the place, if the form's slope along `variable` has one sign.
fn cut(form: &Form, x: &[Interval], variable: usize, above: bool) -> Option<f64> {
    let slope = form.slopes[variable];
    // above a place the form must grow, below it must fall
    let steepness = if above { slope.low() } else { -slope.high() };
    if !(steepness > 0.0) {
        return None;
    }
    let least = |d: usize| {
        let radius = 0.5 * x[d].width();
        let (low, high) = (form.slopes[d].low(), form.slopes[d].high());
        -(low.abs().max(high.abs()) * radius)
    };
    let others: f64 = (0..x.len()).filter(|d| *d != variable).map(least).sum();
    let room = form.limit - form.offset - others;
    let middle = x[variable].middle();
    let reach = room
        / if room > 0.0 {
            steepness
        } else {
            slope.magnitude()
        };
    let at = if above {
        middle + reach
    } else {
        middle - reach
    };
    at.is_finite().then_some(at)
}

/// The side whose division promises most: the one along which the rows that count vary most.
fn divide(rows: &Rows, expansion: &Expansion, examined: &Examined, scales: &[f64]) -> End {
    let n = examined.rest.len();
    let relative = |d: usize| {
        let range = rows.upper[d] - rows.lower[d];
        if range > 0.0 {
            examined.rest[d].width() / range
        } else {
            0.0
        }
    };
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
        (side.low() < at && at < side.high()).then_some(at)
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
