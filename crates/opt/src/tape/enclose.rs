//! Enclosures of a tape's operations over a box, and of the gradients of weighted sums by the chain rule in reverse.
//!
//! Beside each enclosure it is recorded whether the operation is defined and continuous everywhere over the enclosures
//! of its operands: the mean value theorem needs both.

use grouser_real::Interval;

use super::{Binary, Node, Op, Tape, Unary};

/// The enclosures of a tape over one box.
#[derive(Default)]
pub(crate) struct Enclosures {
    pub(crate) values: Vec<Interval>,
    /// Is the operation defined and continuous over the enclosures of its operands?
    regular: Vec<bool>,
    /// What a weighted sum of operations owes to each operation: its coefficient, or the derivative by it.
    shares: Vec<Interval>,
}

impl Tape {
    /// Encloses the values of `node` over a box of the variables.
    #[must_use]
    pub fn enclose(&self, x: &[Interval], node: Node) -> Interval {
        let mut enclosures = Enclosures::default();
        enclosures.forward(self, x, &self.needed(node));
        enclosures.values[node as usize]
    }
}

impl Enclosures {
    /// Encloses the operations `nodes`, which must hold all that they need.
    pub(crate) fn forward(&mut self, tape: &Tape, x: &[Interval], nodes: &[Node]) {
        self.values.resize(tape.ops.len(), Interval::ENTIRE);
        self.regular.resize(tape.ops.len(), false);
        for &node in nodes {
            let at = node as usize;
            let value = |node: Node| self.values[node as usize];
            (self.values[at], self.regular[at]) = match tape.ops[at] {
                Op::Constant(value) => (Interval::point(value), true),
                Op::Variable(index) => (x[index], true),
                Op::Unary(function, a) => unary(function, value(a)),
                Op::WholePower(a, n) => (value(a).powi(n), n >= 0 || !value(a).contains(0.0)),
                Op::Binary(function, a, b) => binary(function, value(a), value(b)),
            };
        }
    }

    /// Σ weight · operation for `terms`, after a forward pass over `nodes`. Sums are taken
    /// apart, so that what the terms have in common counts once; empty where a term has no value.
    pub(crate) fn sum(&mut self, tape: &Tape, nodes: &[Node], terms: &[(Node, f64)]) -> Interval {
        if terms
            .iter()
            .any(|(node, _)| self.values[*node as usize].is_empty())
        {
            return Interval::EMPTY;
        }
        self.seed(tape, nodes, terms);
        let mut sum = Interval::ZERO;
        for &node in nodes.iter().rev() {
            let share = self.shares[node as usize];
            if share != Interval::ZERO && !self.pass_through(tape, node, share) {
                sum += share * self.values[node as usize];
            }
        }
        sum
    }

    /// The enclosure of the gradient of Σ weight · operation for `terms`, after a forward
    /// pass over `nodes`; `false` where that sum may be undefined or jump in the box.
    pub(crate) fn gradient(
        &mut self,
        tape: &Tape,
        nodes: &[Node],
        terms: &[(Node, f64)],
        gradient: &mut [Interval],
    ) -> bool {
        gradient.fill(Interval::ZERO);
        self.seed(tape, nodes, terms);
        for &node in nodes.iter().rev() {
            let at = node as usize;
            let share = self.shares[at];
            // what has no share in the sum need not be continuous
            if share == Interval::ZERO || self.pass_through(tape, node, share) {
                continue;
            }
            if !self.regular[at] {
                return false;
            }
            let value = self.values[at];
            match tape.ops[at] {
                Op::Constant(_) => {}
                Op::Variable(index) => gradient[index] += share,
                Op::Unary(function, a) => {
                    let slope = unary_slope(function, self.values[a as usize], value);
                    self.pass(tape, a, share, slope);
                }
                Op::WholePower(a, n) => {
                    let slope = Interval::point(f64::from(n)) * self.values[a as usize].powi(n - 1);
                    self.pass(tape, a, share, slope);
                }
                Op::Binary(function, a, b) => {
                    let (x, y) = (self.values[a as usize], self.values[b as usize]);
                    let (by_a, by_b) = binary_slopes(function, x, y, value);
                    self.pass(tape, a, share, by_a);
                    self.pass(tape, b, share, by_b);
                }
            }
        }
        true
    }

