//! Bounds lie below the weighted sum of random rows at random points.

use grouser_real::Interval;

use super::{Bounder, Tangent, Weights, centre, exceeds_curvature, level};
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

/// The levels that sums of objectives and limits prove, and what a sum without an objective proves.
#[test]
fn levels_of_sums() {
    let mut tape = Tape::new();
    let x = tape.variable(0);
    let mut rows = rows(tape, &[x, x, x]);
    rows.list[2].kind = LinearKind::AtMost;
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found}");
    near(level(&rows, &[(0, 0.5), (1, 1.5), (2, 7.0)], 3.0), 1.5);
    near(level(&rows, &[(1, 0.5), (2, 7.0)], -3.0), -6.0);
    assert_eq!(level(&rows, &[(2, 7.0)], 3.0), f64::INFINITY);
    assert_eq!(level(&rows, &[(2, 7.0)], 0.0), f64::NEG_INFINITY);
    assert_eq!(level(&rows, &[(2, 7.0)], -3.0), f64::NEG_INFINITY);
    rows.is_cleared = true;
    assert_eq!(level(&rows, &[(2, 7.0)], 3.0), 3.0);
    assert_eq!(level(&rows, &[(2, 7.0)], -3.0), -3.0);
}

/// No other point gives a mean value form with a greater lower end, where the function is taken as constant.
#[test]
fn the_best_point_of_a_mean_value_form() {
    let x = Interval::new(-1.0, 3.0);
    let low = |c: f64, slope: Interval| (slope * (x - Interval::point(c))).low();
    for slope in [
        (1.0, 2.0),
        (-2.0, -1.0),
        (-1.0, 2.0),
        (-3.0, 0.5),
        (0.0, 1.0),
        (-1.0, 0.0),
    ] {
        let slope = Interval::new(slope.0, slope.1);
        let best = low(centre(x, slope), slope);
        for i in 0..=400 {
            let other = low(-1.0 + 0.01 * f64::from(i), slope);
            assert!(other <= best + 1e-12, "{slope:?} {i}");
        }
    }
    // at an end, without rounding
    for i in 0..200 {
        let (x, slope) = (Interval::new(-0.3, 1.7), 0.01 * f64::from(i));
        assert_eq!(centre(x, Interval::new(0.0, slope)), -0.3);
        if slope > 0.0 {
            assert_eq!(centre(x, Interval::new(-slope, 0.0)), 1.7);
        }
    }
    let infinity = f64::INFINITY;
    assert_eq!(centre(x, Interval::new(-1.0, infinity)), -1.0);
    assert_eq!(centre(x, Interval::new(-infinity, 1.0)), 3.0);
    assert_eq!(centre(x, Interval::new(-infinity, -1.0)), 3.0);
    assert_eq!(
        centre(Interval::new(-infinity, 1.0), Interval::new(-1.0, 1.0)),
        Interval::new(-infinity, 1.0).middle()
    );
}

/// Against the least eigenvalue of two by two, (a + c − √((a − c)² + 4 b²))/2, in half sides.
#[test]
fn the_curvature_that_a_hessian_exceeds() {
    for (a, b, c) in [
        (2.0, 1.0, 3.0),
        (-2.0, 1.0, 3.0),
        (1.0, -2.5, 0.5),
        (-1.0, 0.0, -4.0),
        (0.0, 1.0, 0.0),
    ] {
        // sides of 4, 0 and 1, of which the second counts for nothing
        let x = [
            Interval::new(0.0, 4.0),
            Interval::ONE,
            Interval::new(1.0, 2.0),
        ];
        let hessian = [a, -9.0, -9.0, b, 9.0, c].map(Interval::point);
        let (a, b, c): (f64, f64, f64) = (4.0 * a, b, 0.25 * c);
        let least = 0.5 * (a + c - ((a - c).powi(2) + 4.0 * b * b).sqrt());
        assert!(exceeds_curvature(&hessian, &x, least - 1e-9));
        assert!(!exceeds_curvature(&hessian, &x, least + 1e-9));
        let curvature = max_curvature(&hessian, &x, 1e-9);
        if least > 0.0 {
            assert_eq!(curvature, -1e-9);
        } else {
            // by five halvings of a factor of 8
            assert!(
                curvature <= least && curvature >= 1.1 * least,
                "{curvature} {least}"
            );
        }
    }
    // a Hessian known to ±1: the least eigenvalue of any of them, as Gershgorin has it
    let x = [Interval::new(-1.0, 1.0), Interval::new(-2.0, 2.0)];
    let wide = |x: f64| Interval::new(x - 1.0, x + 1.0);
    let hessian = [wide(4.0), wide(0.0), wide(4.0)];
    // in half sides 4 − 1 − 2 and 16 − 4 − 2
    assert!(exceeds_curvature(&hessian, &x, 0.999));
    assert!(!exceeds_curvature(&hessian, &x, 1.001));
    assert!(!exceeds_curvature(&[Interval::ENTIRE; 3], &x, -1e9));
    assert!(!exceeds_curvature(
        &hessian,
        &[x[0], Interval::new(0.0, 1e-300)],
        -1.0
    ));
}

