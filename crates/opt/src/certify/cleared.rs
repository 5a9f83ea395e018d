//! Rows without their divisors: what a level excludes where a divisor may vanish.
//!
//! A quotient over a box in which its divisor vanishes has no bounds, however small the box. Yet where a row N/D and
//! its opposite both are objectives (as for |N/D|), a point with the level b has
//!
//! ```text
//! |N/D| ≤ b   ⇒   N − b |D| ≤ 0  and  −N − b |D| ≤ 0
//! ```
//! Such rows are bounded as any other; a positive bound of a weighted sum proves that the box holds no point with the
//! level b or below. The level is one more variable, a point. Away from its poles a quotient gains too: N − b |D| is
//! nearly as linear as N and D where b is small.

use std::collections::HashMap;

use grouser_real::Interval;

use super::rows::{Row, Rows};
use crate::sqp::LinearKind;
use crate::tape::{Binary, Enclosures, Node, Op, Tape, Unary};

/// Makes fractions of operations, each once.
struct Fractions<'t> {
    tape: &'t mut Tape,
    one: Node,
    known: HashMap<Node, (Node, Node)>,
}

impl Fractions<'_> {
    fn times(&mut self, a: Node, b: Node) -> Node {
        if a == self.one {
            b
        } else if b == self.one {
            a
        } else {
            self.tape.binary(Binary::Mul, a, b)
        }
    }

    /// Numerator and denominator.
    fn of(&mut self, node: Node) -> (Node, Node) {
        if let Some(known) = self.known.get(&node) {
            return *known;
        }
        let found = match self.tape.ops[node as usize] {
            Op::Unary(Unary::Neg, a) => {
                let (n, d) = self.of(a);
                (self.tape.unary(Unary::Neg, n), d)
            }
            Op::Binary(
                function @ (Binary::Add | Binary::Sub | Binary::Mul | Binary::Div),
                a,
                b,
            ) => {
                let (n, d) = self.of(a);
                let (m, e) = self.of(b);
                match function {
                    Binary::Mul => (self.times(n, m), self.times(d, e)),
                    Binary::Div => (self.times(n, e), self.times(d, m)),
                    _ if d == e => (self.tape.binary(function, n, m), d),
                    _ => {
                        let (n, m) = (self.times(n, e), self.times(m, d));
                        (self.tape.binary(function, n, m), self.times(d, e))
                    }
                }
            }
            _ => (node, self.one),
        };
        self.known.insert(node, found);
        found
    }
}

impl Rows {
    /// May a divisor vanish in the box?
    fn has_poles(&self) -> bool {
        let sides = self.lower.iter().zip(&self.upper);
        let x: Vec<Interval> = sides
            .map(|(low, high)| Interval::new(*low, *high))
            .collect();
        let mut over = Enclosures::default();
        over.forward(&self.tape, &x, &self.needed);
        let is_pole = |node: &Node| match self.tape.ops[*node as usize] {
            Op::Binary(Binary::Div, _, divisor) => over.values[divisor as usize].contains(0.0),
            _ => false,
        };
        self.needed.iter().any(is_pole)
    }

