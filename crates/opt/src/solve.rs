//! The solve itself: a checked problem, a method, settings in; a solution out.

use core::ops::ControlFlow;

use crate::best::Best;
use crate::callback::Callback;
use crate::error::{Error, Result};
use crate::merit::Merit;
use crate::method::Method;
use crate::problem::Problem;
use crate::program::Program;
use crate::settings::Settings;
use crate::solution::{Counts, Solution};
use crate::status::Status;
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
    let best = Best::new(problem, method, settings);
    let search = Search {
        recorded: problem.recorded(&best),
        method,
        best: &best,
    };
    let mut solution = search.run(settings, callback, Counts::default(), None)?;
    let mut from: Option<Vec<f64>> = None;
    for restarts in 0.. {
        let Some(better) = best.better_than(&solution) else {
            break;
        };
        let has_ended = matches!(
            solution.status,
            Status::Stopped | Status::Limit(_) | Status::Unbounded
        );
        if has_ended || restarts == RESTARTS || from.as_ref() == Some(&better.x) {
            return search.ended_at(&better.x, settings, callback, solution);
        }
        solution = search.run(settings, callback, solution.counts, Some(&better.x))?;
        from = Some(better.x);
    }
    Ok(solution)
}

/// Searches from points that refute a solution before the best of them is the answer.
const RESTARTS: usize = 20;

/// A problem whose evaluations are noted, with its method.
struct Search<'p> {
    recorded: Problem<'p>,
    method: &'p Method,
    best: &'p Best<'p>,
}

impl Search<'_> {
    /// One search, from the problem's start or from another one.
    fn run(
        &self,
        settings: &Settings,
        callback: &mut Callback<'_>,
        counts: Counts,
        from: Option<&[f64]>,
    ) -> Result<Solution> {
        let moved = from.map(|x| self.recorded.from_start(x)).transpose()?;
        let problem = moved.as_ref().unwrap_or(&self.recorded);
        match self.method {
            Method::Weighted { weights } => {
                weighted::solve(problem, weights, settings, callback, counts)
            }
            _ => Ok(sqp::solve(problem, self.method, settings, callback, counts)),
        }
    }

    /// The solution at a point that is better than where the searches ended: what holds there, and `stalled` where that is no
    /// optimum and nothing else ended the search.
    fn ended_at(
        &self,
        x: &[f64],
        settings: &Settings,
        callback: &mut Callback<'_>,
        ended: Solution,
    ) -> Result<Solution> {
        let status = match ended.status.clone() {
            status if status.is_solved() => Status::Stalled,
            Status::NoFeasiblePoint(_) => Status::Stalled,
            status => status,
        };
        let last = if status == Status::Stopped {
            ended
        } else {
            let only_there = Settings {
                max_iterations: 0,
                probes: 0,
                ..settings.clone()
            };
            self.run(&only_there, callback, ended.counts, Some(x))?
        };
        Ok(match self.best.better_than(&last) {
            Some(better) => self.best.solution(better, last, status),
            None if last.status.is_solved() => last,
            None => Solution { status, ..last },
        })
    }
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
    let mut functions = vec![f64::NAN; problem.function_count()];
    problem.model().values(x, &mut functions);
    let program = Program::new(problem, method);
    Ok(Merit::at(&program, method, x, &functions))
}
