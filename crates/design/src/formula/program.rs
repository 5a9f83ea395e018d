//! A formula ready to be computed: a list of steps on a stack of numbers, without recursion.

use grouser_opt::{Binary, Node, Tape, Unary};
use grouser_real::Real;
use grouser_real::Scalar;

/// A function of one number, or of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Exp,
    Ln,
    Log10,
    Sqrt,
    Abs,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Min,
    Max,
    Atan2,
    Pow,
}

impl Function {
    pub(super) const ALL: [(&'static str, Self); 18] = [
        ("exp", Self::Exp),
        ("ln", Self::Ln),
        ("log10", Self::Log10),
        ("sqrt", Self::Sqrt),
        ("abs", Self::Abs),
        ("sin", Self::Sin),
        ("cos", Self::Cos),
        ("tan", Self::Tan),
        ("asin", Self::Asin),
        ("acos", Self::Acos),
        ("atan", Self::Atan),
        ("sinh", Self::Sinh),
        ("cosh", Self::Cosh),
        ("tanh", Self::Tanh),
        ("min", Self::Min),
        ("max", Self::Max),
        ("atan2", Self::Atan2),
        ("pow", Self::Pow),
    ];

    fn unary(self) -> Option<Unary> {
        Some(match self {
            Self::Exp => Unary::Exp,
            Self::Ln => Unary::Ln,
            Self::Log10 => Unary::Log10,
            Self::Sqrt => Unary::Sqrt,
            Self::Abs => Unary::Abs,
            Self::Sin => Unary::Sin,
            Self::Cos => Unary::Cos,
            Self::Tan => Unary::Tan,
            Self::Asin => Unary::Asin,
            Self::Acos => Unary::Acos,
            Self::Atan => Unary::Atan,
            Self::Sinh => Unary::Sinh,
            Self::Cosh => Unary::Cosh,
            Self::Tanh => Unary::Tanh,
            Self::Min | Self::Max | Self::Atan2 | Self::Pow => return None,
        })
    }

    fn binary(self) -> Option<Binary> {
        match self {
            Self::Min => Some(Binary::Min),
            Self::Max => Some(Binary::Max),
            Self::Atan2 => Some(Binary::Atan2),
            Self::Pow => Some(Binary::Power),
            _ => None,
        }
    }

    /// The least and greatest number of arguments, and how messages say it.
    pub(super) fn arguments(self) -> (usize, usize, &'static str) {
        match self {
            Self::Min | Self::Max => (2, usize::MAX, "two or more"),
            Self::Atan2 | Self::Pow => (2, 2, "two"),
            _ => (1, 1, "one"),
        }
    }
}

/// One step of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    Constant(f64),
    Variable(usize),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    /// A small whole power, which is exact where `Power` is not.
    WholePower(i32),
    /// The number of arguments determines how often a function of two is applied.
    Call(Function, usize),
}

/// A formula over numbered variables.
///
/// ```
/// use grouser_design::{Formula, VariableNames};
/// use grouser_real::Dual;
///
/// let formula = Formula::parse("-x^2 + 1e-8*y", &VariableNames::new(["x", "y"]))?;
/// assert_eq!(formula.evaluate(&[3.0, 0.0]), -9.0); // a power binds tighter than a sign
/// assert_eq!(formula.evaluate(&[Dual::<1>::variable(3.0, 0), Dual::constant(0.0)]).gradient, [-6.0]);
/// # Ok::<(), grouser_design::FormulaError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    pub(super) steps: Vec<Step>,
}

impl Formula {
    /// The formula's value, where `x` holds the variables; NaN where it has none.
    pub fn evaluate<R: Scalar>(&self, x: &[R]) -> R {
        let mut stack: Vec<R> = Vec::with_capacity(16);
        for step in &self.steps {
            apply(*step, &mut stack, x);
        }
        stack.pop().unwrap_or(R::from_f64(f64::NAN))
    }

