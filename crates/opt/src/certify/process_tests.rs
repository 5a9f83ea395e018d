//! Boxes by hand: what closes them, how their rows are expanded, and where they are divided.

use super::*;
use crate::certify::bound::tests::rows;
use crate::tape::{Binary, Node, Tape, Unary};

fn over(low: f64, high: f64) -> Interval {
    Interval::new(low, high)
}

fn aim(target: f64) -> Aim<'static> {
    Aim {
        target,
        tolerance: 0.0,
        best: None,
    }
}

/// Rows over a box of two variables.
pub(crate) fn rows_over(
    x: [Interval; 2],
    kinds: &[LinearKind],
    make: impl Fn(&mut Tape, Node, Node) -> Vec<Node>,
) -> Rows {
    let mut tape = Tape::new();
    let (a, b) = (tape.variable(0), tape.variable(1));
    let nodes = make(&mut tape, a, b);
    let mut rows = rows(tape, &nodes);
    for (row, kind) in rows.list.iter_mut().zip(kinds) {
        row.kind = *kind;
    }
    rows.lower = x.iter().map(|x| x.low()).collect();
    rows.upper = x.iter().map(|x| x.high()).collect();
    rows
}

fn examine(rows: &Rows, target: f64) -> Examined {
    let sides = rows.lower.iter().zip(&rows.upper);
    let x: Vec<Interval> = sides.map(|(low, high)| over(*low, *high)).collect();
    Examiner::default().examine(rows, None, &x, &aim(target), false)
}

fn is_closed(examined: &Examined) -> bool {
    matches!(examined.end, End::Closed)
}

/// x over [1, 2] reaches 1, and no more; x and −x over [−1, 1] reach 0 together.
#[test]
fn a_box_is_closed_where_its_bound_is_the_target() {
    let x = [over(1.0, 2.0), over(0.0, 1.0)];
    let one = rows_over(x, &[], |_, x, _| vec![x, x]);
    let closed = examine(&one, 1.0);
    assert!(is_closed(&closed) && closed.bound == 1.0);
    // by the enclosure alone, of the first of equal rows
    assert_eq!(closed.middle_level, f64::INFINITY);
    assert_eq!(closed.weights.rows, [(0, 1.0)]);
    assert!(!is_closed(&examine(&one, 1.0_f64.next_up())));
    let x = [over(-1.0, 1.0), over(0.0, 1.0)];
    let both = rows_over(x, &[], |tape, x, y| {
        let fifth = tape.constant(0.2);
        vec![
            x,
            tape.unary(Unary::Neg, x),
            tape.binary(Binary::Sub, y, fifth),
        ]
    });
    let closed = examine(&both, 0.0);
    assert!(is_closed(&closed) && closed.bound == 0.0);
    // a row that does not count has no multiplier
    assert_eq!(closed.weights.rows, [(0, 0.5), (1, 0.5)]);
}

/// A limit that is above 0 everywhere, and an equality that is not 0 anywhere, exclude a box; one that is 0 at an end does not.
#[test]
fn limits_that_are_not_met_close_a_box() {
    let closed_by = |kind: LinearKind, low: f64, high: f64| {
        let x = [over(low, high), over(0.0, 1.0)];
        let kinds = [LinearKind::Objective, kind];
        let rows = rows_over(x, &kinds, |_, x, y| vec![y, x]);
        let examined = examine(&rows, f64::INFINITY);
        is_closed(&examined).then_some(examined.weights.rows)
    };
    for kind in [LinearKind::AtMost, LinearKind::Equal] {
        assert_eq!(closed_by(kind, 0.0, 1.0), None);
        assert_eq!(closed_by(kind, 1e-300, 1.0), Some(vec![(1, 1.0)]));
        assert_eq!(closed_by(kind, -1.0, 0.0), None);
    }
    let below = closed_by(LinearKind::Equal, -1.0, -1e-300);
    assert_eq!(below, Some(vec![(1, -1.0)]));
    assert_eq!(closed_by(LinearKind::AtMost, -1.0, -1e-300), None);
}

/// A number and its opposite need no look at the rows to be above 0, where that is enough.
#[test]
fn the_greater_of_opposites_is_not_negative() {
    let x = [over(-1.0, 1.0), over(0.0, 1.0)];
    let mut rows = rows_over(x, &[], |tape, x, _| {
        let pole = tape.whole_power(x, -1);
        vec![pole, tape.unary(Unary::Neg, pole)]
    });
    rows.opposites = Some((0, 1));
    for target in [-1.0, 0.0] {
        let closed = examine(&rows, target);
        assert!(is_closed(&closed) && closed.bound == 0.0);
        assert_eq!(closed.weights, vec![(0, 0.5), (1, 0.5)].into());
    }
    let open = examine(&rows, 0.125);
    assert!(open.bound == f64::NEG_INFINITY && open.weights.rows == [(0, 1.0)]);
    rows.opposites = None;
    assert_eq!(rows.nonnegative(), None);
    assert!(!is_closed(&examine(&rows, 0.0)));
}

