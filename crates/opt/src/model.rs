//! What a problem computes: the interface between the solvers and the user's functions.

use crate::jacobian::Jacobian;
use crate::parts::Parts;
use crate::tape::{Enclosures, Tape, TapedFunctions};
use crate::watch::Watch;

use grouser_real::Interval;

/// Objectives and nonlinear constraints as functions of the variables.
///
/// All functions are in one list: first the objectives, then the inequalities c(x) ≤ 0, then the
/// equalities c_eq(x) = 0. A function that has no value at a point gives NaN there; a solver steps
/// around such points and reports it if it cannot.
///
/// Three ways to get one: [`Exact`](crate::Exact) (written once over a generic number, exact
/// derivatives), [`Differences`](crate::Differences) (a closure, finite differences), or this trait
/// itself where the derivatives are known as formulas.
///
/// ```
/// use grouser_opt::{Jacobian, Method, Model, Problem, ProblemParams, Settings, solve};
///
/// /// x² with its derivative as a formula.
/// struct Parabola;
/// impl Model for Parabola {
///     fn values(&self, x: &[f64], values: &mut [f64]) {
///         values[0] = x[0] * x[0];
///     }
///     fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
///         self.values(x, values);
///         jacobian.set(0, 0, 2.0 * x[0]);
///     }
/// }
/// let problem = Problem::new(ProblemParams::new(&[3.0], 1, Parabola))?;
/// let solution = solve(&problem, &Method::Minimax, &Settings::default())?;
/// assert!(solution.x[0].abs() < 1e-6);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub trait Model: Sync {
    /// Writes the value of every function at `x`.
    fn values(&self, x: &[f64], values: &mut [f64]);

    /// Writes the value and the gradient of every function at `x`.
    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian);

    /// As [`values`](Self::values) or, with a Jacobian, [`derivatives`](Self::derivatives), followed by `watch`.
    #[doc(hidden)]
    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        _watch: &mut dyn Watch,
    ) {
        match jacobian {
            Some(jacobian) => self.derivatives(x, values, jacobian),
            None => self.values(x, values),
        }
    }

    /// Why a function has no value at `x`, in words for the user; `None` where every function has one or nothing is
    /// known. Asked for once, where a solve must end for it ([`Status::NotFinite`](crate::Status::NotFinite)).
    fn failure(&self, _x: &[f64]) -> Option<String> {
        None
    }

    /// All functions as operations on a tape, for bounds over boxes ([`certify`](crate::certify())); `None` where
    /// they are not known as such.
    fn taped(&self, _variables: usize, _functions: usize) -> Option<TapedFunctions> {
        None
    }

    /// What the functions are made of, where they are the greatest of many combinations.
    #[doc(hidden)]
    fn parts(&self) -> Option<&dyn Parts> {
        None
    }
}

/// Values and gradients at a point are the middles of their enclosures.
impl Model for TapedFunctions {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        let x: Vec<Interval> = x.iter().map(|x| Interval::point(*x)).collect();
        let mut at = Enclosures::default();
        at.forward(&self.tape, &x, &self.needed());
        for (value, node) in values.iter_mut().zip(&self.functions) {
            *value = middle(at.values[*node as usize]);
        }
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        let x: Vec<Interval> = x.iter().map(|x| Interval::point(*x)).collect();
        let mut at = Enclosures::default();
        at.forward(&self.tape, &x, &self.needed());
        let mut gradient = vec![Interval::ZERO; x.len()];
        for (row, node) in self.functions.iter().enumerate() {
            values[row] = middle(at.values[*node as usize]);
            let needed = self.tape.needed(*node);
            let regular = at.gradient(&self.tape, &needed, &[(*node, 1.0)], &mut gradient);
            for (slot, slope) in jacobian.row_mut(row).iter_mut().zip(&gradient) {
                *slot = if regular { middle(*slope) } else { f64::NAN };
            }
        }
    }

    fn taped(&self, _variables: usize, _functions: usize) -> Option<TapedFunctions> {
        let mut tape = Tape::new();
        let at = tape.append(&self.tape);
        let functions = self.functions.iter().map(|f| at[*f as usize]).collect();
        Some(TapedFunctions { tape, functions })
    }
}

/// The middle of a bounded enclosure, else NaN.
fn middle(x: Interval) -> f64 {
    if x.is_bounded() { x.middle() } else { f64::NAN }
}

impl<M: Model + ?Sized> Model for &M {
    fn failure(&self, x: &[f64]) -> Option<String> {
        (**self).failure(x)
    }
    fn values(&self, x: &[f64], values: &mut [f64]) {
        (**self).values(x, values);
    }
    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        (**self).derivatives(x, values, jacobian);
    }
    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        (**self).evaluate(x, values, jacobian, watch);
    }
    fn taped(&self, variables: usize, functions: usize) -> Option<TapedFunctions> {
        (**self).taped(variables, functions)
    }
    fn parts(&self) -> Option<&dyn Parts> {
        (**self).parts()
    }
}

impl<M: Model + ?Sized> Model for Box<M> {
    fn failure(&self, x: &[f64]) -> Option<String> {
        (**self).failure(x)
    }
    fn values(&self, x: &[f64], values: &mut [f64]) {
        (**self).values(x, values);
    }
    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        (**self).derivatives(x, values, jacobian);
    }
    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        (**self).evaluate(x, values, jacobian, watch);
    }
    fn taped(&self, variables: usize, functions: usize) -> Option<TapedFunctions> {
        (**self).taped(variables, functions)
    }
    fn parts(&self) -> Option<&dyn Parts> {
        (**self).parts()
    }
}
