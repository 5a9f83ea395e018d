//! Where a box may hold better points, seen from the limit of each row backwards (HC4: Benhamou et al. 1999, ICLP).
//!
//! The enclosure of each row is cut at what the row must not exceed, and what that leaves of its operands is passed on
//! down to the variables. A cut that this suggests is proved like any other, by a bound over the piece that goes.

use grouser_real::{Interval, Real};

use super::rows::Rows;
use crate::sqp::LinearKind;
use crate::tape::{Binary, Node, Op, Unary};

/// Roots are off by less than this share of themselves: the power of a platform is within a few units of 1.1e-16, and so is
/// its exponent 1/n. What is suggested here is proved by a bound in any case.
const ROOT_ERROR_SHARE: f64 = 1e-14;

/// Memory for the propagation, one per thread.
#[derive(Default)]
pub(super) struct Propagator {
    /// What is left of each operation.
    left: Vec<Interval>,
}

impl Propagator {
    /// What is left of the sides of a box, given the enclosures of all operations over it; empty sides where nothing is.
    pub(super) fn shrink(
        &mut self,
        rows: &Rows,
        values: &[Interval],
        x: &[Interval],
        target: f64,
    ) -> Vec<Interval> {
        self.left.clear();
        self.left.extend_from_slice(values);
        for row in &rows.list {
            let allowed = match row.kind {
                LinearKind::Objective => Interval::new(f64::NEG_INFINITY, target),
                LinearKind::AtMost => Interval::new(f64::NEG_INFINITY, 0.0),
                LinearKind::Equal => Interval::ZERO,
            };
            self.keep(row.node, allowed);
        }
        let mut sides = x.to_vec();
        for &node in rows.needed.iter().rev() {
            let value = self.left[node as usize];
            let operand = |node: Node| self.left[node as usize];
            match rows.tape.ops[node as usize] {
                Op::Constant(_) => {}
                Op::Variable(index) => sides[index] = sides[index].intersection(value),
                Op::Unary(function, a) => {
                    if let Some(kept) = inverse(function, value, operand(a)) {
                        self.keep(a, kept);
                    }
                }
                Op::WholePower(a, n) => {
                    if let Some(kept) = root(value, operand(a), n) {
                        self.keep(a, kept);
                    }
                }
                Op::Binary(function, a, b) => {
                    let (x, y) = (operand(a), operand(b));
                    if a == b {
                        continue;
                    }
                    if let Some((of_a, of_b)) = inverses(function, value, x, y) {
                        self.keep(a, of_a);
                        self.keep(b, of_b);
                    }
                }
            }
        }
        sides
    }

    fn keep(&mut self, node: Node, allowed: Interval) {
        let left = &mut self.left[node as usize];
        *left = left.intersection(allowed);
    }
}

/// The arguments within `x` that have these values; `None` where nothing is known.
fn inverse(function: Unary, value: Interval, x: Interval) -> Option<Interval> {
    Some(match function {
        Unary::Neg => -value,
        Unary::Abs if x.low() >= 0.0 => value,
        Unary::Abs => value.hull(-value),
        Unary::Sqrt => value
            .intersection(Interval::new(0.0, f64::INFINITY))
            .square(),
        Unary::Exp => value.ln(),
        Unary::ExpM1 => value.ln_1p(),
        Unary::Ln => value.exp(),
        Unary::Ln1p => value.exp_m1(),
        Unary::Log10 => (value * Interval::point(10.0).ln()).exp(),
        Unary::Asin => value.sin(),
        Unary::Acos => value.cos(),
        Unary::Atan if !value.has_tangent_pole() => value.tan(),
        _ => return None,
    })
}

/// The numbers within `x` whose powers these are.
fn root(value: Interval, x: Interval, n: i32) -> Option<Interval> {
    if n <= 0 {
        return None;
    }
    let share = 1.0 / f64::from(n);
    let of = |v: f64| Real::powf(v.abs(), share).copysign(v);
    let rounded = |low: f64, high: f64| {
        let slack = Interval::new(1.0 - ROOT_ERROR_SHARE, 1.0 + ROOT_ERROR_SHARE);
        Interval::new(low, high) * slack
    };
    if n % 2 == 1 {
        return Some(rounded(of(value.low()), of(value.high())));
    }
    let high = of(value.high().max(0.0));
    let low = of(value.low().max(0.0));
    Some(if x.low() >= 0.0 {
        rounded(low, high)
    } else if x.high() <= 0.0 {
        rounded(-high, -low)
    } else {
        rounded(-high, high)
    })
}

/// The operands within `x` and `y` that have these values.
fn inverses(
    function: Binary,
    value: Interval,
    x: Interval,
    y: Interval,
) -> Option<(Interval, Interval)> {
    Some(match function {
        Binary::Add => (value - y, value - x),
        Binary::Sub => (value + y, x - value),
        Binary::Mul => (ratio(value, y, x), ratio(value, x, y)),
        Binary::Div => (value * y, ratio(x, value, y)),
        Binary::Max => {
            let at_most = Interval::new(f64::NEG_INFINITY, value.high());
            (at_most, at_most)
        }
        Binary::Min => {
            let at_least = Interval::new(value.low(), f64::INFINITY);
            (at_least, at_least)
        }
        Binary::Power if x.low() >= 0.0 && y.width() == 0.0 && y.low() != 0.0 => {
            let positive = value.intersection(Interval::new(0.0, f64::INFINITY));
            (positive.powf(Interval::ONE / y), Interval::ENTIRE)
        }
        Binary::Power | Binary::Atan2 => return None,
    })
}

/// The quotients a/b within `known`: where b holds 0 and a does not, those of one sign begin away from 0.
fn ratio(a: Interval, b: Interval, known: Interval) -> Interval {
    if !b.contains(0.0) || a.contains(0.0) {
        // a divisor of 0 goes with a dividend of 0 and any quotient
        return if b.contains(0.0) {
            Interval::ENTIRE
        } else {
            a / b
        };
    }
    let min_size = a.low().abs().min(a.high().abs()) / b.magnitude();
    // the signs of a quotient that `known` and the operands allow
    let b = if a.low().is_sign_negative() { -b } else { b };
    let above = b.high() > 0.0 && known.high() >= min_size;
    let below = b.low() < 0.0 && known.low() <= -min_size;
    match (below, above) {
        (true, true) => Interval::ENTIRE,
        (true, false) => Interval::new(f64::NEG_INFINITY, -min_size),
        (false, true) => Interval::new(min_size, f64::INFINITY),
        (false, false) => Interval::EMPTY,
    }
}

#[cfg(test)]
#[path = "propagate_tests.rs"]
mod tests;
