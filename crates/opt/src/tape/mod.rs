//! Functions as a list of operations: what a bound over a box and a proof can be computed from.

#[cfg(test)]
mod closed_form_tests;
mod enclose;
mod limits;
mod second;
#[cfg(test)]
pub(crate) mod tests;

use std::collections::HashMap;

pub(crate) use enclose::Enclosures;
pub(crate) use second::Curvatures;

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(
    missing_docs,
    reason = "the functions are those of `grouser_real::Real`"
)]
pub enum Unary {
    Neg,
    Abs,
    Sqrt,
    Exp,
    ExpM1,
    Ln,
    Ln1p,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    /// sin x/x, 1 at 0.
    Sinc,
}

impl Unary {
    /// The name in proof logs.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Neg => "neg",
            Self::Abs => "abs",
            Self::Sqrt => "sqrt",
            Self::Exp => "exp",
            Self::ExpM1 => "expm1",
            Self::Ln => "ln",
            Self::Ln1p => "ln1p",
            Self::Log10 => "log10",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Asin => "asin",
            Self::Acos => "acos",
            Self::Atan => "atan",
            Self::Sinh => "sinh",
            Self::Cosh => "cosh",
            Self::Tanh => "tanh",
            Self::Sinc => "sinc",
        }
    }
}

/// A function of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(
    missing_docs,
    reason = "the functions are those of `grouser_real::Real`"
)]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Power,
    Min,
    Max,
    Atan2,
}

impl Binary {
    /// The name in proof logs.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Add => "add",
            Self::Sub => "sub",
            Self::Mul => "mul",
            Self::Div => "div",
            Self::Power => "pow",
            Self::Min => "min",
            Self::Max => "max",
            Self::Atan2 => "atan2",
        }
    }
}

/// The place of an operation in its [`Tape`].
pub type Node = u32;

/// One operation; its operands come before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Op {
    Constant(f64),
    Variable(usize),
    Unary(Unary, Node),
    Binary(Binary, Node, Node),
    WholePower(Node, i32),
}

#[derive(PartialEq, Eq, Hash)]
enum Key {
    Constant(u64),
    Variable(usize),
    Unary(Unary, Node),
    Binary(Binary, Node, Node),
    WholePower(Node, i32),
}

/// A list of operations over numbered variables; equal operations are listed once.
///
/// ```
/// use grouser_opt::{Binary, Tape, Unary};
/// use grouser_real::Interval;
///
/// // x² − sin y
/// let mut tape = Tape::new();
/// let (x, y) = (tape.variable(0), tape.variable(1));
/// let square = tape.whole_power(x, 2);
/// let sine = tape.unary(Unary::Sin, y);
/// let f = tape.binary(Binary::Sub, square, sine);
/// let over = tape.enclose(&[Interval::new(-1.0, 2.0), Interval::new(0.0, 1.0)], f);
/// assert!(over.contains(4.0) && over.contains(-0.8) && over.width() < 4.85);
/// ```
#[derive(Default)]
pub struct Tape {
    pub(crate) ops: Vec<Op>,
    known: HashMap<Key, Node>,
}

impl Tape {
    /// A tape without operations.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    fn once(&mut self, key: Key, op: Op) -> Node {
        if let Some(node) = self.known.get(&key) {
            return *node;
        }
        #[allow(
            clippy::cast_possible_truncation,
            reason = "a tape of 2³² operations does not fit into memory"
        )]
        let node = self.ops.len() as Node;
        self.ops.push(op);
        self.known.insert(key, node);
        node
    }

    /// A number.
    pub fn constant(&mut self, value: f64) -> Node {
        self.once(Key::Constant(value.to_bits()), Op::Constant(value))
    }

    /// Variable number `index`.
    pub fn variable(&mut self, index: usize) -> Node {
        self.once(Key::Variable(index), Op::Variable(index))
    }

    /// A function of one operand.
    pub fn unary(&mut self, function: Unary, x: Node) -> Node {
        self.once(Key::Unary(function, x), Op::Unary(function, x))
    }

    /// A function of two operands. A product of an operand with itself is its square, which has a tighter enclosure.
    pub fn binary(&mut self, function: Binary, a: Node, b: Node) -> Node {
        if function == Binary::Mul && a == b {
            return self.whole_power(a, 2);
        }
        self.once(Key::Binary(function, a, b), Op::Binary(function, a, b))
    }

    /// A whole power.
    pub fn whole_power(&mut self, x: Node, n: i32) -> Node {
        self.once(Key::WholePower(x, n), Op::WholePower(x, n))
    }

    /// Adds the operations of `other`; returns where its nodes are now.
    pub fn append(&mut self, other: &Self) -> Vec<Node> {
        let mut at: Vec<Node> = Vec::with_capacity(other.ops.len());
        for op in &other.ops {
            let node = match *op {
                Op::Constant(value) => self.constant(value),
                Op::Variable(index) => self.variable(index),
                Op::Unary(function, x) => self.unary(function, at[x as usize]),
                Op::Binary(function, a, b) => self.binary(function, at[a as usize], at[b as usize]),
                Op::WholePower(x, n) => self.whole_power(at[x as usize], n),
            };
            at.push(node);
        }
        at
    }

    /// The operations that any of these depends on, themselves included, in order.
    pub(crate) fn needed_by(&self, nodes: impl IntoIterator<Item = Node>) -> Vec<Node> {
        let mut wanted = vec![false; self.ops.len()];
        for node in nodes {
            wanted[node as usize] = true;
        }
        for at in (0..self.ops.len()).rev() {
            if !wanted[at] {
                continue;
            }
            match self.ops[at] {
                Op::Constant(_) | Op::Variable(_) => {}
                Op::Unary(_, x) | Op::WholePower(x, _) => wanted[x as usize] = true,
                Op::Binary(_, a, b) => {
                    wanted[a as usize] = true;
                    wanted[b as usize] = true;
                }
            }
        }
        (0..)
            .zip(wanted)
            .filter_map(|(node, wanted)| wanted.then_some(node))
            .collect()
    }

    /// The operations that `node` depends on, in order, itself last.
    pub(crate) fn needed(&self, node: Node) -> Vec<Node> {
        self.needed_by([node])
    }
}

/// A model's functions on a tape: where each function's value is.
pub struct TapedFunctions {
    /// The operations.
    pub tape: Tape,
    /// The node of each function, in the model's order.
    pub functions: Vec<Node>,
}

impl TapedFunctions {
    /// The operations that any function depends on, in order.
    pub(crate) fn needed(&self) -> Vec<Node> {
        self.tape.needed_by(self.functions.iter().copied())
    }
}