    /// The rows without divisors, with the level as the last variable; `None` where no divisor vanishes.
    pub(super) fn cleared(&self) -> Option<Self> {
        if !self.has_poles() {
            return None;
        }
        let mut tape = Tape::new();
        let at = tape.append(&self.tape);
        let (one, level) = (tape.constant(1.0), tape.variable(self.dimension()));
        let objectives: Vec<Node> = self
            .list
            .iter()
            .filter(|row| row.kind == LinearKind::Objective)
            .map(|row| at[row.node as usize])
            .collect();
        let mut fractions = Fractions {
            tape: &mut tape,
            one,
            known: HashMap::new(),
        };
        let mut list: Vec<(LinearKind, Node)> = Vec::new();
        for row in &self.list {
            let node = at[row.node as usize];
            if row.kind != LinearKind::Objective {
                list.push((row.kind, node));
                continue;
            }
            let ops = &fractions.tape.ops;
            let negates = |a: Node, b: Node| ops[a as usize] == Op::Unary(Unary::Neg, b);
            let mut others = objectives.iter();
            let (n, d) = if others.any(|other| negates(*other, node) || negates(node, *other)) {
                fractions.of(node)
            } else {
                (node, one)
            };
            let tape = &mut *fractions.tape;
            let size = tape.unary(Unary::Abs, d);
            let limit = tape.binary(Binary::Mul, level, size);
            list.push((LinearKind::AtMost, tape.binary(Binary::Sub, n, limit)));
        }
        let list: Vec<Row> = list
            .into_iter()
            .zip(&self.list)
            .map(|((kind, node), row)| Row {
                name: row.name.clone(),
                kind,
                node,
                needed: tape.needed(node),
            })
            .collect();
        let needed = tape.needed_by(list.iter().map(|row| row.node));
        let with_level = |ends: &[f64]| [ends, &[0.0]].concat();
        Some(Self {
            tape,
            list,
            needed,
            lower: with_level(&self.lower),
            upper: with_level(&self.upper),
            opposites: None,
            is_cleared: true,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certify::process::tests::rows_over;
    use crate::random::Random;

    fn rational(tape: &mut Tape, random: &mut Random, depth: usize) -> Node {
        if depth == 0 || random.uniform() < 0.1 {
            return match random.below(3) {
                0 => tape.constant(4.0 * random.uniform() - 2.0),
                index => tape.variable(index - 1),
            };
        }
        let a = rational(tape, random, depth - 1);
        if random.uniform() < 0.15 {
            return tape.unary(Unary::Neg, a);
        }
        let b = rational(tape, random, depth - 1);
        let of = [
            Binary::Add,
            Binary::Sub,
            Binary::Mul,
            Binary::Div,
            Binary::Div,
        ];
        tape.binary(of[random.below(5)], a, b)
    }

    fn at(rows: &Rows, x: &[f64]) -> Vec<f64> {
        let x: Vec<Interval> = x.iter().map(|x| Interval::point(*x)).collect();
        let value = |row: &Row| rows.tape.enclose(&x, row.node).middle();
        rows.list.iter().map(value).collect()
    }

    /// N − b |D| at the levels 0 and 1 gives N and |D|: their ratio is the size of the row.
    #[test]
    fn a_row_without_divisors_is_its_numerator_and_denominator() {
        let mut random = Random::new(2012);
        let mut compared = 0;
        while compared < 2000 {
            let seed = Random::new(random.below(1 << 30) as u64);
            let rows = rows_over([Interval::new(-2.0, 2.0); 2], &[], |tape, x, y| {
                let node = rational(tape, &mut seed.clone(), 4);
                vec![
                    node,
                    tape.unary(Unary::Neg, node),
                    tape.binary(Binary::Div, x, y),
                ]
            });
            let cleared = rows.cleared().unwrap();
            assert!(
                cleared.is_cleared
                    && cleared
                        .list
                        .iter()
                        .all(|row| row.kind == LinearKind::AtMost)
            );
            for _ in 0..10 {
                let [x, y] = [0; 2].map(|_| 4.0 * random.uniform() - 2.0);
                let row = at(&rows, &[x, y]);
                let (n, less) = (at(&cleared, &[x, y, 0.0]), at(&cleared, &[x, y, 1.0]));
                let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * (a.abs() + b.abs());
                // what is not paired keeps its divisor
                assert!(near(n[2], row[2]) && near(n[2] - 1.0, less[2]));
                let size = n[0] - less[0];
                if row[0].is_finite()
                    && row[0] != 0.0
                    && (1e-3..1e3).contains(&size)
                    && n[0].abs() < 1e3
                {
                    assert!(
                        near(n[0].abs(), row[0].abs() * size),
                        "{row:?} {n:?} {less:?}"
                    );
                    assert!(near(n[1], -n[0]) && near(n[1] - less[1], size));
                    compared += 1;
                }
            }
        }
    }

    /// x/y + 1/y has the denominator y, not y²: x + 1 − |y| is at least 1 over [1, 2] × [−1, 1].
    #[test]
    fn a_common_denominator_counts_once() {
        let sides = [Interval::new(1.0, 2.0), Interval::new(-1.0, 1.0)];
        let rows = rows_over(sides, &[], |tape, x, y| {
            let one = tape.constant(1.0);
            let (a, b) = (
                tape.binary(Binary::Div, x, y),
                tape.binary(Binary::Div, one, y),
            );
            let sum = tape.binary(Binary::Add, a, b);
            vec![sum, tape.unary(Unary::Neg, sum)]
        });
        let cleared = rows.cleared().unwrap();
        let over = cleared
            .tape
            .enclose(&[sides[0], sides[1], Interval::ONE], cleared.list[0].node);
        assert!(
            (over.low() - 1.0).abs() < 1e-15 && (over.high() - 3.0).abs() < 1e-15,
            "{over:?}"
        );
    }
}