/// Without a level that is known the rows without divisors mean nothing.
#[test]
fn no_level_no_rows_without_divisors() {
    let x = [over(-1.0, 2.0), over(0.0, 1.0)];
    let rows = rows_over(x, &[], |tape, x, y| {
        let (one, ten) = (tape.constant(1.0), tape.constant(10.0));
        let pole = tape.binary(Binary::Div, one, x);
        vec![
            pole,
            tape.unary(Unary::Neg, pole),
            tape.binary(Binary::Mul, ten, y),
        ]
    });
    let cleared = rows.cleared();
    let mut examiner = Examiner::default();
    let found = examiner.examine(&rows, cleared.as_ref(), &x, &aim(f64::INFINITY), false);
    // along y, in which 10 y varies
    assert!(matches!(found.end, End::Divided { variable: 1, .. }));
    let found = examiner.examine(&rows, cleared.as_ref(), &x, &aim(0.25), false);
    // |1/x| is nowhere below 1/4, which the rows with their divisor do not show
    assert!(is_closed(&found) && found.weights.is_cleared && found.bound == 0.25);
}

/// x ≤ y − 1/8 and y ≤ x − 1/8 exclude each other by their sum, whatever the objective is.
#[test]
fn limits_that_exclude_each_other_close_a_box() {
    let kinds = [
        LinearKind::Objective,
        LinearKind::AtMost,
        LinearKind::AtMost,
    ];
    let rows = rows_over([over(-1.0, 1.0); 2], &kinds, |tape, x, y| {
        let eighth = tape.constant(0.125);
        let apart = tape.binary(Binary::Sub, x, y);
        let back = tape.binary(Binary::Sub, y, x);
        vec![
            x,
            tape.binary(Binary::Add, apart, eighth),
            tape.binary(Binary::Add, back, eighth),
        ]
    });
    let closed = examine(&rows, f64::INFINITY);
    assert!(is_closed(&closed) && closed.bound == f64::INFINITY);
    let places: Vec<usize> = closed.weights.rows.iter().map(|(row, _)| *row).collect();
    assert_eq!(places, [1, 2]);
}

fn expand(rows: &Rows) -> Expansion {
    let sides = rows.lower.iter().zip(&rows.upper);
    let x: Vec<Interval> = sides.map(|(low, high)| over(*low, *high)).collect();
    let mut examiner = Examiner::default();
    examiner.over.forward(&rows.tape, &x, &rows.needed);
    examiner.expand(rows, &x)
}

/// Rows that cannot be the greatest, and limits that are met everywhere, do not matter.
#[test]
fn the_rows_that_matter_are_expanded() {
    use LinearKind::{AtMost, Equal, Objective};
    let kinds = [Objective, Objective, Objective, AtMost, AtMost, Equal];
    let mut rows = rows_over([over(0.0, 1.0); 2], &kinds, |tape, x, y| {
        let [zero, half, one, two] = [0.0, 0.5, 1.0, 2.0].map(|c| tape.constant(c));
        vec![
            tape.binary(Binary::Sub, x, two),
            y,
            zero,
            tape.binary(Binary::Sub, x, one),
            tape.binary(Binary::Sub, x, half),
            tape.binary(Binary::Add, y, two),
        ]
    });
    let found = expand(&rows);
    assert_eq!(found.rows, [1, 2, 4, 5].map(|row| vec![(row, 1.0)]));
    assert_eq!(found.kinds, [Objective, Objective, AtMost, Equal]);
    let (one, zero) = (Interval::ONE, Interval::ZERO);
    assert_eq!(
        found.gradients,
        [zero, one, zero, zero, one, zero, zero, one]
    );
    assert_eq!(found.offsets, [0.5, 0.0, 0.0, 2.5].map(Interval::point));
    rows.is_cleared = true;
    assert_eq!(
        expand(&rows).kinds,
        [Objective, Objective, Objective, Equal]
    );
}

/// x + 1/x and y − 1/x are bounded together, beside two objectives that are bounded anyway and a limit that is not.
#[test]
fn objectives_whose_poles_cancel_are_paired() {
    let kinds = [
        LinearKind::Objective,
        LinearKind::Objective,
        LinearKind::AtMost,
        LinearKind::Objective,
        LinearKind::Objective,
    ];
    let x = [over(-1.0, 2.0), over(0.0, 1.0)];
    let mut rows = rows_over(x, &kinds, |tape, x, y| {
        let pole = tape.whole_power(x, -1);
        vec![
            tape.binary(Binary::Add, x, pole),
            tape.binary(Binary::Sub, y, pole),
            tape.binary(Binary::Add, y, pole),
            tape.binary(Binary::Add, x, y),
            tape.binary(Binary::Sub, x, y),
        ]
    });
    let singles = [3, 4].map(|row| vec![(row, 1.0)]);
    let found = expand(&rows);
    assert_eq!(found.rows[..2], singles);
    assert_eq!(found.rows[2..], [vec![(0, 0.5), (1, 0.5)]]);
    assert_eq!(found.kinds, [LinearKind::Objective; 3]);
    assert_eq!(found.gradients[4..], [Interval::point(0.5); 2]);
    assert!((found.offsets[2].middle() - 0.5).abs() < 1e-15);
    rows.opposites = Some((0, 1));
    assert_eq!(expand(&rows).rows, singles);
}