    fn seed(&mut self, tape: &Tape, nodes: &[Node], terms: &[(Node, f64)]) {
        self.shares.resize(tape.ops.len(), Interval::ZERO);
        for node in nodes {
            self.shares[*node as usize] = Interval::ZERO;
        }
        for &(node, weight) in terms {
            self.shares[node as usize] += Interval::point(weight);
        }
    }

    /// Passes a share on to the operands of a sum, a difference, a sign or a multiple; `false` for other operations.
    /// Shares are not rounded where they are exact, so that equal parts of two terms cancel.
    fn pass_through(&mut self, tape: &Tape, node: Node, share: Interval) -> bool {
        let constant = |node: Node| match tape.ops[node as usize] {
            Op::Constant(value) => Some(value),
            _ => None,
        };
        match tape.ops[node as usize] {
            Op::Unary(Unary::Neg, a) => self.shares[a as usize] -= share,
            Op::Binary(Binary::Add, a, b) => {
                self.shares[a as usize] += share;
                self.shares[b as usize] += share;
            }
            Op::Binary(Binary::Sub, a, b) => {
                self.shares[a as usize] += share;
                self.shares[b as usize] -= share;
            }
            Op::Binary(Binary::Mul, a, b) => match (constant(a), constant(b)) {
                (Some(factor), None) => self.shares[b as usize] += multiple(share, factor),
                (None, Some(factor)) => self.shares[a as usize] += multiple(share, factor),
                _ => return false,
            },
            _ => return false,
        }
        true
    }

    fn pass(&mut self, tape: &Tape, to: Node, share: Interval, slope: Interval) {
        if matches!(tape.ops[to as usize], Op::Constant(_)) {
            return;
        }
        // a slope that has no value belongs to the end of a domain
        let slope = if slope.is_empty() {
            Interval::ENTIRE
        } else {
            slope
        };
        self.shares[to as usize] += share * slope;
    }
}

/// share · factor; one number where the product is exact.
fn multiple(share: Interval, factor: f64) -> Interval {
    let product = share.low() * factor;
    if share.low() == share.high() && product_error(share.low(), factor, product) == 0.0 {
        Interval::point(product)
    } else {
        share * Interval::point(factor)
    }
}

/// What rounding left out of `product` = a b (Dekker 1971, Numerische Mathematik 18); NaN where numbers so great or so
/// small have no exact answer.
fn product_error(a: f64, b: f64, product: f64) -> f64 {
    /// 2²⁷ + 1, without a unit: times this, a number's upper 26 bits can be taken off without rounding (Veltkamp; Dekker 1971).
    const UPPER_HALF_FACTOR: f64 = 134_217_729.0;
    const EXACT: std::ops::Range<f64> = 1e-140..1e140;
    if !EXACT.contains(&a.abs()) || !EXACT.contains(&b.abs()) {
        return f64::NAN;
    }
    let split = |x: f64| {
        let great = UPPER_HALF_FACTOR * x;
        let high = great - (great - x);
        (high, x - high)
    };
    let ((a, a_low), (b, b_low)) = (split(a), split(b));
    ((a * b - product) + a * b_low + a_low * b) + a_low * b_low
}