    /// The formula's operations on a tape, where `numbers` holds the nodes of the variables; `None` where one has none.
    pub(crate) fn onto(&self, tape: &mut Tape, numbers: &[Option<Node>]) -> Option<Node> {
        let mut stack: Vec<Node> = Vec::new();
        for step in &self.steps {
            let node = match *step {
                Step::Constant(value) => tape.constant(value),
                Step::Variable(index) => numbers.get(index).copied().flatten()?,
                Step::Negate => {
                    let x = stack.pop()?;
                    tape.unary(Unary::Neg, x)
                }
                Step::WholePower(n) => {
                    let x = stack.pop()?;
                    tape.whole_power(x, n)
                }
                Step::Call(function, 1) => {
                    let x = stack.pop()?;
                    tape.unary(function.unary()?, x)
                }
                Step::Call(function, count) => {
                    let mut value = stack.pop()?;
                    for _ in 1..count {
                        let left = stack.pop()?;
                        value = tape.binary(function.binary()?, left, value);
                    }
                    value
                }
                Step::Add | Step::Subtract | Step::Multiply | Step::Divide | Step::Power => {
                    let (right, left) = (stack.pop()?, stack.pop()?);
                    let function = match step {
                        Step::Add => Binary::Add,
                        Step::Subtract => Binary::Sub,
                        Step::Multiply => Binary::Mul,
                        Step::Divide => Binary::Div,
                        _ => Binary::Power,
                    };
                    tape.binary(function, left, right)
                }
            };
            stack.push(node);
        }
        stack.pop()
    }

    /// The numbers of the variables that occur, each once, in rising order.
    ///
    /// ```
    /// use grouser_design::{Formula, VariableNames};
    ///
    /// let formula = Formula::parse("c + a*c", &VariableNames::new(["a", "b", "c"]))?;
    /// assert_eq!(formula.variables(), [0, 2]);
    /// # Ok::<(), grouser_design::FormulaError>(())
    /// ```
    #[must_use]
    pub fn variables(&self) -> Vec<usize> {
        let mut list: Vec<usize> = self
            .steps
            .iter()
            .filter_map(|step| match step {
                Step::Variable(index) => Some(*index),
                _ => None,
            })
            .collect();
        list.sort_unstable();
        list.dedup();
        list
    }

    /// This formula less another.
    pub(crate) fn minus(mut self, other: &Self) -> Self {
        self.steps.extend(&other.steps);
        self.steps.push(Step::Subtract);
        self
    }

    /// This formula with its sign changed.
    pub(crate) fn negated(mut self) -> Self {
        self.steps.push(Step::Negate);
        self
    }
}

fn apply<R: Scalar>(step: Step, stack: &mut Vec<R>, x: &[R]) {
    let nan = R::from_f64(f64::NAN);
    let value = match step {
        Step::Constant(value) => R::from_f64(value),
        Step::Variable(index) => x.get(index).copied().unwrap_or(nan),
        Step::Negate => -stack.pop().unwrap_or(nan),
        Step::WholePower(n) => stack.pop().unwrap_or(nan).powi(n),
        Step::Call(function, count) => {
            let mut value = stack.pop().unwrap_or(nan);
            match count {
                1 => value = call(function, value),
                // From the right: f(a, b, c) = f(a, f(b, c)), which for min and max is the same either way.
                _ => {
                    for _ in 1..count {
                        value = call_two(function, stack.pop().unwrap_or(nan), value);
                    }
                }
            }
            value
        }
        Step::Add | Step::Subtract | Step::Multiply | Step::Divide | Step::Power => {
            let right = stack.pop().unwrap_or(nan);
            let left = stack.pop().unwrap_or(nan);
            match step {
                Step::Add => left + right,
                Step::Subtract => left - right,
                Step::Multiply => left * right,
                Step::Divide => left / right,
                _ => left.powf(right),
            }
        }
    };
    stack.push(value);
}

fn call<R: Scalar>(function: Function, x: R) -> R {
    match function {
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Log10 => {
            // ln x/ln 10 is off by a rounding even at powers of ten; its value is replaced by the exact one.
            let scaled = x.ln() * R::from_f64(std::f64::consts::LOG10_E);
            let exact = Real::log10(x.value());
            if exact.is_finite() {
                scaled + R::from_f64(exact - scaled.value())
            } else {
                scaled
            }
        }
        Function::Sqrt => x.sqrt(),
        Function::Abs => x.abs(),
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Tan => x.tan(),
        Function::Asin => x.asin(),
        Function::Acos => x.acos(),
        Function::Atan => x.atan(),
        Function::Sinh => x.sinh(),
        Function::Cosh => x.cosh(),
        Function::Tanh => x.tanh(),
        Function::Min | Function::Max | Function::Atan2 | Function::Pow => R::from_f64(f64::NAN),
    }
}

fn call_two<R: Scalar>(function: Function, a: R, b: R) -> R {
    // `min` and `max` would let one NaN go.
    if a.value().is_nan() || b.value().is_nan() {
        return R::from_f64(f64::NAN);
    }
    match function {
        Function::Min => a.min(b),
        Function::Max => a.max(b),
        Function::Atan2 => a.atan2(b),
        Function::Pow => a.powf(b),
        _ => R::from_f64(f64::NAN),
    }
}
