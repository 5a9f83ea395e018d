//! Enclosures of random expressions over random boxes hold every value: 10⁶ random points, and values of 30 digits.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test stops at the first surprise, and picks places in lists"
)]

use grouser_opt::{Binary, Node, Tape, Unary};
use grouser_real::Interval;

use crate::random_starts::Stream;

type One = (&'static str, Unary, fn(f64) -> f64);
type Two = (&'static str, Binary, fn(f64, f64) -> f64);

const UNARY: [One; 18] = [
    ("neg", Unary::Neg, |x| -x),
    ("abs", Unary::Abs, f64::abs),
    ("sqrt", Unary::Sqrt, f64::sqrt),
    ("exp", Unary::Exp, f64::exp),
    ("expm1", Unary::ExpM1, f64::exp_m1),
    ("ln", Unary::Ln, f64::ln),
    ("ln1p", Unary::Ln1p, f64::ln_1p),
    ("log10", Unary::Log10, f64::log10),
    ("sin", Unary::Sin, f64::sin),
    ("cos", Unary::Cos, f64::cos),
    ("tan", Unary::Tan, f64::tan),
    ("asin", Unary::Asin, f64::asin),
    ("acos", Unary::Acos, f64::acos),
    ("atan", Unary::Atan, f64::atan),
    ("sinh", Unary::Sinh, f64::sinh),
    ("cosh", Unary::Cosh, f64::cosh),
    ("tanh", Unary::Tanh, f64::tanh),
    ("sinc", Unary::Sinc, |x| {
        if x == 0.0 { 1.0 } else { x.sin() / x }
    }),
];

const BINARY: [Two; 8] = [
    ("add", Binary::Add, |a, b| a + b),
    ("sub", Binary::Sub, |a, b| a - b),
    ("mul", Binary::Mul, |a, b| a * b),
    ("div", Binary::Div, |a, b| a / b),
    ("pow", Binary::Power, f64::powf),
    ("min", Binary::Min, f64::min),
    ("max", Binary::Max, f64::max),
    ("atan2", Binary::Atan2, f64::atan2),
];

/// One step in postfix notation.
#[derive(Clone, Copy)]
enum Step {
    Variable(usize),
    Constant(f64),
    Unary(usize),
    Power(i32),
    Binary(usize),
}

fn pick(stream: &mut Stream, count: usize) -> usize {
    (stream.next() * count as f64) as usize
}

fn random(stream: &mut Stream, depth: usize, out: &mut Vec<Step>) {
    let kind = stream.next();
    if depth == 0 || kind < 0.1 {
        out.push(if stream.next() < 0.8 {
            Step::Variable(pick(stream, 3))
        } else {
            Step::Constant(6.0 * stream.next() - 3.0)
        });
    } else if kind < 0.5 {
        random(stream, depth - 1, out);
        out.push(Step::Unary(pick(stream, UNARY.len())));
    } else if kind < 0.6 {
        random(stream, depth - 1, out);
        out.push(Step::Power([-2, -1, 0, 1, 2, 3, 4][pick(stream, 7)]));
    } else {
        random(stream, depth - 1, out);
        random(stream, depth - 1, out);
        out.push(Step::Binary(pick(stream, BINARY.len())));
    }
}

fn onto(tape: &mut Tape, steps: &[Step]) -> Node {
    let mut stack = Vec::new();
    for step in steps {
        let node = match *step {
            Step::Variable(index) => tape.variable(index),
            Step::Constant(value) => tape.constant(value),
            Step::Unary(index) => {
                let x = stack.pop().unwrap();
                tape.unary(UNARY[index].1, x)
            }
            Step::Power(n) => {
                let x = stack.pop().unwrap();
                tape.whole_power(x, n)
            }
            Step::Binary(index) => {
                let (b, a) = (stack.pop().unwrap(), stack.pop().unwrap());
                tape.binary(BINARY[index].1, a, b)
            }
        };
        stack.push(node);
    }
    stack.pop().unwrap()
}

/// The value in double precision; `None` where it or a part of it has none.
fn value(steps: &[Step], x: &[f64]) -> Option<f64> {
    let mut stack: Vec<f64> = Vec::new();
    for step in steps {
        let value = match *step {
            Step::Variable(index) => x[index],
            Step::Constant(value) => value,
            Step::Unary(index) => UNARY[index].2(stack.pop()?),
            Step::Power(n) => stack.pop()?.powi(n),
            Step::Binary(index) => {
                let (b, a) = (stack.pop()?, stack.pop()?);
                BINARY[index].2(a, b)
            }
        };
        // an infinite part is an overflow or a pole, not a value
        if !value.is_finite() {
            return None;
        }
        stack.push(value);
    }
    stack.pop()
}

#[test]
fn enclosures_hold_a_million_values() {
    let mut stream = Stream(2012);
    let (mut points, mut bounded) = (0, 0);
    while points < 1_000_000 {
        let mut steps = Vec::new();
        random(&mut stream, 5, &mut steps);
        let mut tape = Tape::new();
        let node = onto(&mut tape, &steps);
        for _ in 0..20 {
            let size = 10.0_f64.powf(3.0 * stream.next() - 3.0);
            let sides: Vec<Interval> = (0..3)
                .map(|_| {
                    let centre = 4.0 * stream.next() - 2.0;
                    Interval::new(centre - size, centre + size)
                })
                .collect();
            let over = tape.enclose(&sides, node);
            bounded += usize::from(over.is_bounded());
            for _ in 0..10 {
                let x: Vec<f64> = sides
                    .iter()
                    .map(|s| {
                        let inside = s.low() + (s.high() - s.low()) * stream.next();
                        inside.clamp(s.low(), s.high())
                    })
                    .collect();
                let Some(value) = value(&steps, &x) else {
                    continue;
                };
                // the exact value lies in the enclosure of the point; the double is off by its own rounding
                let point: Vec<Interval> = x.iter().map(|x| Interval::point(*x)).collect();
                let at = tape.enclose(&point, node);
                let rounding = if at.is_bounded() {
                    at.width()
                } else {
                    f64::INFINITY
                };
                points += 1;
                let both = over.intersection(at);
                assert!(!both.is_empty(), "{at:?} is not in {over:?} at {x:?}");
                assert!(
                    over.low() - rounding <= value && value <= over.high() + rounding,
                    "{value} is not in {over:?} at {x:?}"
                );
            }
        }
    }
    assert!(bounded > 20_000, "{bounded}");
}

#[test]
fn enclosures_of_points_hold_values_of_thirty_digits() {
    let mut checked = 0;
    for line in include_str!("references.csv").lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let steps: Vec<Step> = cells[0].split(' ').map(step).collect();
        let x: Vec<Interval> = cells[1]
            .split(' ')
            .map(|x| Interval::point(x.parse().unwrap()))
            .collect();
        let mut tape = Tape::new();
        let node = onto(&mut tape, &steps);
        let at = tape.enclose(&x, node);
        // the exact value lies within half a unit of the nearest double, which the outward steps cover
        let nearest: f64 = cells[2].parse().unwrap();
        assert!(
            at.low() <= nearest && nearest <= at.high(),
            "{}: {} is not in {at:?}",
            cells[0],
            cells[2]
        );
        checked += 1;
    }
    assert_eq!(checked, 2000);
}

fn step(token: &str) -> Step {
    if let Some(index) = UNARY.iter().position(|(name, ..)| *name == token) {
        Step::Unary(index)
    } else if let Some(index) = BINARY.iter().position(|(name, ..)| *name == token) {
        Step::Binary(index)
    } else if let Some(n) = token.strip_prefix("powi:") {
        Step::Power(n.parse().unwrap())
    } else if let Some(index) = token.strip_prefix('x') {
        Step::Variable(index.parse().unwrap())
    } else {
        Step::Constant(token.parse().unwrap())
    }
}
