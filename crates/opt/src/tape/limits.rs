//! Quotients whose dividend vanishes with the divisor, continued by their limits.
//!
//! Over a box in which the divisor vanishes such a quotient has no bounds, though its values stay bounded:
//!
//! ```text
//! a v / v = a,    a sin(v w) / v = a w sinc(v w)
//! ```
//! Both sides are equal wherever the left one has a value, and the right one is the limit elsewhere: v is analytic,
//! so that it vanishes on a set without volume.

use super::{Binary, Node, Op, Tape, TapedFunctions, Unary};

/// Longer products are left as they are.
const MAX_FACTORS: usize = 32;
/// Greater powers count as one factor.
const MAX_POWER: u32 = 8;

/// A product of operations over a product of operations.
#[derive(Clone, Debug, Default)]
struct Quotient {
    is_negative: bool,
    dividends: Vec<Node>,
    divisors: Vec<Node>,
}

impl Quotient {
    /// Takes the products, quotients, signs and powers of an operation apart.
    fn multiply(&mut self, tape: &Tape, node: Node, is_divisor: bool) {
        match tape.ops[node as usize] {
            Op::Unary(Unary::Neg, a) => {
                self.is_negative = !self.is_negative;
                self.multiply(tape, a, is_divisor);
            }
            Op::Binary(Binary::Mul, a, b) => {
                self.multiply(tape, a, is_divisor);
                self.multiply(tape, b, is_divisor);
            }
            Op::Binary(Binary::Div, a, b) => {
                self.multiply(tape, a, is_divisor);
                self.multiply(tape, b, !is_divisor);
            }
            Op::WholePower(a, n) if n != 0 && n.unsigned_abs() <= MAX_POWER => {
                for _ in 0..n.unsigned_abs() {
                    self.multiply(tape, a, is_divisor != (n < 0));
                }
            }
            _ if self.dividends.len() + self.divisors.len() > MAX_FACTORS => {}
            _ if is_divisor => self.divisors.push(node),
            _ => self.dividends.push(node),
        }
    }

    /// `None` where there are too many factors.
    fn of(tape: &Tape, node: Node) -> Option<Self> {
        let mut quotient = Self::default();
        quotient.multiply(tape, node, false);
        let count = quotient.dividends.len() + quotient.divisors.len();
        (count <= MAX_FACTORS).then_some(quotient)
    }

    /// Removes one divisor that vanishes with a dividend; `false` where there is none.
    fn reduce(&mut self, tape: &mut Tape) -> bool {
        for at in 0..self.divisors.len() {
            let divisor = self.divisors[at];
            if !is_analytic(tape, divisor) {
                continue;
            }
            for place in 0..self.dividends.len() {
                let dividend = self.dividends[place];
                if dividend == divisor {
                    self.dividends.swap_remove(place);
                    self.divisors.swap_remove(at);
                    return true;
                }
                let Op::Unary(Unary::Sin, angle) = tape.ops[dividend as usize] else {
                    continue;
                };
                let Some(mut rest) = Self::of(tape, angle) else {
                    continue;
                };
                let Some(own) = rest.dividends.iter().position(|d| *d == divisor) else {
                    continue;
                };
                rest.dividends.swap_remove(own);
                self.dividends[place] = tape.unary(Unary::Sinc, angle);
                self.divisors.swap_remove(at);
                self.dividends.append(&mut rest.dividends);
                self.divisors.append(&mut rest.divisors);
                self.is_negative ^= rest.is_negative;
                return true;
            }
        }
        false
    }

    fn onto(&self, tape: &mut Tape) -> Node {
        let product = |tape: &mut Tape, factors: &[Node]| {
            let mut factors = factors.iter().copied();
            let first = factors.next();
            first.map(|first| factors.fold(first, |a, b| tape.binary(Binary::Mul, a, b)))
        };
        let mut node = product(tape, &self.dividends).unwrap_or_else(|| tape.constant(1.0));
        if let Some(divisor) = product(tape, &self.divisors) {
            node = tape.binary(Binary::Div, node, divisor);
        }
        if self.is_negative {
            node = tape.unary(Unary::Neg, node);
        }
        node
    }
}

/// Is this a function of the variables that has all derivatives everywhere and is no constant?
fn is_analytic(tape: &Tape, node: Node) -> bool {
    if matches!(tape.ops[node as usize], Op::Constant(_)) {
        return false;
    }
    let everywhere = |node: Node| match tape.ops[node as usize] {
        Op::Constant(_)
        | Op::Variable(_)
        | Op::Binary(Binary::Add | Binary::Sub | Binary::Mul, ..) => true,
        Op::WholePower(_, n) => n >= 0,
        Op::Unary(function, _) => matches!(
            function,
            Unary::Neg
                | Unary::Exp
                | Unary::ExpM1
                | Unary::Sin
                | Unary::Cos
                | Unary::Atan
                | Unary::Sinh
                | Unary::Cosh
                | Unary::Tanh
                | Unary::Sinc
        ),
        Op::Binary(..) => false,
    };
    tape.needed(node).into_iter().all(everywhere)
}

