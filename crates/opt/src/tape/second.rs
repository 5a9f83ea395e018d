//! Enclosures of second derivatives over a box, forwards over the tape.
//!
//! Beside each operation's Hessian stands its gradient; both exist only where the operation is twice continuously
//! differentiable over the whole box.

use grouser_real::Interval;

use super::{Binary, Node, Op, Tape, Unary};

/// Gradients and Hessians of a tape's operations over one box.
#[derive(Default)]
pub(crate) struct Curvatures {
    n: usize,
    smooth: Vec<bool>,
    /// One gradient per operation.
    gradients: Vec<Interval>,
    /// One lower triangle per operation, row by row.
    hessians: Vec<Interval>,
}

/// Derivatives of a function of one number, where it is smooth.
type Slopes = Option<(Interval, Interval)>;

impl Curvatures {
    /// Encloses the operations `nodes`, which must hold all that they need, given their values over the box.
    pub(crate) fn forward(&mut self, tape: &Tape, n: usize, values: &[Interval], nodes: &[Node]) {
        self.n = n;
        let triangle = self.triangle();
        self.smooth.resize(tape.ops.len(), false);
        self.gradients.resize(tape.ops.len() * n, Interval::ZERO);
        self.hessians
            .resize(tape.ops.len() * triangle, Interval::ZERO);
        for &node in nodes {
            let at = node as usize;
            self.gradients[at * n..(at + 1) * n].fill(Interval::ZERO);
            self.hessians[at * triangle..(at + 1) * triangle].fill(Interval::ZERO);
            let value = |node: Node| values[node as usize];
            self.smooth[at] = match tape.ops[at] {
                Op::Constant(_) => true,
                Op::Variable(index) => {
                    self.gradients[at * n + index] = Interval::ONE;
                    true
                }
                Op::Unary(function, a) => {
                    let slopes = unary(function, value(a), values[at]);
                    self.compose(at, a, slopes)
                }
                Op::WholePower(a, p) => self.compose(at, a, whole_power(value(a), p)),
                Op::Binary(function, a, b) => {
                    self.combine(at, function, (a, value(a)), (b, value(b)), values[at])
                }
            };
        }
    }

    /// Adds `weight` times the Hessian of `node`; `false` where it has none.
    pub(crate) fn add_to(&self, node: Node, weight: Interval, sum: &mut [Interval]) -> bool {
        let (at, triangle) = (node as usize, sum.len());
        for (sum, h) in sum.iter_mut().zip(&self.hessians[at * triangle..]) {
            if *h != Interval::ZERO {
                *sum += weight * *h;
            }
        }
        self.smooth[at]
    }

    /// The length of a lower triangle.
    fn triangle(&self) -> usize {
        self.n * (self.n + 1) / 2
    }

    fn gradient(&self, node: usize) -> &[Interval] {
        &self.gradients[node * self.n..(node + 1) * self.n]
    }

    /// f(a): f' ∇a, and f' ∇²a + f'' ∇a ∇aᵀ.
    fn compose(&mut self, at: usize, a: Node, slopes: Slopes) -> bool {
        let a = a as usize;
        let Some((first, second)) = slopes else {
            return false;
        };
        if !self.smooth[a] || first.is_empty() || second.is_empty() {
            return false;
        }
        let (n, triangle) = (self.n, self.triangle());
        let mut place = 0;
        for i in 0..n {
            let by_i = self.gradient(a)[i];
            for j in 0..=i {
                let by_j = self.gradient(a)[j];
                let own = self.hessians[a * triangle + place];
                let mut sum = Interval::ZERO;
                if own != Interval::ZERO {
                    sum += first * own;
                }
                if second != Interval::ZERO && by_i != Interval::ZERO && by_j != Interval::ZERO {
                    sum += second * if i == j { by_i.square() } else { by_i * by_j };
                }
                self.hessians[at * triangle + place] = sum;
                place += 1;
            }
            if by_i != Interval::ZERO {
                self.gradients[at * n + i] = first * by_i;
            }
        }
        true
    }

