//! What is left of operations and boxes, by hand, and that no point is lost.

use super::*;
use crate::certify::bound::tests::{VARIABLES, expression, rows};
use crate::random::Random;
use crate::tape::{Enclosures, Tape};

fn left(rows: &Rows, x: &[Interval], target: f64) -> Vec<Interval> {
    let mut over = Enclosures::default();
    over.forward(&rows.tape, x, &rows.needed);
    Propagator::default().shrink(rows, &over.values, x, target)
}

/// exp(x² + 4 y²) ≤ e⁴ leaves |x| ≤ 2 and |y| ≤ 1.
#[test]
fn the_limit_of_a_row_reaches_the_variables() {
    let mut tape = Tape::new();
    let (x, y) = (tape.variable(0), tape.variable(1));
    let (x, y) = (tape.whole_power(x, 2), tape.whole_power(y, 2));
    let four = tape.constant(4.0);
    let y = tape.binary(Binary::Mul, four, y);
    let sum = tape.binary(Binary::Add, x, y);
    let node = tape.unary(Unary::Exp, sum);
    let rows = rows(tape, &[node]);
    let sides = left(&rows, &[Interval::new(-9.0, 9.0); 2], 4.0_f64.exp());
    for (side, radius) in sides.iter().zip([2.0, 1.0]) {
        assert!((side.high() - radius).abs() < 1e-9 && (side.low() + radius).abs() < 1e-9);
    }
}

#[test]
fn no_point_that_meets_the_rows_is_lost() {
    let mut random = Random::new(2012);
    let (mut points, mut shrunk) = (0, 0);
    while points < 20_000 {
        let mut tape = Tape::new();
        let nodes = [3, 2].map(|depth| expression(&mut tape, &mut random, depth));
        let rows = rows(tape, &nodes);
        let target = 6.0 * random.uniform() - 3.0;
        let x: Vec<Interval> = (0..VARIABLES)
            .map(|_| {
                let low = 4.0 * random.uniform() - 3.0;
                Interval::new(low, low + 4.0 * random.uniform())
            })
            .collect();
        let sides = left(&rows, &x, target);
        shrunk += usize::from(
            sides
                .iter()
                .zip(&x)
                .any(|(s, x)| s.width() < 0.9 * x.width()),
        );
        for _ in 0..20 {
            let at: Vec<f64> = x
                .iter()
                .map(|x| (x.low() + x.width() * random.uniform()).min(x.high()))
                .collect();
            let point: Vec<Interval> = at.iter().map(|x| Interval::point(*x)).collect();
            let meets = |node: &Node| rows.tape.enclose(&point, *node).high() <= target;
            if nodes.iter().all(meets) {
                points += 1;
                let slack = |side: &Interval| 1e-9 * (1.0 + side.magnitude());
                let is_left = |(x, side): (&f64, &Interval)| {
                    side.low() - slack(side) <= *x && *x <= side.high() + slack(side)
                };
                assert!(
                    at.iter().zip(&sides).all(is_left),
                    "{at:?} is not in {sides:?}"
                );
            }
        }
    }
    assert!(shrunk > 500, "{shrunk}");
}

fn over(low: f64, high: f64) -> Interval {
    Interval::new(low, high)
}

fn assert_near(found: Interval, (low, high): (f64, f64)) {
    let is_near = |found: f64, end: f64| found == end || (found - end).abs() < 1e-12;
    assert!(
        is_near(found.low(), low) && is_near(found.high(), high),
        "{found:?} {low} {high}"
    );
}

const ALL: (f64, f64) = (-f64::INFINITY, f64::INFINITY);

#[test]
fn arguments_of_values() {
    let (e, pi) = (std::f64::consts::E, std::f64::consts::PI);
    for (function, value, x, expected) in [
        (Unary::Neg, (1.0, 2.0), ALL, (-2.0, -1.0)),
        (Unary::Abs, (1.0, 2.0), (0.0, 9.0), (1.0, 2.0)),
        (Unary::Abs, (1.0, 2.0), (-1.0, 9.0), (-2.0, 2.0)),
        (Unary::Sqrt, (-1.0, 2.0), ALL, (0.0, 4.0)),
        (Unary::Sqrt, (1.0, 2.0), ALL, (1.0, 4.0)),
        (Unary::Exp, (1.0, e), ALL, (0.0, 1.0)),
        (Unary::ExpM1, (0.0, e - 1.0), ALL, (0.0, 1.0)),
        (Unary::Ln, (0.0, 1.0), ALL, (1.0, e)),
        (Unary::Ln1p, (0.0, 1.0), ALL, (0.0, e - 1.0)),
        (Unary::Log10, (0.0, 1.0), ALL, (1.0, 10.0)),
        (Unary::Asin, (-pi / 2.0, 0.0), ALL, (-1.0, 0.0)),
        (Unary::Acos, (0.0, pi / 3.0), ALL, (0.5, 1.0)),
        (Unary::Atan, (0.0, pi / 4.0), ALL, (0.0, 1.0)),
    ] {
        let kept = inverse(function, over(value.0, value.1), over(x.0, x.1));
        assert_near(kept.unwrap(), expected);
    }
    for (function, value) in [(Unary::Atan, (1.0, 2.0)), (Unary::Sin, (0.0, 0.5))] {
        assert_eq!(
            inverse(function, over(value.0, value.1), Interval::ENTIRE),
            None
        );
    }
}

