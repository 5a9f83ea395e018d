//! The solve itself: a checked problem, a method, settings in; a solution out.

use core::ops::ControlFlow;

use crate::callback::Callback;
use crate::error::Result;
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
