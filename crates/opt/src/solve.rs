//! The solve itself: a checked problem, a method, settings in; a solution out.

use core::ops::ControlFlow;

use crate::callback::Callback;
use crate::error::{Error, Result};
use crate::method::Method;
use crate::problem::Problem;
use crate::settings::Settings;
use crate::solution::Solution;
use crate::{sqp, weighted};

/// Solves a problem from its start.
///
/// # Errors
/// The method's goals or weights do not fit the problem, or a setting is out of its range. A solve
/// that finds no answer is no error: read [`Solution::status`].
///
/// ```
/// use grouser_opt::{Differences, Method, Problem, ProblemParams, Settings, solve};
///
/// // max(x, −x) is least at its kink.
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| (f[0], f[1]) = (x[0], -x[0]));
/// let problem = Problem::new(ProblemParams::new(&[3.0], 2, model))?;
/// let solution = solve(&problem, &Method::Minimax, &Settings::default())?;
/// assert!(solution.status.is_solved() && solution.maximum.abs() < 1e-9);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub fn solve(problem: &Problem<'_>, method: &Method, settings: &Settings) -> Result<Solution> {
    solve_with(
        problem,
        method,
        settings,
        &mut |_| ControlFlow::Continue(()),
    )
}

/// As [`solve`], calling `callback` once an iteration: to show progress, or to stop.
///
/// # Errors
/// As [`solve`].
pub fn solve_with(
    problem: &Problem<'_>,
    method: &Method,
    settings: &Settings,
    callback: &mut Callback<'_>,
) -> Result<Solution> {
    settings.check()?;
    method.check(problem)?;
    match method {
        Method::Weighted { weights } => weighted::solve(problem, weights, settings, callback),
        _ => Ok(sqp::solve(problem, method, settings, callback)),
    }
}

/// What a solve minimises and what it must not violate, at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Merit {
    /// What is minimised: the greatest (scaled) objective, or their weighted sum.
    pub utility: f64,
    /// The greatest violation of any constraint or bound; 0 where all hold.
    pub violation: f64,
}

/// The merit of a point, for comparison with a solution's.
///
/// ```
/// use grouser_opt::{Exact, Functions, Method, Problem, ProblemParams, evaluate};
/// use grouser_real::Scalar;
/// struct Parabola;
/// impl Functions for Parabola {
///     fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
///         f[0] = x[0].square();
///     }
/// }
/// let problem = Problem::new(ProblemParams::new(&[1.0], 1, Exact(Parabola)))?;
/// assert_eq!(evaluate(&problem, &Method::Minimax, &[3.0])?.utility, 9.0);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
///
/// # Errors
/// As [`solve`]; a point of the wrong length.
pub fn evaluate(problem: &Problem<'_>, method: &Method, x: &[f64]) -> Result<Merit> {
    method.check(problem)?;
    Error::check_length("the point", x.len(), problem.variables().len())?;
    let (utility, violation) = sqp::merit(problem, method, x);
    let weighted = match method {
        Method::Weighted { weights } => weighted::utility(problem, weights, x),
        _ => utility,
    };
    Ok(Merit {
        utility: weighted,
        violation,
    })
}
