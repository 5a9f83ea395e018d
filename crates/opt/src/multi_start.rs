//! One solver, many starts: how many different optima there are, and which is best.

use core::ops::ControlFlow;

use crate::callback::{Callback, Stage};
use crate::error::{Error, Result};
use crate::method::Method;
use crate::problem::Problem;
use crate::record::MAX_SOLVED_VIOLATION;
use crate::settings::Settings;
use crate::sobol::Sobol;
use crate::solution::{Counts, Solution};
use crate::solve::solve_with;
use crate::watched::watched;

/// Two solutions nearer than this share of the box in every variable are the same optimum.
const SAME_POINT: f64 = 1e-4;
/// Two solutions whose utilities differ by less than this · (1 + |utility|) are equally good.
const SAME_UTILITY: f64 = 1e-6;

/// A local optimum that one or more starts lead to.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Optimum {
    /// The run that found it best: an index into [`MultiStart::runs`].
    pub run: usize,
    /// Every run that led here, in order.
    pub reached_by: Vec<usize>,
}

/// What many starts found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MultiStart {
    /// The starts: the problem's own, then points spread evenly over the box; without those that a stop came before.
    pub starts: Vec<Vec<f64>>,
    /// One solution per start.
    pub runs: Vec<Solution>,
    /// The different optima among the solved runs, best first. More than one means that the answer
    /// depends on the start; several equally good ones mean that it is not unique.
    pub optima: Vec<Optimum>,
    /// What all runs cost together.
    pub counts: Counts,
    /// Did the caller stop it? Then some runs are [`Status::Stopped`](crate::Status::Stopped) or are not there.
    pub stopped: bool,
}

impl MultiStart {
    /// The best solution: of the runs that ended at a feasible point the best, a solved one among equally good ones; where there is
    /// none, the run with the least violation.
    #[must_use]
    pub fn best(&self) -> &Solution {
        let utility = |run: &Solution| run.utility;
        let feasible = self.runs.iter().filter(|run| {
            let is_feasible = run.kkt.violation <= MAX_SOLVED_VIOLATION;
            run.status.is_solved() || is_feasible && !run.utility.is_nan()
        });
        let least = feasible.clone().map(utility).fold(f64::INFINITY, f64::min);
        let allowed = least + SAME_UTILITY * (1.0 + least.abs());
        let solved = feasible
            .clone()
            .filter(|run| run.status.is_solved() && run.utility <= allowed);
        let by_utility = |a: &&Solution, b: &&Solution| a.utility.total_cmp(&b.utility);
        let by_violation =
            |a: &&Solution, b: &&Solution| a.kkt.violation.total_cmp(&b.kkt.violation);
        let best = solved
            .min_by(by_utility)
            .or_else(|| feasible.min_by(by_utility));
        best.or_else(|| self.runs.iter().min_by(by_violation))
            .unwrap_or(&self.runs[0])
    }

    /// Are there optima at different points whose utilities are the same?
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        let utility = |o: &Optimum| self.runs[o.run].utility;
        match self.optima.as_slice() {
            [first, second, ..] => {
                let best = utility(first);
                utility(second) - best <= SAME_UTILITY * (1.0 + best.abs())
            }
            _ => false,
        }
    }
}

/// Solves from the problem's own start and from `starts − 1` points of a Sobol sequence over the box.
///
/// The result does not depend on the number of threads.
///
/// # Errors
/// `starts` is 0, a variable lacks a finite bound, or what [`solve`](crate::solve) refuses.
///
/// ```
/// use grouser_opt::{Differences, Method, Problem, ProblemParams, Settings, Variable, multi_start};
///
/// // Two valleys of the same depth, at −1 and 1.
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = (x[0] * x[0] - 1.0).powi(2));
/// let params = ProblemParams::new(&[0.9], 1, model)
///     .variables([Variable::bounded("x", 0.9, -2.0, 2.0)]);
/// let found = multi_start(&Problem::new(params)?, &Method::Minimax, &Settings::default(), 8, 1)?;
/// assert_eq!(found.optima.len(), 2);
/// assert!(found.is_ambiguous());
/// assert!((found.best().x[0].abs() - 1.0).abs() < 1e-3);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub fn multi_start(
    problem: &Problem<'_>,
    method: &Method,
    settings: &Settings,
    starts: usize,
    seed: u64,
) -> Result<MultiStart> {
    multi_start_with(problem, method, settings, (starts, seed), &mut |_| {
        ControlFlow::Continue(())
    })
}

