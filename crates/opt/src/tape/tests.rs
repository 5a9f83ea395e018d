//! Enclosures of derivatives hold the divided differences of the function and of its gradient: by the mean value theorem
//! each is a derivative somewhere between the two points.

use grouser_real::Interval;

use super::{Binary, Curvatures, Enclosures, Node, Tape, Unary};
use crate::random::Random;

pub(crate) const UNARY: [Unary; 18] = [
    Unary::Neg,
    Unary::Abs,
    Unary::Sqrt,
    Unary::Exp,
    Unary::ExpM1,
    Unary::Ln,
    Unary::Ln1p,
    Unary::Log10,
    Unary::Sin,
    Unary::Cos,
    Unary::Tan,
    Unary::Asin,
    Unary::Acos,
    Unary::Atan,
    Unary::Sinh,
    Unary::Cosh,
    Unary::Tanh,
    Unary::Sinc,
];
pub(crate) const BINARY: [Binary; 8] = [
    Binary::Add,
    Binary::Sub,
    Binary::Mul,
    Binary::Div,
    Binary::Power,
    Binary::Min,
    Binary::Max,
    Binary::Atan2,
];
/// How many pairs of points each operation is tried with at least.
const MIN_PAIRS: usize = 2000;

/// The function of one operation, over two variables.
struct Single {
    tape: Tape,
    nodes: Vec<Node>,
    node: Node,
    over: Enclosures,
}

impl Single {
    fn new(make: impl Fn(&mut Tape, Node, Node) -> Node) -> Self {
        let mut tape = Tape::new();
        let (x, y) = (tape.variable(0), tape.variable(1));
        let node = make(&mut tape, x, y);
        let nodes = tape.needed(node);
        Self {
            tape,
            nodes,
            node,
            over: Enclosures::default(),
        }
    }

    /// The value and the gradient; `None` where the mean value theorem does not apply.
    fn gradient(&mut self, x: &[Interval]) -> Option<(Interval, Vec<Interval>)> {
        self.over.forward(&self.tape, x, &self.nodes);
        let mut gradient = vec![Interval::ZERO; x.len()];
        let terms = [(self.node, 1.0)];
        let value = self.over.sum(&self.tape, &self.nodes, &terms);
        let regular = self
            .over
            .gradient(&self.tape, &self.nodes, &terms, &mut gradient);
        regular.then_some((value, gradient))
    }

    /// The lower triangle of the Hessian.
    fn hessian(&mut self, x: &[Interval]) -> Option<Vec<Interval>> {
        self.over.forward(&self.tape, x, &self.nodes);
        let mut curvatures = Curvatures::default();
        curvatures.forward(&self.tape, x.len(), &self.over.values, &self.nodes);
        let mut sum = vec![Interval::ZERO; 3];
        curvatures
            .add_to(self.node, Interval::ONE, &mut sum)
            .then_some(sum)
    }

    /// Tries random pairs of points in random boxes; returns how many first and second differences were compared.
    fn compare(&mut self, random: &mut Random, name: &str) -> (usize, usize) {
        let (mut first, mut second) = (0, 0);
        for _ in 0..4 * MIN_PAIRS {
            let size = 10.0_f64.powf(3.5 * random.uniform() - 3.0);
            // boxes with an end at 0, and on one side of it, are as frequent as others
            let side = |random: &mut Random| {
                let low = match random.below(4) {
                    0 => 0.0,
                    1 => -size,
                    2 => 2.0 * random.uniform(),
                    _ => 4.0 * random.uniform() - 2.0,
                };
                Interval::new(low, low + size)
            };
            let x = [side(random), side(random)];
            let Some((_, over)) = self.gradient(&x) else {
                continue;
            };
            let hessian = self.hessian(&x);
            let inside =
                |x: Interval, share: f64| (x.low() + share * x.width()).clamp(x.low(), x.high());
            let p = x.map(|x| inside(x, random.uniform()));
            let moved = random.below(2);
            let mut q = p;
            q[moved] = inside(x[moved], random.uniform());
            let point = |p: [f64; 2]| p.map(Interval::point);
            let (Some((at_p, by_p)), Some((at_q, by_q))) =
                (self.gradient(&point(p)), self.gradient(&point(q)))
            else {
                continue;
            };
            let step = Interval::point(q[moved]) - Interval::point(p[moved]);
            if step.contains(0.0) {
                continue;
            }
            let slope = (at_q - at_p) / step;
            assert!(
                !slope.intersection(over[moved]).is_empty(),
                "{name}: {slope:?} is not in {:?}, from {p:?} to {q:?} in {x:?}",
                over[moved]
            );
            first += 1;
            let Some(hessian) = hessian else { continue };
            for i in 0..2 {
                let own = hessian[i.max(moved) * (i.max(moved) + 1) / 2 + i.min(moved)];
                let bend = (by_q[i] - by_p[i]) / step;
                assert!(
                    !bend.intersection(own).is_empty(),
                    "{name}: {bend:?} is not in {own:?}, from {p:?} to {q:?} in {x:?}"
                );
                second += 1;
            }
        }
        (first, second)
    }
}

#[test]
fn derivatives_of_each_operation_hold_divided_differences() {
    let mut random = Random::new(2012);
    let mut check = |name: &str, has_bend: bool, make: &dyn Fn(&mut Tape, Node, Node) -> Node| {
        let (first, second) = Single::new(make).compare(&mut random, name);
        let min_second = if has_bend { MIN_PAIRS / 2 } else { 0 };
        assert!(
            first >= MIN_PAIRS / 2 && second >= min_second,
            "{name}: {first} first and {second} second differences"
        );
    };
    for function in UNARY {
        check(function.name(), true, &|tape, x, _| tape.unary(function, x));
    }
    for function in BINARY {
        let has_bend = function != Binary::Atan2;
        check(function.name(), has_bend, &|tape, x, y| {
            tape.binary(function, x, y)
        });
    }
    for n in [-3, -2, -1, 0, 1, 2, 3, 4, 7] {
        let name = format!("power {n}");
        check(&name, true, &|tape, x, _| tape.whole_power(x, n));
    }
}

/// What two terms have in common cancels, though it has no bounds.
#[test]
fn common_parts_of_a_sum_cancel() {
    let mut tape = Tape::new();
    let (x, half) = (tape.variable(0), tape.constant(0.5));
    let one = tape.constant(1.0);
    let pole = tape.binary(Binary::Div, one, x);
    let up = tape.binary(Binary::Add, pole, x);
    let up = tape.binary(Binary::Mul, half, up);
    let down = tape.binary(Binary::Sub, x, pole);
    let down = tape.binary(Binary::Mul, down, half);
    let nodes = tape.needed_by([up, down]);
    let mut over = Enclosures::default();
    over.forward(&tape, &[Interval::new(-1.0, 3.0)], &nodes);
    let terms = [(up, 0.5), (down, 0.5)];
    let sum = over.sum(&tape, &nodes, &terms);
    assert!(
        Interval::new(-0.5, 1.5).is_inside(sum) && sum.width() < 2.1,
        "{sum:?}"
    );
    let mut gradient = [Interval::ZERO];
    assert!(over.gradient(&tape, &nodes, &terms, &mut gradient));
    assert_eq!(gradient[0], Interval::point(0.5));
    // with other weights the pole remains
    assert!(!over.gradient(&tape, &nodes, &[(up, 0.5), (down, 0.4)], &mut gradient));
}