#[test]
fn roots_of_values() {
    for (n, value, x, expected) in [
        (1, (-8.0, 27.0), ALL, (-8.0, 27.0)),
        (3, (-8.0, 27.0), ALL, (-2.0, 3.0)),
        (2, (4.0, 9.0), (0.0, 9.0), (2.0, 3.0)),
        (2, (4.0, 9.0), (-9.0, 0.0), (-3.0, -2.0)),
        (2, (4.0, 9.0), (-9.0, 9.0), (-3.0, 3.0)),
        (4, (-16.0, 81.0), (0.0, 9.0), (0.0, 3.0)),
    ] {
        let kept = root(over(value.0, value.1), over(x.0, x.1), n).unwrap();
        assert_near(kept, expected);
        // rounded outwards
        assert!(over(expected.0, expected.1).is_inside(kept));
    }
    assert_eq!(root(over(1.0, 2.0), Interval::ENTIRE, 0), None);
    assert_eq!(root(over(1.0, 2.0), Interval::ENTIRE, -1), None);
}

#[test]
fn operands_of_values() {
    let entire = ALL;
    for (function, value, x, y, of_x, of_y) in [
        (
            Binary::Add,
            (5.0, 6.0),
            (1.0, 2.0),
            (3.0, 3.5),
            (1.5, 3.0),
            (3.0, 5.0),
        ),
        (
            Binary::Sub,
            (-1.0, 0.5),
            (1.0, 2.0),
            (3.0, 4.0),
            (2.0, 4.5),
            (0.5, 3.0),
        ),
        (
            Binary::Mul,
            (6.0, 12.0),
            (1.0, 2.0),
            (3.0, 4.0),
            (1.5, 4.0),
            (3.0, 12.0),
        ),
        (
            Binary::Div,
            (2.0, 3.0),
            (6.0, 12.0),
            (3.0, 4.0),
            (6.0, 12.0),
            (2.0, 6.0),
        ),
        (
            Binary::Max,
            (2.0, 3.0),
            (1.0, 9.0),
            (2.0, 8.0),
            (-f64::INFINITY, 3.0),
            (-f64::INFINITY, 3.0),
        ),
        (
            Binary::Min,
            (2.0, 3.0),
            (1.0, 9.0),
            (2.0, 8.0),
            (2.0, f64::INFINITY),
            (2.0, f64::INFINITY),
        ),
        (
            Binary::Power,
            (-4.0, 9.0),
            (0.0, 9.0),
            (2.0, 2.0),
            (0.0, 3.0),
            entire,
        ),
        (
            Binary::Power,
            (4.0, 9.0),
            (1.0, 9.0),
            (-0.5, -0.5),
            (1.0 / 81.0, 1.0 / 16.0),
            entire,
        ),
    ] {
        let [value, x, y] = [value, x, y].map(|(low, high)| over(low, high));
        let (kept_x, kept_y) = inverses(function, value, x, y).unwrap();
        assert_near(kept_x, of_x);
        assert_near(kept_y, of_y);
    }
    // powers of what may be negative, by what is no number, and by 0
    let is_known =
        |x: Interval, y: Interval| inverses(Binary::Power, over(1.0, 2.0), x, y).is_some();
    assert!(!is_known(over(-1.0, 9.0), Interval::point(2.0)));
    assert!(!is_known(over(0.0, 9.0), over(2.0, 2.5)));
    assert!(!is_known(over(0.0, 9.0), Interval::ZERO));
}

#[test]
fn quotients_by_what_may_be_0() {
    let ways = |a: (f64, f64), b: (f64, f64), known: (f64, f64)| {
        let found = ratio(over(a.0, a.1), over(b.0, b.1), over(known.0, known.1));
        (found.low(), found.high())
    };
    // at least 2/2 in size
    let (above, below) = ((1.0, f64::INFINITY), (-f64::INFINITY, -1.0));
    let (up, down) = ((2.0, 4.0), (-4.0, -2.0));
    assert_eq!(ways(up, (-1.0, 2.0), ALL), ALL);
    assert_eq!(ways(down, (-1.0, 2.0), ALL), ALL);
    for (a, b, expected) in [
        (up, (0.0, 2.0), above),
        (up, (-2.0, 0.0), below),
        (down, (0.0, 2.0), below),
        (down, (-2.0, 0.0), above),
    ] {
        assert_eq!(ways(a, b, ALL), expected);
        // as far as it is known to be that great
        let is_above = expected == above;
        let (touches, misses) = if is_above {
            ((0.0, 1.0), (0.0, 0.875))
        } else {
            ((-1.0, 0.0), (-0.875, 0.0))
        };
        assert_eq!(ways(a, b, touches), expected);
        assert!(ratio(over(a.0, a.1), over(b.0, b.1), over(misses.0, misses.1)).is_empty());
    }
    assert_eq!(ways(up, (-1.0, 2.0), (0.0, 5.0)), above);
    assert_eq!(ways(up, (-2.0, 1.0), (-5.0, 0.0)), below);
    // 0 by 0 is anything, and elsewhere it is a quotient
    assert_eq!(ways((0.0, 4.0), (-1.0, 2.0), (0.0, 1.0)), ALL);
    assert_near(
        ratio(over(0.0, 4.0), over(1.0, 2.0), Interval::ENTIRE),
        (0.0, 4.0),
    );
}

/// x − 1 below a level of 2, at most 0, and 0.
#[test]
fn what_each_kind_of_row_leaves() {
    let side = |kind: LinearKind| {
        let mut tape = Tape::new();
        let (x, one) = (tape.variable(0), tape.constant(1.0));
        let node = tape.binary(Binary::Sub, x, one);
        let mut rows = rows(tape, &[node]);
        rows.list[0].kind = kind;
        left(&rows, &[over(-9.0, 9.0)], 2.0)[0]
    };
    assert_near(side(LinearKind::Objective), (-9.0, 3.0));
    assert_near(side(LinearKind::AtMost), (-9.0, 1.0));
    assert_near(side(LinearKind::Equal), (1.0, 1.0));
}
