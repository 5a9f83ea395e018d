//! The proof that the forces of a certificate are those of the laws: what the rule of integration leaves out is bounded
//! over the whole box of a problem.

use grouser_opt::{Node, Tape};
use grouser_real::Interval;

use crate::certificate::{MAX_ENTRY_RAD, MIN_ENTRY_RAD};
use crate::design::Design;
use crate::quantity::{CONTACT_VARIABLES, QUADRATURE_REMAINDER_SHARE, RuleError, log_width, rule};
use crate::scope::Carried;

/// More parts than this are not examined for one soil.
const MAX_PARTS: usize = 5000;

/// What the spread of the vertical force weighs beside that of the shape where a side to divide is chosen: enough that a wheel's
/// width is divided where only the load excludes a part. It changes how many parts there are, not what is proved.
const FORCE_SPREAD_WEIGHT: f64 = 0.5;
/// A spread counts as at most this.
const MAX_SPREAD: f64 = 20.0;

/// What the rule of integration in a certificate may leave out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ForceRemainder {
    /// As a share of each force.
    pub share: f64,
    /// Is that proved over the whole box? Else it is measured against the kernel.
    pub is_proved: bool,
    /// Parts of the box that the proof examined.
    pub parts: usize,
}

impl Design {
    /// What the rule of integration in a certificate may leave out, and whether that is proved. `None` where no wheel
    /// carries a load.
    ///
    /// The box of the variables and the entry angle is divided until in every part the error of the rule is within the share, a
    /// constraint is violated, or no contact carries the load. With rebound the share is measured and not proved.
    ///
    /// ```
    /// let design = grouser_design::read("../../examples/problems/running-slip.toml".as_ref())?;
    /// let remainder = design.force_remainder().expect("a wheel under a load");
    /// assert!(remainder.share == 1e-8 && remainder.is_proved);
    /// # Ok::<(), grouser_design::Error>(())
    /// ```
    #[must_use]
    pub fn force_remainder(&self) -> Option<ForceRemainder> {
        if !self.has_loaded_wheels() {
            return None;
        }
        let mut remainder = ForceRemainder {
            share: QUADRATURE_REMAINDER_SHARE,
            is_proved: true,
            parts: 0,
        };
        let n = self.variables.len();
        let program = &self.program;
        for world in &self.worlds {
            let mut tape = Tape::new();
            let quantities = &program.quantities;
            let (numbers, carried) =
                program
                    .scope
                    .taped(&mut tape, &world.fixed, quantities, Some(n));
            let params = self.params();
            let rows = program.rows_on(&mut tape, &numbers).unwrap_or_default();
            let limits = rows.into_iter().skip(params.objectives.len());
            let limits: Vec<Node> = limits.take(params.inequalities.len()).collect();
            let mut all: Vec<_> = self
                .variables
                .iter()
                .map(|v| Interval::new(v.lower, v.upper))
                .collect();
            all.push(Interval::new(MIN_ENTRY_RAD, MAX_ENTRY_RAD));
            let parts = carried.and_then(|carried| parts_of_proof(&tape, &carried, &limits, all));
            remainder.is_proved &= parts.is_some();
            remainder.parts += parts.unwrap_or(0);
        }
        Some(remainder)
    }
}

/// The parts of a proof over a box whose last variable is the entry angle; `None` where there is no proof.
fn parts_of_proof(
    tape: &Tape,
    carried: &Carried,
    limits: &[Node],
    all: Vec<Interval>,
) -> Option<usize> {
    let shape = carried.shape?;
    let rule = rule();
    let mut error = RuleError::new(&rule);
    // the remainders of the integrals come after the entry angle
    let first = all.len();
    let over = |part: &[Interval], share: f64, node: Node| {
        let mut x = part.to_vec();
        let remainder = if share < 1.0 {
            Interval::new(-share, share)
        } else {
            Interval::ENTIRE
        };
        x.resize(first + CONTACT_VARIABLES - 1, remainder);
        tape.enclose(&x, node)
    };
    let shape_over = |part: &[Interval]| shape.map(|node| tape.enclose(part, node));
    // how far the shape and the force vary, as logarithms
    let spread = |part: &[Interval]| {
        let force = over(part, 0.0, carried.balance) + Interval::ONE;
        shape_over(part).spread() + FORCE_SPREAD_WEIGHT * log_width(force).min(MAX_SPREAD)
    };
    let mut open = vec![all];
    let mut parts = 0;
    while let Some(part) = open.pop() {
        parts += 1;
        if parts > MAX_PARTS {
            return None;
        }
        let bound = error.bound(&shape_over(&part));
        let is_too_heavy = bound.carried > tape.enclose(&part, carried.load).high();
        let is_bounded = bound.share <= QUADRATURE_REMAINDER_SHARE;
        let over_part = |node: &Node| over(&part, bound.share, *node);
        if is_bounded
            || is_too_heavy
            || !over_part(&carried.balance).contains(0.0)
            || limits.iter().any(|limit| over_part(limit).low() > 0.0)
        {
            continue;
        }
        let best = (0..first)
            .filter_map(|side| {
                let halves = halves(&part, side)?;
                let worst = halves.iter().map(|half| spread(half)).fold(0.0, f64::max);
                Some((worst, halves))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        open.extend(best?.1);
    }
    Some(parts)
}

/// A box divided across one side, at the geometric mean where the side is positive.
fn halves(part: &[Interval], side: usize) -> Option<[Vec<Interval>; 2]> {
    let (low, high) = (part[side].low(), part[side].high());
    let at = if low > 0.0 {
        (low * high).sqrt()
    } else {
        0.5 * (low + high)
    };
    (low < at && at < high).then(|| {
        [Interval::new(low, at), Interval::new(at, high)].map(|half| {
            let mut divided = part.to_vec();
            divided[side] = half;
            divided
        })
    })
}
