//! Bounds lie below the weighted sum of random rows at random points.

use grouser_real::Interval;

use super::{Bounder, Tangent};
use crate::certify::rows::{Row, Rows};
use crate::certify::tangent::max_curvature;
use crate::random::Random;
use crate::sqp::LinearKind;
use crate::tape::tests::UNARY;
use crate::tape::{Binary, Node, Tape, Unary};

const BINARY: [Binary; 7] = [
    Binary::Add,
    Binary::Sub,
    Binary::Mul,
    Binary::Div,
    Binary::Power,
    Binary::Min,
    Binary::Max,
];
pub(crate) const VARIABLES: usize = 3;

pub(crate) fn expression(tape: &mut Tape, random: &mut Random, depth: usize) -> Node {
    let kind = random.uniform();
    if depth == 0 || kind < 0.1 {
        return if random.uniform() < 0.8 {
            tape.variable(random.below(VARIABLES))
        } else {
            tape.constant(6.0 * random.uniform() - 3.0)
        };
    }
    let a = expression(tape, random, depth - 1);
    if kind < 0.45 {
        tape.unary(UNARY[random.below(UNARY.len())], a)
    } else if kind < 0.55 {
        tape.whole_power(a, [-2, -1, 0, 1, 2, 3, 4][random.below(7)])
    } else {
        let b = expression(tape, random, depth - 1);
        tape.binary(BINARY[random.below(BINARY.len())], a, b)
    }
}

pub(crate) fn rows(tape: Tape, nodes: &[Node]) -> Rows {
    let row = |node: &Node| Row {
        name: String::new(),
        kind: LinearKind::Objective,
        node: *node,
        needed: tape.needed(*node),
    };
    let list: Vec<Row> = nodes.iter().map(row).collect();
    let needed = tape.needed_by(nodes.iter().copied());
    Rows {
        tape,
        list,
        needed,
        lower: Vec::new(),
        upper: Vec::new(),
        opposites: None,
        is_cleared: false,
    }
}

/// −x² over [−1, 3] has its minimum −9 at a corner; the tangent in the middle reaches just that.
#[test]
fn a_concave_square_is_bounded_by_its_corner() {
    let mut tape = Tape::new();
    let x = tape.variable(0);
    let square = tape.whole_power(x, 2);
    let node = tape.unary(Unary::Neg, square);
    let rows = rows(tape, &[node]);
    let x = [Interval::new(-1.0, 3.0)];
    let mut bounder = Bounder::default();
    let hessian = bounder.hessian(&rows, &[(0, 1.0)], &x).unwrap();
    let curvature = max_curvature(&hessian, &x, 1e-12);
    let at = vec![1.0];
    let tangent = Tangent { at, curvature };
    let bound = bounder.second_order(&rows, &[(0, 1.0)], &x, &hessian, &tangent);
    assert!((-9.5..=-9.0).contains(&bound), "{bound}");
}

