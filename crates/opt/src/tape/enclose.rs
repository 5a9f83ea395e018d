//! Enclosures of a tape's operations over a box, and of their gradients by the chain rule in reverse.
//!
//! Beside each enclosure it is recorded whether the operation is defined and continuous everywhere in the box: the
//! mean value theorem needs both.

use grouser_real::Interval;

use super::{Binary, LawEnclosure, Node, Op, Tape, Unary};

/// The enclosures of a tape over one box.
#[derive(Default)]
pub(crate) struct Enclosures {
    pub(crate) values: Vec<Interval>,
    /// Defined and continuous over the whole box?
    pub(crate) regular: Vec<bool>,
    laws: Vec<Option<LawEnclosure>>,
    adjoints: Vec<Interval>,
}

impl Tape {
    /// Encloses the values of `node` over a box of the variables.
    #[must_use]
    pub fn enclose(&self, x: &[Interval], node: Node) -> Interval {
        let mut enclosures = Enclosures::default();
        enclosures.forward(self, x, &self.needed(node), false);
        enclosures.values[node as usize]
    }
}

impl Enclosures {
    /// Encloses the operations `nodes`, which must hold all that they need; `gradient` where [`Self::gradient`] is
    /// to follow.
    pub(crate) fn forward(&mut self, tape: &Tape, x: &[Interval], nodes: &[Node], gradient: bool) {
        self.values.resize(tape.ops.len(), Interval::ENTIRE);
        self.regular.resize(tape.ops.len(), false);
        self.laws.clear();
        self.laws.resize(tape.calls.len(), None);
        let mut computed = vec![false; tape.calls.len()];
        for &node in nodes {
            let at = node as usize;
            let (value, regular) = match tape.ops[at] {
                Op::Constant(value) => (Interval::point(value), true),
                Op::Variable(index) => (x[index], true),
                Op::Unary(function, a) => {
                    let a = a as usize;
                    let (value, regular) = unary(function, self.values[a]);
                    (value, regular && self.regular[a])
                }
                Op::WholePower(a, n) => {
                    let a = a as usize;
                    let regular = n >= 0 || !self.values[a].contains(0.0);
                    (self.values[a].powi(n), regular && self.regular[a])
                }
                Op::Binary(function, a, b) => {
                    let (a, b) = (a as usize, b as usize);
                    let (value, regular) = binary(function, self.values[a], self.values[b]);
                    (value, regular && self.regular[a] && self.regular[b])
                }
                Op::Law { law, output } => {
                    let call = &tape.calls[law];
                    if !computed[law] {
                        computed[law] = true;
                        let arguments: Vec<Interval> = call
                            .arguments
                            .iter()
                            .map(|a| self.values[*a as usize])
                            .collect();
                        self.laws[law] = call.law.enclose(&arguments, gradient);
                    }
                    match &self.laws[law] {
                        Some(enclosure) => (
                            enclosure.values[output],
                            call.arguments.iter().all(|a| self.regular[*a as usize]),
                        ),
                        None => (Interval::ENTIRE, false),
                    }
                }
            };
            self.values[at] = value;
            self.regular[at] = regular;
        }
    }

    /// The enclosure of the gradient of the last of `nodes`, after a forward pass over them; `false` where that
    /// function is not regular over the box.
    pub(crate) fn gradient(
        &mut self,
        tape: &Tape,
        nodes: &[Node],
        gradient: &mut [Interval],
    ) -> bool {
        gradient.fill(Interval::ZERO);
        let Some(&last) = nodes.last() else {
            return false;
        };
        if !self.regular[last as usize] {
            return false;
        }
        self.adjoints.resize(tape.ops.len(), Interval::ZERO);
        for node in nodes {
            self.adjoints[*node as usize] = Interval::ZERO;
        }
        self.adjoints[last as usize] = Interval::ONE;
        for &node in nodes.iter().rev() {
            let at = node as usize;
            let adjoint = self.adjoints[at];
            if adjoint == Interval::ZERO {
                continue;
            }
            let value = self.values[at];
            match tape.ops[at] {
                Op::Constant(_) => {}
                Op::Variable(index) => gradient[index] += adjoint,
                Op::Unary(function, a) => {
                    let slope = unary_slope(function, self.values[a as usize], value);
                    self.pass(tape, a, adjoint, slope);
                }
                Op::WholePower(a, n) => {
                    let slope = Interval::point(f64::from(n)) * self.values[a as usize].powi(n - 1);
                    self.pass(tape, a, adjoint, slope);
                }
                Op::Binary(function, a, b) => {
                    let (x, y) = (self.values[a as usize], self.values[b as usize]);
                    let (by_a, by_b) = binary_slopes(function, x, y, value);
                    self.pass(tape, a, adjoint, by_a);
                    self.pass(tape, b, adjoint, by_b);
                }
                Op::Law { law, output } => {
                    let arguments = &tape.calls[law].arguments;
                    for (index, &a) in arguments.iter().enumerate() {
                        let slope = self.laws[law].as_ref().map_or(Interval::ENTIRE, |e| {
                            let at = output * arguments.len() + index;
                            e.gradients.get(at).copied().unwrap_or(Interval::ENTIRE)
                        });
                        self.pass(tape, a, adjoint, slope);
                    }
                }
            }
        }
        true
    }

    fn pass(&mut self, tape: &Tape, to: Node, adjoint: Interval, slope: Interval) {
        if matches!(tape.ops[to as usize], Op::Constant(_)) {
            return;
        }
        // a slope that has no value belongs to the end of a domain
        let slope = if slope.is_empty() {
            Interval::ENTIRE
        } else {
            slope
        };
        self.adjoints[to as usize] += adjoint * slope;
    }
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
    if !(y.low() > 0.0) {
        return Interval::ENTIRE;
    }
    let least = -(Interval::ONE / (Interval::ONE.exp() * Interval::point(y.low())));
    let most = if x.high() > 1.0 {
        power * x.ln()
    } else {
        Interval::ZERO
    };
    Interval::new(least.low(), most.high())
}
