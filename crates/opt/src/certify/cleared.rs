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
