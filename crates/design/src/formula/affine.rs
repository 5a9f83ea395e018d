//! Is a formula linear in its variables, and with which coefficients?

use grouser_real::Real;

use super::program::{Formula, Step};

/// c + Σ a_i x_i.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Affine {
    pub(crate) constant: f64,
    pub(crate) coefficients: Vec<f64>,
}

impl Affine {
    fn constant(value: f64, variables: usize) -> Self {
        Self {
            constant: value,
            coefficients: vec![0.0; variables],
        }
    }

    fn is_constant(&self) -> bool {
        self.coefficients.iter().all(|a| *a == 0.0)
    }

    fn scaled(mut self, factor: f64) -> Self {
        self.constant *= factor;
        self.coefficients.iter_mut().for_each(|a| *a *= factor);
        self
    }

    fn plus(mut self, other: &Self) -> Self {
        self.constant += other.constant;
        for (a, b) in self.coefficients.iter_mut().zip(&other.coefficients) {
            *a += b;
        }
        self
    }
}

impl Formula {
    /// The formula as c + Σ a_i x_i over `variables` variables; `None` if it is not of that form, uses
    /// a variable beyond them, or has a coefficient that is not finite.
    pub(crate) fn affine(&self, variables: usize) -> Option<Affine> {
        let mut stack: Vec<Affine> = Vec::new();
        for step in &self.steps {
            let value = match *step {
                Step::Constant(value) => Affine::constant(value, variables),
                Step::Variable(index) => {
                    let mut one = Affine::constant(0.0, variables);
                    *one.coefficients.get_mut(index)? = 1.0;
                    one
                }
                Step::Negate => stack.pop()?.scaled(-1.0),
                Step::Add | Step::Subtract | Step::Multiply | Step::Divide => {
                    let right = stack.pop()?;
                    let left = stack.pop()?;
                    match step {
                        Step::Add => left.plus(&right),
                        Step::Subtract => left.plus(&right.scaled(-1.0)),
                        Step::Multiply if right.is_constant() => left.scaled(right.constant),
                        Step::Multiply if left.is_constant() => right.scaled(left.constant),
                        Step::Divide if right.is_constant() => left.scaled(1.0 / right.constant),
                        _ => return None,
                    }
                }
                // Functions and powers of constants are constants; of anything else they are not linear.
                Step::WholePower(1) => stack.pop()?,
                Step::WholePower(n) => {
                    let base = stack.pop()?;
                    base.is_constant()
                        .then(|| Affine::constant(Real::powi(base.constant, n), variables))?
                }
                Step::Power | Step::Call(..) => return None,
            };
            stack.push(value);
        }
        let result = stack.pop()?;
        let finite =
            result.constant.is_finite() && result.coefficients.iter().all(|a| a.is_finite());
        (stack.is_empty() && finite).then_some(result)
    }
}
