//! A number that records what is done with it: generic functions become a [`Tape`].

use std::cell::RefCell;
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use grouser_real::{Real, Scalar};

use super::dual::Functions;
use crate::tape::{Binary, Node, Tape, TapedFunctions, Unary};

/// Whole powers up to this are recorded as such.
const WHOLE_POWER: f64 = 64.0;

#[derive(Default)]
struct Recorder {
    tape: Tape,
    /// Did the functions look at a value? Then the record holds for one path only.
    branched: bool,
}

thread_local! {
    static RECORDER: RefCell<Recorder> = RefCell::default();
}

fn record<T>(action: impl FnOnce(&mut Recorder) -> T) -> T {
    RECORDER.with(|recorder| action(&mut recorder.borrow_mut()))
}

/// A number on the tape of this thread, or a constant.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Trace {
    Constant(f64),
    Node(Node),
}

impl Trace {
    fn node(self, tape: &mut Tape) -> Node {
        match self {
            Self::Constant(value) => tape.constant(value),
            Self::Node(node) => node,
        }
    }

    fn unary(self, function: Unary) -> Self {
        record(|r| {
            let x = self.node(&mut r.tape);
            Self::Node(r.tape.unary(function, x))
        })
    }

    fn binary(self, function: Binary, other: Self) -> Self {
        record(|r| {
            let (a, b) = (self.node(&mut r.tape), other.node(&mut r.tape));
            Self::Node(r.tape.binary(function, a, b))
        })
    }

    /// Compares constants; of anything else the answer depends on the point.
    fn compare(self, other: Self) -> Option<Ordering> {
        if let (Self::Constant(a), Self::Constant(b)) = (self, other) {
            return a.partial_cmp(&b);
        }
        record(|r| r.branched = true);
        None
    }
}

/// The functions on a tape; `None` where their path depends on the values.
pub(crate) fn trace(
    functions: &impl Functions,
    variables: usize,
    count: usize,
) -> Option<TapedFunctions> {
    let x: Vec<Trace> = record(|r| {
        *r = Recorder::default();
        (0..variables)
            .map(|index| Trace::Node(r.tape.variable(index)))
            .collect()
    });
    let mut out = vec![Trace::Constant(f64::NAN); count];
    functions.evaluate(&x, &mut out);
    record(|r| {
        let mut recorder = std::mem::take(r);
        let functions = out.iter().map(|f| f.node(&mut recorder.tape)).collect();
        (!recorder.branched).then_some(TapedFunctions {
            tape: recorder.tape,
            functions,
        })
    })
}

impl PartialEq for Trace {
    fn eq(&self, other: &Self) -> bool {
        self.compare(*other) == Some(Ordering::Equal)
    }
}
impl PartialOrd for Trace {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.compare(*other)
    }
}
impl Add for Trace {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.binary(Binary::Add, other)
    }
}
impl Sub for Trace {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.binary(Binary::Sub, other)
    }
}
impl Mul for Trace {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.binary(Binary::Mul, other)
    }
}
impl Div for Trace {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.binary(Binary::Div, other)
    }
}
impl Neg for Trace {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(-value),
            Self::Node(_) => self.unary(Unary::Neg),
        }
    }
}
impl AddAssign for Trace {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl SubAssign for Trace {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
impl MulAssign for Trace {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Real for Trace {
    type Mask = bool;
    const ZERO: Self = Self::Constant(0.0);
    const ONE: Self = Self::Constant(1.0);
    const PI: Self = Self::Constant(std::f64::consts::PI);

    fn from_f64(x: f64) -> Self {
        Self::Constant(x)
    }
    fn lt(self, other: Self) -> bool {
        self.compare(other) == Some(Ordering::Less)
    }
    fn le(self, other: Self) -> bool {
        matches!(self.compare(other), Some(Ordering::Less | Ordering::Equal))
    }
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    fn abs(self) -> Self {
        self.unary(Unary::Abs)
    }
    fn sqrt(self) -> Self {
        self.unary(Unary::Sqrt)
    }
    fn exp(self) -> Self {
        self.unary(Unary::Exp)
    }
    fn exp_m1(self) -> Self {
        self.unary(Unary::ExpM1)
    }
    fn ln(self) -> Self {
        self.unary(Unary::Ln)
    }
    fn ln_1p(self) -> Self {
        self.unary(Unary::Ln1p)
    }
    fn sin(self) -> Self {
        self.unary(Unary::Sin)
    }
    fn cos(self) -> Self {
        self.unary(Unary::Cos)
    }
    fn tan(self) -> Self {
        self.unary(Unary::Tan)
    }
    fn asin(self) -> Self {
        self.unary(Unary::Asin)
    }
    fn acos(self) -> Self {
        self.unary(Unary::Acos)
    }
    fn atan(self) -> Self {
        self.unary(Unary::Atan)
    }
    fn atan2(self, x: Self) -> Self {
        self.binary(Binary::Atan2, x)
    }
    fn sinh(self) -> Self {
        self.unary(Unary::Sinh)
    }
    fn cosh(self) -> Self {
        self.unary(Unary::Cosh)
    }
    fn tanh(self) -> Self {
        self.unary(Unary::Tanh)
    }
    fn powf(self, n: Self) -> Self {
        match n {
            #[allow(
                clippy::cast_possible_truncation,
                reason = "a whole number of at most 64"
            )]
            Self::Constant(n) if n.fract() == 0.0 && n.abs() <= WHOLE_POWER => self.powi(n as i32),
            _ => self.binary(Binary::Power, n),
        }
    }
    fn powi(self, n: i32) -> Self {
        record(|r| {
            let x = self.node(&mut r.tape);
            Self::Node(r.tape.whole_power(x, n))
        })
    }
    fn max(self, other: Self) -> Self {
        self.binary(Binary::Max, other)
    }
    fn min(self, other: Self) -> Self {
        self.binary(Binary::Min, other)
    }
    fn hypot(self, other: Self) -> Self {
        (self * self + other * other).sqrt()
    }
}

impl Scalar for Trace {
    fn value(self) -> f64 {
        match self {
            Self::Constant(value) => value,
            Self::Node(_) => {
                record(|r| r.branched = true);
                f64::NAN
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Branch;
    impl Functions for Branch {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            f[0] = if x[0].value() > 0.0 {
                x[0]
            } else {
                x[0].square()
            };
        }
    }

    #[test]
    fn functions_that_branch_have_no_tape() {
        assert!(trace(&Branch, 1, 1).is_none());
    }
}
