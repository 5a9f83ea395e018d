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
        if self.dividends.len() + self.divisors.len() > MAX_FACTORS {
            return;
        }
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
            _ if is_divisor => self.divisors.push(node),
            _ => self.dividends.push(node),
        }
    }

    /// `None` where there are too many factors.
    fn from_node(tape: &Tape, node: Node) -> Option<Self> {
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
                let Some(mut rest) = Self::from_node(tape, angle) else {
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
                && let Some(mut quotient) = Quotient::from_node(&tape, new)
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

    fn product(tape: &mut Tape, factors: &[Node]) -> Node {
        let mut factors = factors.iter().copied();
        let first = factors.next().unwrap();
        factors.fold(first, |a, b| tape.binary(Binary::Mul, a, b))
    }

    /// y + 1, y + 2, ..., each divided so that their product is of moderate size.
    fn factors(tape: &mut Tape, y: Node, count: u32) -> Vec<Node> {
        let factor = |i: u32| {
            let (add, divide) = (f64::from(i), tape.constant(f64::from(i) + 1.0));
            let add = tape.constant(add);
            let sum = tape.binary(Binary::Add, y, add);
            tape.binary(Binary::Max, sum, divide)
        };
        (1..=count).map(factor).collect()
    }

    #[test]
    fn powers_are_taken_apart() {
        // x⁸ y/x, x⁻² y x³/x, and x² in the divisor against x⁻¹
        assert_same(|tape, x, y| {
            let power = tape.whole_power(x, 8);
            let up = tape.binary(Binary::Mul, power, y);
            tape.binary(Binary::Div, up, x)
        });
        assert_same(|tape, x, y| {
            let (less, more) = (tape.whole_power(x, -2), tape.whole_power(x, 3));
            let up = product(tape, &[less, y, more]);
            tape.binary(Binary::Div, up, x)
        });
        assert_same(|tape, x, y| {
            let (less, square) = (tape.whole_power(x, -3), tape.whole_power(x, -3));
            let down = tape.binary(Binary::Mul, less, y);
            let _ = square;
            let up = tape.whole_power(x, -3);
            tape.binary(Binary::Div, up, down)
        });
        // a ninth power counts as one factor
        let (_, after) = limits(|tape, x, y| {
            let power = tape.whole_power(x, 9);
            let up = tape.binary(Binary::Mul, power, y);
            tape.binary(Binary::Div, up, x)
        });
        let over = [Interval::new(-1.0, 2.0), Interval::new(0.5, 3.0)];
        assert!(!after.tape.enclose(&over, after.functions[0]).is_bounded());
    }

    /// −sin(−x y)/x is y sinc(x y), of two signs that cancel, and the factor may hold powers itself.
    #[test]
    fn signs_and_powers_of_factors() {
        assert_same(|tape, x, y| {
            let minus = tape.unary(Unary::Neg, x);
            let angle = tape.binary(Binary::Mul, minus, y);
            let wave = tape.unary(Unary::Sin, angle);
            let minus = tape.unary(Unary::Neg, wave);
            tape.binary(Binary::Div, minus, x)
        });
        for power in [0, 2, 3] {
            assert_same(|tape, x, y| {
                let (power, one) = (tape.whole_power(x, power), tape.constant(1.0));
                let sum = tape.binary(Binary::Sub, power, one);
                let factor = tape.binary(Binary::Add, sum, x);
                let up = tape.binary(Binary::Mul, factor, y);
                tape.binary(Binary::Div, up, factor)
            });
        }
        // 1/x + y has no value at 0
        let (_, after) = limits(|tape, x, y| {
            let inverse = tape.whole_power(x, -1);
            let factor = tape.binary(Binary::Add, inverse, y);
            tape.binary(Binary::Div, factor, factor)
        });
        let at = [Interval::ZERO, Interval::ONE];
        assert!(after.tape.enclose(&at, after.functions[0]).is_empty());
    }

    /// Products of up to 32 factors are taken apart; longer ones stay as they are, with all of their factors.
    #[test]
    fn long_products_keep_their_factors() {
        for (up, down) in [(24, 2), (29, 1)] {
            assert_same(|tape, x, y| {
                let mut all = factors(tape, y, up + down);
                let mut divisors = all.split_off(up as usize);
                all.push(x);
                divisors.push(x);
                let (up, down) = (product(tape, &all), product(tape, &divisors));
                tape.binary(Binary::Div, up, down)
            });
        }
        let at = [Interval::point(0.75), Interval::point(1.25)];
        let over = [Interval::new(-1.0, 2.0), Interval::new(0.5, 3.0)];
        for is_wave in [false, true] {
            let (before, after) = limits(|tape, x, y| {
                let mut all = factors(tape, y, 40);
                all.insert(3, x);
                let mut up = product(tape, &all);
                if is_wave {
                    // about 41! / 0.5
                    let small = tape.constant(1e-50);
                    up = tape.binary(Binary::Mul, up, small);
                    up = tape.unary(Unary::Sin, up);
                }
                tape.binary(Binary::Div, up, x)
            });
            let whole = after.tape.enclose(&over, after.functions[0]);
            assert!(!whole.is_bounded());
            let of = |f: &TapedFunctions| f.tape.enclose(&at, f.functions[0]);
            assert_eq!(of(&before), of(&after));
        }
    }

    /// x, x², x⁴, ... : the factors of a power of 2⁶⁰ cannot be listed.
    #[test]
    fn squares_of_squares_take_no_time() {
        let (before, after) = limits(|tape, x, _| {
            let power = (0..60).fold(x, |x, _| tape.whole_power(x, 2));
            tape.binary(Binary::Div, power, x)
        });
        assert!(after.tape.ops.len() < before.tape.ops.len());
    }
}
