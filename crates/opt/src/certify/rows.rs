//! The problem to be certified: rows on a tape that must lie below one level γ, or below or at 0.

use std::borrow::Cow;

use grouser_real::Interval;

use super::CertifyError;
use super::bound::Weights;
use crate::method::Method;
use crate::problem::{Problem, Relation};
use crate::program::{Kind, Program};
use crate::sqp::LinearKind;
use crate::tape::{Binary, Enclosures, Node, Op, Tape, TapedFunctions, Unary};

/// A row: an expression, and what it must satisfy.
pub(super) struct Row {
    pub(super) name: String,
    pub(super) kind: LinearKind,
    pub(super) node: Node,
    /// The operations that it needs, itself last.
    pub(super) needed: Vec<Node>,
}

/// All rows over the box.
pub(super) struct Rows {
    pub(super) tape: Tape,
    pub(super) list: Vec<Row>,
    /// The operations that any row needs, in order.
    pub(super) needed: Vec<Node>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    /// An objective and its opposite, where there are such.
    pub(super) opposites: Option<(usize, usize)>,
    /// Are these rows without divisors, at a level that is their last variable?
    pub(super) is_cleared: bool,
}

impl Rows {
    pub(super) fn new(problem: &Problem<'_>, method: &Method) -> Result<Self, CertifyError> {
        method.check(problem)?;
        let (lower, upper) = problem.finite_box("a certificate")?;
        let n = lower.len();
        let TapedFunctions {
            mut tape,
            functions,
        } = problem
            .model()
            .taped(n, problem.function_count())
            .ok_or(CertifyError::NoFormula)?
            .with_limits();
        for (index, &function) in functions.iter().enumerate() {
            for node in tape.needed(function) {
                if let Op::Constant(value) = tape.ops[node as usize]
                    && !value.is_finite()
                {
                    let function = problem.function_name(index).to_owned();
                    return Err(CertifyError::NotFinite { function, value });
                }
            }
        }
        let mut list: Vec<(String, LinearKind, Node)> = Vec::new();
        if let Method::Weighted { weights } = method {
            let node = weighted_sum(&mut tape, &functions, weights, problem);
            list.push(("weighted sum".to_owned(), LinearKind::Objective, node));
        }
        for row in Program::new(problem, method).rows {
            let kind = match row.kind {
                Kind::Objective(_) if matches!(method, Method::Weighted { .. }) => continue,
                Kind::Objective(_) => LinearKind::Objective,
                Kind::HardGoal(_) | Kind::Inequality(_) => LinearKind::AtMost,
                Kind::Equality(_) => LinearKind::Equal,
            };
            let mut node = functions[row.function];
            if row.sign < 0.0 {
                node = tape.unary(Unary::Neg, node);
            }
            if row.shift != 0.0 {
                let shift = tape.constant(row.shift);
                node = tape.binary(Binary::Sub, node, shift);
            }
            node = scaled(&mut tape, node, row.scale);
            list.push((problem.function_name(row.function).to_owned(), kind, node));
        }
        for row in problem.linear() {
            let mut sum = tape.constant(-row.bound);
            for (index, &coefficient) in row.coefficients.iter().enumerate() {
                if coefficient != 0.0 {
                    let variable = tape.variable(index);
                    let term = scaled(&mut tape, variable, coefficient);
                    sum = tape.binary(Binary::Add, sum, term);
                }
            }
            let kind = match row.relation {
                Relation::Equal => LinearKind::Equal,
                Relation::AtMost => LinearKind::AtMost,
            };
            list.push((row.name.clone(), kind, sum));
        }
        let list: Vec<Row> = list
            .into_iter()
            .map(|(name, kind, node)| Row {
                name,
                kind,
                node,
                needed: tape.needed(node),
            })
            .collect();
        let needed = tape.needed_by(list.iter().map(|row| row.node));
        let opposites = list.iter().enumerate().find_map(|(at, row)| {
            let is_opposite = |other: &Row| {
                tape.ops[other.node as usize] == Op::Unary(Unary::Neg, row.node)
                    && [row.kind, other.kind] == [LinearKind::Objective; 2]
            };
            list.iter().position(is_opposite).map(|other| (at, other))
        });
        Ok(Self {
            opposites,
            tape,
            list,
            needed,
            lower,
            upper,
            is_cleared: false,
        })
    }