fn unary(function: Unary, x: Interval) -> (Interval, bool) {
    let always = |value: Interval| (value, true);
    match function {
        Unary::Neg => always(-x),
        Unary::Abs => always(x.abs()),
        Unary::Sqrt => (x.sqrt(), x.low() >= 0.0),
        Unary::Exp => always(x.exp()),
        Unary::ExpM1 => always(x.exp_m1()),
        Unary::Ln => (x.ln(), x.low() > 0.0),
        Unary::Ln1p => (x.ln_1p(), x.low() > -1.0),
        Unary::Log10 => (x.log10(), x.low() > 0.0),
        Unary::Sin => always(x.sin()),
        Unary::Cos => always(x.cos()),
        Unary::Tan => (x.tan(), !x.has_tangent_pole()),
        Unary::Asin => (x.asin(), x.magnitude() <= 1.0),
        Unary::Acos => (x.acos(), x.magnitude() <= 1.0),
        Unary::Atan => always(x.atan()),
        Unary::Sinh => always(x.sinh()),
        Unary::Cosh => always(x.cosh()),
        Unary::Tanh => always(x.tanh()),
        Unary::Sinc => always(x.sinc()),
    }
}

fn unary_slope(function: Unary, x: Interval, value: Interval) -> Interval {
    let one = Interval::ONE;
    match function {
        Unary::Neg => -one,
        Unary::Abs => {
            if x.low() >= 0.0 {
                one
            } else if x.high() <= 0.0 {
                -one
            } else {
                Interval::new(-1.0, 1.0)
            }
        }
        Unary::Sqrt => one / (Interval::point(2.0) * value),
        Unary::Exp => value,
        Unary::ExpM1 => value + one,
        Unary::Ln => one / x,
        Unary::Ln1p => one / (one + x),
        Unary::Log10 => one / (x * Interval::point(10.0).ln()),
        Unary::Sin => x.cos(),
        Unary::Cos => -x.sin(),
        Unary::Tan => one + value.square(),
        Unary::Asin => one / (one - x.square()).sqrt(),
        Unary::Acos => -(one / (one - x.square()).sqrt()),
        Unary::Atan => one / (one + x.square()),
        Unary::Sinh => x.cosh(),
        Unary::Cosh => x.sinh(),
        Unary::Tanh => one - value.square(),
        Unary::Sinc => x.sinc_slope(),
    }
}

fn binary(function: Binary, a: Interval, b: Interval) -> (Interval, bool) {
    match function {
        Binary::Add => (a + b, true),
        Binary::Sub => (a - b, true),
        Binary::Mul => (a * b, true),
        Binary::Div => (a / b, !b.contains(0.0)),
        Binary::Power => (
            a.powf(b),
            a.low() > 0.0 || (a.low() == 0.0 && b.low() > 0.0),
        ),
        Binary::Min => (a.min(b), true),
        Binary::Max => (a.max(b), true),
        Binary::Atan2 => (a.atan2(b), !a.crosses_branch_cut(b)),
    }
}

fn binary_slopes(
    function: Binary,
    a: Interval,
    b: Interval,
    value: Interval,
) -> (Interval, Interval) {
    let one = Interval::ONE;
    let either = Interval::new(0.0, 1.0);
    match function {
        Binary::Add => (one, one),
        Binary::Sub => (one, -one),
        Binary::Mul => (b, a),
        Binary::Div => (one / b, -(value / b)),
        Binary::Power => (b * a.powf(b - one), power_by_exponent(a, b, value)),
        Binary::Min if a.high() < b.low() => (one, Interval::ZERO),
        Binary::Min if b.high() < a.low() => (Interval::ZERO, one),
        Binary::Max if b.high() < a.low() => (one, Interval::ZERO),
        Binary::Max if a.high() < b.low() => (Interval::ZERO, one),
        Binary::Min | Binary::Max => (either, either),
        Binary::Atan2 => {
            let square = a.square() + b.square();
            (b / square, -(a / square))
        }
    }
}

/// xʸ ln x. At x = 0 the logarithm has no limit, but the product has: its least value over x is −1/(e y).
fn power_by_exponent(x: Interval, y: Interval, power: Interval) -> Interval {
    if x.low() > 0.0 {
        return power * x.ln();
    }
    let min = -(Interval::ONE / (Interval::ONE.exp() * Interval::point(y.low())));
    let max = if x.high() > 1.0 {
        power * x.ln()
    } else {
        Interval::ZERO
    };
    Interval::new(min.low(), max.high())
}