    /// f(a, b): Σ f_k ∇k, and Σ f_k ∇²k + Σ f_kl ∇k ∇lᵀ.
    fn combine(
        &mut self,
        at: usize,
        function: Binary,
        (a, x): (Node, Interval),
        (b, y): (Node, Interval),
        value: Interval,
    ) -> bool {
        let (a, b) = (a as usize, b as usize);
        if !self.smooth[a] || !self.smooth[b] {
            return false;
        }
        let (one, zero) = (Interval::ONE, Interval::ZERO);
        // the slopes, and the second derivatives by (a, a), (a, b), (b, b)
        let (by_a, by_b, [aa, ab, bb]) = match function {
            Binary::Add => (one, one, [zero; 3]),
            Binary::Sub => (one, -one, [zero; 3]),
            Binary::Mul => (y, x, [zero, one, zero]),
            Binary::Div if !y.contains(0.0) => {
                let (share, ratio) = (one / y, value / y);
                let second = [zero, -share.square(), Interval::point(2.0) * (ratio / y)];
                (share, -ratio, second)
            }
            Binary::Power if x.low() > 0.0 => {
                let (ln, less) = (x.ln(), x.powf(y - one));
                let second = [
                    y * (y - one) * x.powf(y - Interval::point(2.0)),
                    less * (one + y * ln),
                    value * ln.square(),
                ];
                (y * less, value * ln, second)
            }
            Binary::Min if x.high() < y.low() => (one, zero, [zero; 3]),
            Binary::Min if y.high() < x.low() => (zero, one, [zero; 3]),
            Binary::Max if y.high() < x.low() => (one, zero, [zero; 3]),
            Binary::Max if x.high() < y.low() => (zero, one, [zero; 3]),
            _ => return false,
        };
        let (n, triangle) = (self.n, self.triangle());
        let mut place = 0;
        let term = |sum: &mut Interval, factor: Interval, g: Interval, h: Interval| {
            if factor != zero && g != zero && h != zero {
                *sum += factor * (g * h);
            }
        };
        for i in 0..n {
            let (ai, bi) = (self.gradient(a)[i], self.gradient(b)[i]);
            for j in 0..=i {
                let (aj, bj) = (self.gradient(a)[j], self.gradient(b)[j]);
                let mut sum = zero;
                term(&mut sum, one, by_a, self.hessians[a * triangle + place]);
                term(&mut sum, one, by_b, self.hessians[b * triangle + place]);
                if i == j {
                    term(&mut sum, aa, one, ai.square());
                    term(&mut sum, bb, one, bi.square());
                } else {
                    term(&mut sum, aa, ai, aj);
                    term(&mut sum, bb, bi, bj);
                }
                term(&mut sum, ab, ai, bj);
                term(&mut sum, ab, bi, aj);
                self.hessians[at * triangle + place] = sum;
                place += 1;
            }
            let mut sum = zero;
            term(&mut sum, one, by_a, ai);
            term(&mut sum, one, by_b, bi);
            self.gradients[at * n + i] = sum;
        }
        true
    }
}

/// The first and second derivative, where both are continuous over the interval.
fn unary(function: Unary, x: Interval, value: Interval) -> Slopes {
    let (one, two) = (Interval::ONE, Interval::point(2.0));
    let inside = x.magnitude() < 1.0;
    let arc = || one / (one - x.square()).sqrt();
    let arc_second = || x * arc().powi(3);
    Some(match function {
        Unary::Neg => (-one, Interval::ZERO),
        Unary::Abs if x.low() >= 0.0 => (one, Interval::ZERO),
        Unary::Abs if x.high() <= 0.0 => (-one, Interval::ZERO),
        Unary::Sqrt if x.low() > 0.0 => {
            let first = one / (two * value);
            (first, -(first / (two * x)))
        }
        Unary::Exp => (value, value),
        Unary::ExpM1 => (value + one, value + one),
        Unary::Ln if x.low() > 0.0 => (one / x, -(one / x.square())),
        Unary::Ln1p if x.low() > -1.0 => {
            let share = one / (one + x);
            (share, -share.square())
        }
        Unary::Log10 if x.low() > 0.0 => {
            let first = one / (x * Interval::point(10.0).ln());
            (first, -(first / x))
        }
        Unary::Sin => (x.cos(), -value),
        Unary::Cos => (-x.sin(), -value),
        Unary::Tan if !x.has_tangent_pole() => {
            let first = one + value.square();
            (first, two * value * first)
        }
        Unary::Asin if inside => (arc(), arc_second()),
        Unary::Acos if inside => (-arc(), -arc_second()),
        Unary::Atan => {
            let first = one / (one + x.square());
            (first, -(two * x * first.square()))
        }
        Unary::Sinh => (x.cosh(), value),
        Unary::Cosh => (x.sinh(), value),
        Unary::Tanh => {
            let first = one - value.square();
            (first, -(two * value * first))
        }
        Unary::Sinc => (x.sinc_slope(), x.sinc_curvature()),
        _ => return None,
    })
}

fn whole_power(x: Interval, p: i32) -> Slopes {
    if p < 0 && x.contains(0.0) {
        return None;
    }
    let factor = |n: i32| Interval::point(f64::from(n));
    Some(match p {
        0 => (Interval::ZERO, Interval::ZERO),
        1 => (Interval::ONE, Interval::ZERO),
        2 => (factor(2) * x, factor(2)),
        _ => (
            factor(p) * x.powi(p - 1),
            factor(p) * factor(p - 1) * x.powi(p - 2),
        ),
    })
}