    /// γ and the worst violation at a point of the box, rounded up; `None` where a row has no value or is violated by
    /// more than the tolerance.
    pub(super) fn level_at(&self, x: &[f64], tolerance: f64) -> Option<(f64, f64)> {
        let inside = x
            .iter()
            .zip(self.lower.iter().zip(&self.upper))
            .all(|(x, (low, high))| low <= x && x <= high);
        if !inside {
            return None;
        }
        let point: Vec<Interval> = x.iter().map(|x| Interval::point(*x)).collect();
        let mut at = Enclosures::default();
        at.forward(&self.tape, &point, &self.needed);
        self.level_of(&at, tolerance)
    }

    /// As [`Self::level_at`], given the enclosures of all operations at the point.
    pub(super) fn level_of(&self, at: &Enclosures, tolerance: f64) -> Option<(f64, f64)> {
        let mut level = f64::NEG_INFINITY;
        let mut violation = 0.0_f64;
        for row in &self.list {
            let value = at.values[row.node as usize];
            if value.is_empty() {
                return None;
            }
            match row.kind {
                LinearKind::Objective => level = level.max(value.high()),
                LinearKind::AtMost => violation = violation.max(value.high()),
                LinearKind::Equal => violation = violation.max(value.magnitude()),
            }
        }
        (violation <= tolerance && level < f64::INFINITY).then_some((level, violation))
    }

    /// The operations that a weighted sum of rows needs, in order.
    pub(super) fn needed_by(&self, weights: &[(usize, f64)]) -> Cow<'_, [Node]> {
        match weights {
            [(row, _)] => Cow::Borrowed(&self.list[*row].needed),
            _ => self
                .tape
                .needed_by(weights.iter().map(|(row, _)| self.list[*row].node))
                .into(),
        }
    }

    /// Multipliers that prove γ ≥ 0: the greater of a number and its opposite is not negative.
    pub(super) fn nonnegative(&self) -> Option<Weights> {
        let (row, opposite) = self.opposites?;
        Some(vec![(row, 0.5), (opposite, 0.5)].into())
    }

    /// The operations of a weighted sum of rows.
    pub(super) fn terms(&self, weights: &[(usize, f64)]) -> Vec<(Node, f64)> {
        let term = |&(row, weight): &(usize, f64)| (self.list[row].node, weight);
        weights.iter().map(term).collect()
    }

    /// How many variables there are.
    pub(super) fn dimension(&self) -> usize {
        self.lower.len()
    }
}

fn scaled(tape: &mut Tape, node: Node, factor: f64) -> Node {
    if factor == 1.0 {
        return node;
    }
    let factor = tape.constant(factor);
    tape.binary(Binary::Mul, node, factor)
}

fn weighted_sum(
    tape: &mut Tape,
    functions: &[Node],
    weights: &[f64],
    problem: &Problem<'_>,
) -> Node {
    let mut sum = None;
    for group in problem.weighted(weights) {
        let mut worst = None;
        for (index, weight) in group {
            let function = functions[index];
            let size = if index < problem.absolute() {
                tape.unary(Unary::Abs, function)
            } else {
                function
            };
            let term = scaled(tape, size, weight);
            worst = Some(match worst {
                Some(worst) => tape.binary(Binary::Max, worst, term),
                None => term,
            });
        }
        if let Some(term) = worst {
            sum = Some(match sum {
                Some(sum) => tape.binary(Binary::Add, sum, term),
                None => term,
            });
        }
    }
    sum.unwrap_or_else(|| tape.constant(0.0))
}