/// Multipliers of pairs are multiples of 2⁻³⁰, so that each part of them is exact.
#[test]
fn multiples_of_rows_and_pairs_add_up() {
    let expansion = Expansion {
        rows: vec![
            vec![(0, 0.5), (1, 0.5)],
            vec![(1, 0.5), (2, 0.5)],
            vec![(2, 1.0)],
        ],
        kinds: vec![LinearKind::Objective; 3],
        gradients: Vec::new(),
        offsets: Vec::new(),
    };
    let mut sum = Multipliers::new();
    for (at, multiplier) in [(0, 0.3), (1, 0.6), (2, 0.1)] {
        expansion.add(&mut sum, at, multiplier);
    }
    let rounded = |multiplier: f64| (multiplier * f64::from(1 << 30)).round() / f64::from(1 << 30);
    let (first, second) = (rounded(0.3), rounded(0.6));
    assert!((first - 0.3).abs() < 1e-9 && first != 0.3);
    let expected = [
        (0, 0.5 * first),
        (1, 0.5 * (first + second)),
        (2, 0.5 * second + 0.1),
    ];
    assert_eq!(sum, expected);
}

#[test]
fn only_an_equality_has_a_negative_multiplier() {
    for (kind, expected) in [
        (LinearKind::Objective, 0.0),
        (LinearKind::AtMost, 0.0),
        (LinearKind::Equal, -2.0),
    ] {
        assert_eq!(allowed(kind, -2.0), expected);
        assert_eq!(allowed(kind, 2.0), 2.0);
    }
}

/// Along the side along which the rows vary most, else the longest as a share of the whole box.
#[test]
fn where_a_box_is_divided() {
    let divided = |whole: [Interval; 2], rest: [Interval; 2], gradients: &[Interval]| {
        let rows = rows_over(whole, &[], |_, x, _| vec![x]);
        let mut examined = examine(&rows, f64::INFINITY);
        examined.rest = rest.to_vec();
        let expansion = Expansion {
            rows: vec![vec![(0, 1.0)]; gradients.len() / 2],
            kinds: vec![LinearKind::Objective; gradients.len() / 2],
            gradients: gradients.to_vec(),
            offsets: Vec::new(),
        };
        match divide(&rows, &expansion, &examined, &[1.0, 0.25]) {
            End::Divided { variable, at } => Some((variable, at)),
            _ => None,
        }
    };
    let sides = [over(0.0, 4.0), over(1.0, 2.0)];
    let [first, second] = [Some((0, 0.487 * 4.0)), Some((1, 1.0 + 0.487))];
    let slopes = |slopes: &[f64]| -> Vec<Interval> {
        slopes.iter().map(|slope| Interval::point(*slope)).collect()
    };
    assert_eq!(divided(sides, sides, &slopes(&[1.0, -3.0])), first);
    assert_eq!(divided(sides, sides, &slopes(&[1.0, -5.0])), second);
    // the first of equals
    assert_eq!(divided(sides, sides, &slopes(&[1.0, 4.0])), first);
    // 4 (1 + 8/4) against 11 (1 + 0/4) and 13
    assert_eq!(
        divided(sides, sides, &slopes(&[1.0, 11.0, 8.0, 0.0])),
        first
    );
    assert_eq!(
        divided(sides, sides, &slopes(&[1.0, 13.0, 8.0, 0.0])),
        second
    );
    // 8/19 against 50/100, 4/5 against 1/10, without rows
    let (whole, rest) = (
        [over(-9.0, 10.0), over(0.0, 100.0)],
        [over(0.0, 8.0), over(0.0, 50.0)],
    );
    assert_eq!(divided(whole, rest, &[]), Some((1, 0.487 * 50.0)));
    let (whole, rest) = ([over(-1.0, 4.0), over(0.5, 10.5)], sides);
    assert_eq!(divided(whole, rest, &[]), first);
    // a slope without bounds counts as none, 4/5 against 3
    assert_eq!(
        divided(whole, rest, &[Interval::ENTIRE, Interval::point(3.0)]),
        second
    );
    // neighbours and single numbers cannot be divided
    let next = over(1.0, 1.0_f64.next_up());
    assert_eq!(
        divided(whole, [next, Interval::ONE], &slopes(&[1.0, 1.0])),
        None
    );
    assert_eq!(
        divided(whole, [next, sides[1]], &slopes(&[1.0, 0.0])),
        second
    );
}