/// As [`multi_start`], calling `callback` on this thread for each iteration of each run: to show progress, or to stop all
/// of them. `starts` and their seed as there.
///
/// # Errors
/// As [`multi_start`].
///
/// ```
/// use std::ops::ControlFlow;
/// use grouser_opt::{
///     Differences, Method, Problem, ProblemParams, Settings, Variable, multi_start_with,
/// };
///
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = (x[0] * x[0] - 1.0).powi(2));
/// let params = ProblemParams::new(&[0.9], 1, model)
///     .variables([Variable::bounded("x", 0.9, -2.0, 2.0)]);
/// let problem = Problem::new(params)?;
/// let (method, settings) = (Method::Minimax, Settings::default());
/// let stop = &mut |_: &grouser_opt::Progress<'_>| ControlFlow::Break(());
/// let found = multi_start_with(&problem, &method, &settings, (100, 1), stop)?;
/// assert!(found.stopped && !found.runs.is_empty()); // the best so far is there
/// assert!(found.best().utility <= 1.0 + 9.0);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub fn multi_start_with(
    problem: &Problem<'_>,
    method: &Method,
    settings: &Settings,
    (starts, seed): (usize, u64),
    callback: &mut Callback<'_>,
) -> Result<MultiStart> {
    if starts == 0 {
        return Err(Error::Empty { what: "starts" });
    }
    let (lower, upper) = problem.finite_box("multi-start")?;
    let mut sobol = Sobol::new(lower.len(), Some(seed))?;
    let mut points: Vec<Vec<f64>> = vec![problem.variables().iter().map(|v| v.start).collect()];
    points.extend((1..starts).map(|_| sobol.next_in(&lower, &upper)));
    let (runs, stopped) = watched(
        &points,
        |done| Stage::Starts { done, of: starts },
        callback,
        |start, own| solve_with(&problem.from_start(start)?, method, settings, own),
    );
    let begun = points.into_iter().zip(runs);
    let begun = begun.filter_map(|(start, run)| Some(run?.map(|run| (start, run))));
    let (points, runs): (Vec<_>, Vec<_>) = begun.collect::<Result<Vec<_>>>()?.into_iter().unzip();
    let mut counts = Counts::default();
    for run in &runs {
        counts += run.counts;
    }
    Ok(MultiStart {
        optima: distinct(&runs, &lower, &upper),
        starts: points,
        runs,
        counts,
        stopped,
    })
}

/// Gathers the solved runs by where they ended.
fn distinct(runs: &[Solution], lower: &[f64], upper: &[f64]) -> Vec<Optimum> {
    let mut order: Vec<usize> = (0..runs.len())
        .filter(|&i| runs[i].status.is_solved())
        .collect();
    order.sort_by(|&a, &b| runs[a].utility.total_cmp(&runs[b].utility));
    let same = |a: &Solution, b: &Solution| {
        let widths = lower.iter().zip(upper).map(|(low, high)| high - low);
        a.x.iter()
            .zip(&b.x)
            .zip(widths)
            .all(|((a, b), width)| (a - b).abs() <= SAME_POINT * width)
    };
    let mut optima: Vec<Optimum> = Vec::new();
    for run in order {
        match optima.iter_mut().find(|o| same(&runs[o.run], &runs[run])) {
            Some(known) => known.reached_by.push(run),
            None => optima.push(Optimum {
                run,
                reached_by: vec![run],
            }),
        }
    }
    for optimum in &mut optima {
        optimum.reached_by.sort_unstable();
    }
    optima
}

#[cfg(test)]
#[path = "multi_start_tests.rs"]
mod tests;