impl TapedFunctions {
    /// The same functions, with their quotients continued by limits where those are known.
    pub(crate) fn with_limits(&self) -> Self {
        let mut tape = Tape::new();
        let mut at: Vec<Node> = vec![0; self.tape.ops.len()];
        for node in self.needed() {
            let place = |node: Node| at[node as usize];
            let mut new = match self.tape.ops[node as usize] {
                Op::Constant(value) => tape.constant(value),
                Op::Variable(index) => tape.variable(index),
                Op::Unary(function, x) => tape.unary(function, place(x)),
                Op::Binary(function, a, b) => tape.binary(function, place(a), place(b)),
                Op::WholePower(x, n) => tape.whole_power(place(x), n),
            };
            let is_product = matches!(
                tape.ops[new as usize],
                Op::Binary(Binary::Mul | Binary::Div, ..)
            );
            if is_product
                && let Some(mut quotient) = Quotient::of(&tape, new)
                && quotient.reduce(&mut tape)
            {
                while quotient.reduce(&mut tape) {}
                new = quotient.onto(&mut tape);
            }
            at[node as usize] = new;
        }
        let functions = self.functions.iter().map(|f| at[*f as usize]).collect();
        Self { tape, functions }
    }
}

#[cfg(test)]
mod tests {
    use grouser_real::Interval;

    use super::*;

    fn limits(make: impl Fn(&mut Tape, Node, Node) -> Node) -> (TapedFunctions, TapedFunctions) {
        let mut tape = Tape::new();
        let (x, y) = (tape.variable(0), tape.variable(1));
        let node = make(&mut tape, x, y);
        let before = TapedFunctions {
            tape,
            functions: vec![node],
        };
        let after = before.with_limits();
        (before, after)
    }

    /// Both have the same values beside the pole, and the second one is bounded over a box that holds it.
    fn assert_same(make: impl Fn(&mut Tape, Node, Node) -> Node) {
        let (before, after) = limits(make);
        let over = [Interval::new(-1.0, 2.0), Interval::new(0.5, 3.0)];
        let at = |f: &TapedFunctions, x: &[Interval]| f.tape.enclose(x, f.functions[0]);
        assert!(!at(&before, &over).is_bounded());
        let whole = at(&after, &over);
        assert!(whole.is_bounded());
        for i in 0..50 {
            let x = Interval::point(-1.0 + 0.06 * f64::from(i) + 1e-3);
            let y = Interval::point(0.5 + 0.05 * f64::from(i));
            let (a, b) = (at(&before, &[x, y]), at(&after, &[x, y]));
            assert!((a - b).magnitude() < 1e-12 * a.magnitude().max(1.0));
            assert!(!whole.intersection(a).is_empty());
        }
    }

    #[test]
    fn a_common_factor_is_cancelled() {
        assert_same(|tape, x, y| {
            let square = tape.whole_power(x, 2);
            let product = tape.binary(Binary::Mul, square, y);
            tape.binary(Binary::Div, product, x)
        });
    }

    #[test]
    fn a_sine_over_a_factor_of_its_angle_has_a_limit() {
        // −y/(3 x) e^(−y) sin(−2 x y) : the quotient comes first
        assert_same(|tape, x, y| {
            let (two, three) = (tape.constant(2.0), tape.constant(3.0));
            let divisor = tape.binary(Binary::Mul, three, x);
            let quotient = tape.binary(Binary::Div, y, divisor);
            let minus = tape.unary(Unary::Neg, y);
            let decay = tape.unary(Unary::Exp, minus);
            let product = tape.binary(Binary::Mul, quotient, decay);
            let twice = tape.binary(Binary::Mul, two, x);
            let angle = tape.binary(Binary::Mul, twice, minus);
            let wave = tape.unary(Unary::Sin, angle);
            tape.binary(Binary::Mul, product, wave)
        });
    }

    /// √x/√x has no value below 0, where 1 is no limit of it; max(x, 0)/max(x, 0) has none there either.
    #[test]
    fn a_factor_that_vanishes_or_ends_somewhere_stays() {
        let make: [fn(&mut Tape, Node, Node) -> Node; 2] = [
            |tape, x, _| tape.unary(Unary::Sqrt, x),
            |tape, x, y| tape.binary(Binary::Max, x, y),
        ];
        for factor in make {
            let (_, after) = limits(|tape, x, y| {
                let v = factor(tape, x, y);
                tape.binary(Binary::Div, v, v)
            });
            let at = [Interval::point(-1.0), Interval::ZERO];
            assert!(after.tape.enclose(&at, after.functions[0]).is_empty());
        }
    }

    #[test]
    fn a_cosine_over_its_angle_has_none() {
        let (_, after) = limits(|tape, x, _| {
            let wave = tape.unary(Unary::Cos, x);
            tape.binary(Binary::Div, wave, x)
        });
        let over = [Interval::new(-1.0, 1.0), Interval::ZERO];
        assert!(!after.tape.enclose(&over, after.functions[0]).is_bounded());
    }
}