/// Linear rows are bounded exactly by first order, and squares by second order.
#[test]
fn bounds_of_rows_with_known_minima() {
    let mut tape = Tape::new();
    let (x, y) = (tape.variable(0), tape.variable(1));
    let (two, three) = (tape.constant(2.0), tape.constant(3.0));
    // 2 x − 3 y and x² + y² + x y
    let (a, b) = (
        tape.binary(Binary::Mul, two, x),
        tape.binary(Binary::Mul, three, y),
    );
    let line = tape.binary(Binary::Sub, a, b);
    let (xx, yy) = (tape.whole_power(x, 2), tape.whole_power(y, 2));
    let xy = tape.binary(Binary::Mul, x, y);
    let sum = tape.binary(Binary::Add, xx, yy);
    let square = tape.binary(Binary::Add, sum, xy);
    let rows = rows(tape, &[line, square]);
    let over = [Interval::new(-1.0, 2.0), Interval::new(-0.5, 3.0)];
    let mut bounder = Bounder::default();
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-7, "{found}");
    near(bounder.bound(&rows, &vec![(0, 1.0)].into(), &over), -11.0);
    near(bounder.bound(&rows, &vec![(0, 2.0)].into(), &over), -11.0);
    // the minimum 0 of the square lies inside
    let weights = Weights {
        rows: vec![(1, 1.0)],
        tangent: Some(Tangent {
            at: vec![0.0, 0.0],
            curvature: -1e-9,
        }),
        is_cleared: false,
    };
    near(bounder.bound(&rows, &weights, &over), 0.0);
    // of the sum of both: 2 x + y = −2 and 2 y + x = 3 less than half a side from the corner
    let weights = Weights {
        rows: vec![(0, 1.0), (1, 1.0)],
        ..weights
    };
    let hessian = bounder.hessian(&rows, &weights.rows, &over).unwrap();
    assert!((hessian[0].middle() - 2.0).abs() < 1e-12 && (hessian[1].middle() - 1.0).abs() < 1e-12);
    // at x = −1, y = 2: −8 + 1 + 4 − 2, for twice a level
    let weights = Weights {
        tangent: Some(Tangent {
            at: vec![-1.0, 2.0],
            curvature: -1e-9,
        }),
        ..weights
    };
    near(bounder.bound(&rows, &weights, &over), -2.5);
    // about the middle (0.5, 1.25): 2 · 0.5 − 3 · 1.25, with the slopes 2 and −3
    let form = bounder
        .form(&rows, &vec![(0, 2.0)].into(), &over, 5.0)
        .unwrap();
    near(form.offset, -5.5);
    near(form.limit, 10.0);
    near(form.slopes[0].middle(), 4.0);
    near(form.slopes[1].middle(), -6.0);
}

/// Of three variables: a matrix with known least eigenvalue, turned about two axes, in half sides.
#[test]
fn the_least_eigenvalue_of_turned_matrices() {
    let mut random = Random::new(2012);
    let half = [0.5, 2.0, 3.0];
    let x = half.map(|half| Interval::new(1.0 - half, 1.0 + half));
    for _ in 0..200 {
        let eigenvalues = [0; 3].map(|_| 6.0 * random.uniform() - 3.0);
        let mut full = [[0.0; 3]; 3];
        for d in 0..3 {
            full[d][d] = eigenvalues[d];
        }
        for (i, j) in [(0, 1), (1, 2), (0, 2)] {
            let (sin, cos) = (6.0 * random.uniform()).sin_cos();
            let turn = |a: f64, b: f64| (cos * a - sin * b, sin * a + cos * b);
            for row in &mut full {
                (row[i], row[j]) = turn(row[i], row[j]);
            }
            let rows: [(f64, f64); 3] = std::array::from_fn(|c| turn(full[i][c], full[j][c]));
            (full[i], full[j]) = (rows.map(|row| row.0), rows.map(|row| row.1));
        }
        let places = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];
        let hessian = places.map(|(i, j)| Interval::point(full[i][j] / (half[i] * half[j])));
        let least = eigenvalues.into_iter().fold(f64::INFINITY, f64::min);
        assert!(exceeds_curvature(&hessian, &x, least - 1e-9));
        assert!(!exceeds_curvature(&hessian, &x, least + 1e-9));
    }
    // positive, not only no less than 0
    let side = [Interval::new(-1.0, 1.0)];
    assert!(!exceeds_curvature(&[Interval::ZERO], &side, 0.0));
    assert!(exceeds_curvature(&[Interval::ZERO], &side, -1e-300));
}

/// A side without a length counts for nothing: −(x − 1)² + 3 y over [−1, 3] × 2.
#[test]
fn a_tangent_along_a_side_without_a_length() {
    let mut tape = Tape::new();
    let (x, y, one) = (tape.variable(0), tape.variable(1), tape.constant(1.0));
    let three = tape.constant(3.0);
    let apart = tape.binary(Binary::Sub, x, one);
    let square = tape.whole_power(apart, 2);
    let line = tape.binary(Binary::Mul, three, y);
    let node = tape.binary(Binary::Sub, line, square);
    let rows = rows(tape, &[node]);
    let x = [Interval::new(-1.0, 3.0), Interval::point(2.0)];
    let mut bounder = Bounder::default();
    let weights = Weights {
        rows: vec![(0, 1.0)],
        tangent: Some(Tangent {
            at: vec![1.0, 2.0],
            curvature: -8.000_001,
        }),
        is_cleared: false,
    };
    let bound = bounder.bound(&rows, &weights, &x);
    assert!((bound - 2.0).abs() < 1e-5, "{bound}");
}