#[test]
fn no_random_value_lies_below_a_bound_of_second_order() {
    let mut random = Random::new(2012);
    let mut bounder = Bounder::default();
    let (mut bounds, mut close) = (0, 0);
    while bounds < 20_000 {
        let mut tape = Tape::new();
        let nodes = [
            expression(&mut tape, &mut random, 3),
            expression(&mut tape, &mut random, 2),
        ];
        let rows = rows(tape, &nodes);
        for _ in 0..10 {
            let size = 10.0_f64.powf(2.0 * random.uniform() - 2.5);
            let x: Vec<Interval> = (0..VARIABLES)
                .map(|_| {
                    let centre = 4.0 * random.uniform() - 2.0;
                    Interval::new(centre - size * random.uniform(), centre + size)
                })
                .collect();
            let mut inside = |x: &[Interval]| -> Vec<f64> {
                x.iter()
                    .map(|x| (x.low() + x.width() * random.uniform()).clamp(x.low(), x.high()))
                    .collect()
            };
            let weights = [(0, 0.7), (1, 0.3)];
            let Some(hessian) = bounder.hessian(&rows, &weights, &x) else {
                continue;
            };
            let tangent = Tangent {
                at: inside(&x),
                curvature: max_curvature(&hessian, &x, 1e-12),
            };
            let bound = bounder.second_order(&rows, &weights, &x, &hessian, &tangent);
            if bound == f64::NEG_INFINITY {
                continue;
            }
            bounds += 1;
            let mut nearest = f64::INFINITY;
            for turn in 0..10 {
                let anywhere = inside(&x);
                // at the tangent's own point, next to it and anywhere
                let share = [0.0, 1e-3, 1.0][turn % 3];
                let at: Vec<f64> = anywhere
                    .iter()
                    .zip(&tangent.at)
                    .map(|(a, t)| t + share * (a - t))
                    .collect();
                let point: Vec<Interval> = at.iter().map(|x| Interval::point(*x)).collect();
                let mut sum = Interval::ZERO;
                for &(row, weight) in &weights {
                    sum += Interval::point(weight) * rows.tape.enclose(&point, nodes[row]);
                }
                let share = (Interval::point(0.7) + Interval::point(0.3)).low();
                let value = (sum / Interval::point(share)).high() + 1e-12 * sum.magnitude();
                assert!(value >= bound, "{value} < {bound} at {at:?} in {x:?}");
                nearest = nearest.min(value - bound);
            }
            close += usize::from(nearest < 1e-2);
        }
    }
    assert!(close > bounds / 4, "{close} of {bounds} bounds are close");
}

/// Rows that share an operation, which cancels for equal weights.
#[test]
fn no_random_value_lies_below_a_bound_of_first_order() {
    let mut random = Random::new(2012);
    let mut bounder = Bounder::default();
    let (mut bounds, mut cancelled) = (0, 0);
    while bounds < 20_000 {
        let mut tape = Tape::new();
        let [shared, a, b] = [3, 2, 2].map(|depth| expression(&mut tape, &mut random, depth));
        let half = tape.constant(0.5);
        let sum = tape.binary(Binary::Add, shared, a);
        let difference = tape.binary(Binary::Sub, b, shared);
        let nodes = [
            tape.binary(Binary::Mul, half, sum),
            tape.binary(Binary::Mul, difference, half),
        ];
        let rows = rows(tape, &nodes);
        for weights in [[0.5, 0.5], [0.7, 0.3]] {
            let size = 10.0_f64.powf(2.0 * random.uniform() - 1.5);
            let x: Vec<Interval> = (0..VARIABLES)
                .map(|_| {
                    let centre = 4.0 * random.uniform() - 2.0;
                    Interval::new(centre - size * random.uniform(), centre + size)
                })
                .collect();
            let multipliers = vec![(0, weights[0]), (1, weights[1])];
            let bound = bounder.bound(&rows, &multipliers.into(), &x);
            if bound == f64::NEG_INFINITY {
                continue;
            }
            bounds += 1;
            cancelled += usize::from(!rows.tape.enclose(&x, nodes[0]).is_bounded());
            for _ in 0..10 {
                let point: Vec<Interval> = x
                    .iter()
                    .map(|x| {
                        let at = x.low() + x.width() * random.uniform();
                        Interval::point(at.clamp(x.low(), x.high()))
                    })
                    .collect();
                let mut sum = Interval::ZERO;
                for (node, weight) in nodes.iter().zip(weights) {
                    sum += Interval::point(weight) * rows.tape.enclose(&point, *node);
                }
                if !sum.is_empty() {
                    let value = sum.high() + 1e-12 * sum.magnitude();
                    assert!(value >= bound, "{value} < {bound} at {point:?} in {x:?}");
                }
            }
        }
    }
    assert!(
        cancelled > 500,
        "{cancelled} of {bounds} bounds cancel a pole"
    );
}
