//! Pieces without better points, cut off the sides of a box.

use grouser_real::Interval;

use super::bound::{Multipliers, Weights};
use super::expansion::Expansion;
use super::process::{End, Examined, Examiner};
use super::rows::Rows;
use crate::sqp::LinearKind;

/// A side of a box is trimmed where at least this share of it goes.
const MIN_TRIM: f64 = 0.1;
/// The trimmed piece ends this share of its length before the place that the linear form gives, so that its own
/// bound, computed anew, confirms it.
const TRIM_MARGIN: f64 = 0.02;

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

/// A linear form Σ λ row at the middle and its slopes, against what it must not exceed.
pub(super) struct Form {
    pub(super) weights: Weights,
    pub(super) offset: f64,
    pub(super) slopes: Vec<Interval>,
    pub(super) limit: f64,
}

impl Examiner {
    /// Cuts off what the limits of the rows, propagated to the variables, do not allow, as far as the enclosure of a row
    /// over the piece proves it; returns the share of the volume that went. Follows [`Self::bound_each_row`].
    pub(super) fn propagate(&mut self, rows: &Rows, examined: &mut Examined, target: f64) -> f64 {
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
            tried_second_order: false,
        };
        piece.rest[variable] = piece_side;
        if self.bound_each_row(rows, &mut piece, target) {
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

    /// Cuts pieces off the box that hold no better point; returns the share of the volume that went.
    pub(super) fn trim(
        &mut self,
        rows: &Rows,
        expansion: &Expansion,
        examined: &mut Examined,
        target: f64,
    ) -> f64 {
        let before = examined.rest.clone();
        let mut forms = forms(expansion, target);
        if target < f64::INFINITY && examined.weights.rows.len() > 1 {
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

/// The linear forms of each row alone that may trim a box.
fn forms(expansion: &Expansion, target: f64) -> Vec<Form> {
    let n = expansion.gradients.len() / expansion.rows.len().max(1);
    let slopes = |at: usize| &expansion.gradients[at * n..(at + 1) * n];
    let mut list = Vec::new();
    for (at, row) in expansion.rows.iter().enumerate() {
        let own = slopes(at);
        let mut push = |limit: f64| {
            list.push(Form {
                weights: row.clone().into(),
                offset: expansion.offsets[at].low(),
                slopes: own.to_vec(),
                limit,
            });
        };
        match expansion.kinds[at] {
            LinearKind::Objective if target < f64::INFINITY => push(target),
            LinearKind::Objective => {}
            LinearKind::AtMost => push(0.0),
            LinearKind::Equal => {
                push(0.0);
                let less = row.iter().map(|(row, weight)| (*row, -weight));
                list.push(Form {
                    weights: less.collect::<Multipliers>().into(),
                    offset: -expansion.offsets[at].high(),
                    slopes: own.iter().map(|g| -*g).collect(),
                    limit: 0.0,
                });
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
    let min_share = |d: usize| {
        let radius = 0.5 * x[d].width();
        let (low, high) = (form.slopes[d].low(), form.slopes[d].high());
        -(low.abs().max(high.abs()) * radius)
    };
    let others: f64 = (0..x.len()).filter(|d| *d != variable).map(min_share).sum();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::process::Aim;
    use crate::certify::process::tests::rows_over;
    use crate::tape::{Binary, Node, Tape, Unary};

    fn form(slopes: &[(f64, f64)], offset: f64, limit: f64) -> Form {
        Form {
            weights: Weights::default(),
            offset,
            slopes: slopes
                .iter()
                .map(|(low, high)| Interval::new(*low, *high))
                .collect(),
            limit,
        }
    }

    /// 5 + 2 (x − 2) + 3 y over [0, 4] × [−1, 1] and its like, by hand.
    #[test]
    fn where_a_form_exceeds_its_limit() {
        let x = [Interval::new(0.0, 4.0), Interval::new(-1.0, 1.0)];
        let straight = |limit: f64| form(&[(2.0, 2.0), (3.0, 3.0)], 5.0, limit);
        let assert_cut = |form: &Form, variable: usize, above: bool, expected: f64| {
            let at = cut(form, &x, variable, above).unwrap();
            assert!((at - expected).abs() < 1e-14, "{at} {expected}");
        };
        // 5 + 2 (x − 2) − 3 > 6 from x = 4 on
        assert_cut(&straight(6.0), 0, true, 4.0);
        assert_eq!(cut(&straight(6.0), &x, 0, false), None);
        assert_cut(&straight(4.0), 0, true, 3.0);
        // 5 − 4 + 3 y > 3 from y = 2/3 on
        assert_cut(&straight(3.0), 1, true, 2.0 / 3.0);
        // a slope of −2 at the least: 5 + 2 (2 − x) − 3 > 4 below x = 1
        let falling = form(&[(-8.0, -2.0), (-3.0, 1.0)], 5.0, 4.0);
        assert_cut(&falling, 0, false, 1.0);
        assert_eq!(cut(&falling, &x, 0, true), None);
        // above the limit already at the middle: by the steepest slope that may be back to it
        let steep = form(&[(1.0, 2.0), (3.0, 3.0)], 5.0, 0.0);
        assert_cut(&steep, 0, true, 1.0);
        let steep = form(&[(-4.0, -1.0), (-3.0, 0.0)], 5.0, 0.0);
        assert_cut(&steep, 0, false, 2.5);
        // slopes of both signs, none, and without bounds
        assert_eq!(
            cut(&form(&[(-1.0, 1.0), (0.0, 0.0)], 5.0, 6.0), &x, 0, true),
            None
        );
        assert_eq!(
            cut(&form(&[(0.0, 1.0), (0.0, 0.0)], 5.0, 6.0), &x, 0, true),
            None
        );
        let flat = form(&[(0.0, 1.0), (0.0, 0.0)], 5.0, 0.0);
        assert_eq!(cut(&flat, &x, 0, true), None);
        let unbounded = form(&[(1.0, 1.0), (0.0, f64::INFINITY)], 5.0, 6.0);
        assert_eq!(cut(&unbounded, &x, 0, true), None);
    }

    #[test]
    fn the_share_of_a_box_that_went() {
        let whole = [
            Interval::new(0.0, 2.0),
            Interval::new(1.0, 5.0),
            Interval::ONE,
        ];
        let part = [
            Interval::new(0.5, 1.5),
            Interval::new(1.0, 4.0),
            Interval::ONE,
        ];
        assert_eq!(lost_share(&part, &whole), 0.625);
        assert_eq!(lost_share(&whole, &whole), 0.0);
    }

    /// Rows at most at a level, at most 0, and 0: which forms may trim, with which sign.
    #[test]
    fn the_forms_of_rows() {
        let one = Interval::ONE;
        let expansion = Expansion {
            rows: vec![vec![(3, 1.0)], vec![(4, 1.0)], vec![(5, 1.0)]],
            kinds: vec![LinearKind::Objective, LinearKind::AtMost, LinearKind::Equal],
            gradients: vec![
                one,
                -one,
                Interval::new(2.0, 3.0),
                one,
                Interval::new(-4.0, 5.0),
                one,
            ],
            offsets: vec![
                Interval::new(7.0, 8.0),
                Interval::new(9.0, 10.0),
                Interval::new(11.0, 12.0),
            ],
        };
        let list = |target: f64| -> Vec<_> {
            let forms = forms(&expansion, target);
            let parts = |form: Form| (form.weights.rows, form.offset, form.slopes, form.limit);
            forms.into_iter().map(parts).collect()
        };
        let at_most = (vec![(4, 1.0)], 9.0, vec![Interval::new(2.0, 3.0), one], 0.0);
        let above = (
            vec![(5, 1.0)],
            11.0,
            vec![Interval::new(-4.0, 5.0), one],
            0.0,
        );
        let below = (
            vec![(5, -1.0)],
            -12.0,
            vec![Interval::new(-5.0, 4.0), -one],
            0.0,
        );
        let objective = (vec![(3, 1.0)], 7.0, vec![one, -one], 0.5);
        let limits = [at_most, above, below];
        assert_eq!(list(f64::INFINITY), limits);
        assert_eq!(list(0.5), [&[objective][..], &limits[..]].concat());
    }

    /// The trims of a box, and what is left of it: by each row's limit, by its linear form.
    fn trimmed(
        x: Interval,
        target: f64,
        make: impl Fn(&mut Tape, Node) -> Vec<Node>,
    ) -> [(Vec<Trim>, Interval); 2] {
        let sides = [x, Interval::ONE];
        let rows = rows_over(sides, &[], |tape, x, _| make(tape, x));
        [false, true].map(|by_form| {
            let mut examiner = Examiner::default();
            let aim = Aim {
                target: f64::INFINITY,
                tolerance: 0.0,
                best: None,
            };
            let mut examined = examiner.examine(&rows, None, &sides, &aim, false);
            (examined.rest, examined.trims) = (sides.to_vec(), Vec::new());
            examiner.bound_each_row(&rows, &mut examined, target);
            if by_form {
                let expansion = examiner.expand(&rows, &sides);
                examiner.trim(&rows, &expansion, &mut examined, target);
            } else {
                examiner.propagate(&rows, &mut examined, target);
            }
            (examined.trims, examined.rest[0])
        })
    }

    /// x below 2 over [1, 5]: what is above goes but for a fiftieth; of equal rows by the first.
    #[test]
    fn what_lies_beyond_a_limit_is_cut_off() {
        let x = Interval::new(1.0, 5.0);
        for (trims, rest) in trimmed(x, 2.0, |_, x| vec![x, x]) {
            let [trim] = &trims[..] else {
                panic!("{trims:?}");
            };
            assert!((trim.at - 2.06).abs() < 1e-12 && trim.above && trim.variable == 0);
            assert_eq!(rest, Interval::new(1.0, trim.at));
            assert!((trim.bound - 2.06).abs() < 1e-12);
            assert_eq!(trim.weights.rows, [(0, 1.0)]);
        }
        // less than a tenth stays
        for (trims, rest) in trimmed(x, 4.65, |_, x| vec![x]) {
            assert!(trims.is_empty() && rest == x);
        }
        let minus = |tape: &mut Tape, x: Node| {
            let minus = tape.unary(Unary::Neg, x);
            vec![minus, minus]
        };
        for (trims, rest) in trimmed(x, -4.0, minus) {
            let [trim] = &trims[..] else {
                panic!("{trims:?}");
            };
            assert!((trim.at - 3.94).abs() < 1e-12 && !trim.above);
            assert_eq!(rest, Interval::new(trim.at, 5.0));
            assert_eq!(trim.weights.rows, [(0, 1.0)]);
        }
    }

    /// A box that goes as a whole is closed, not trimmed: a place at its end would divide nothing.
    #[test]
    fn no_box_is_trimmed_as_a_whole() {
        let x = Interval::new(2.0, 3.0);
        // x² − x over [2, 3] is at least 2, as its linear form shows, but not its enclosure of [1, 7]
        let rising = |tape: &mut Tape, x: Node| {
            let square = tape.whole_power(x, 2);
            vec![tape.binary(Binary::Sub, square, x)]
        };
        let falling = |tape: &mut Tape, x: Node| {
            let five = tape.constant(5.0);
            let back = tape.binary(Binary::Sub, five, x);
            let square = tape.whole_power(back, 2);
            vec![tape.binary(Binary::Sub, square, back)]
        };
        for found in [trimmed(x, 1.1, rising), trimmed(x, 1.1, falling)] {
            let (trims, rest) = &found[1];
            assert!(trims.is_empty() && *rest == x, "{trims:?}");
        }
        let next = Interval::new(1.0, 1.0_f64.next_up());
        for found in [
            trimmed(next, 1.0, |_, x| vec![x]),
            trimmed(next, -1.0_f64.next_up(), |tape, x| {
                vec![tape.unary(Unary::Neg, x)]
            }),
            trimmed(Interval::ONE, 0.5, |_, x| vec![x]),
        ] {
            assert!(found.iter().all(|(trims, _)| trims.is_empty()), "{found:?}");
        }
    }
}
