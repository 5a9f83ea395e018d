//! How a solve talks to its caller while it runs.

use core::ops::ControlFlow;

/// What a solver is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// One solve.
    Solve,
    /// Solves from several starts, of which `done` are done.
    Starts {
        /// Starts that are done.
        done: usize,
        /// All of them.
        of: usize,
    },
    /// The evolutionary search for a front: `done` generations are.
    Generations {
        /// Generations that are done.
        done: usize,
        /// All of them.
        of: usize,
    },
    /// The points of a front are made exact.
    Polishing {
        /// Points that are done.
        done: usize,
        /// All of them.
        of: usize,
    },
}

/// The state of a solve after an iteration, or of a front after a generation.
///
/// ```
/// use std::ops::ControlFlow;
/// use grouser_opt::{Differences, Method, Problem, ProblemParams, Progress, Settings, Status, solve_with};
///
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = (x[0] - 1.0).powi(2));
/// let problem = Problem::new(ProblemParams::new(&[5.0], 1, model))?;
/// let mut stop = |progress: &Progress<'_>| {
///     assert!(progress.utility <= 16.0); // no iterate is worse than the start
///     ControlFlow::Break(())
/// };
/// let solution = solve_with(&problem, &Method::Minimax, &Settings::default(), &mut stop)?;
/// assert_eq!(solution.status, Status::Stopped);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Progress<'a> {
    /// What the solver is at.
    pub stage: Stage,
    /// Iterations done of this solve, or generations.
    pub iteration: usize,
    /// The current point; of a generation the one that violates least, then the one whose greatest objective is least.
    pub x: &'a [f64],
    /// The current level γ: what is being minimised. Of a generation the greatest objective at `x`.
    pub utility: f64,
    /// The greatest violation of a nonlinear constraint; of a generation their sum.
    pub violation: f64,
    /// ‖∇L‖∞ with the latest multipliers; `None` of a generation, within a large subproblem, which computes them, and
    /// within an evaluation of many worlds.
    pub stationarity: Option<f64>,
}

/// Called once an iteration or generation, before each probe around a solution, about ten times a second within a large
/// subproblem, and after every 64 worlds of a robust problem that are evaluated; `Break` ends the search with what it has found so far ([`Status::Stopped`](crate::Status::Stopped),
/// [`MultiStart::stopped`](crate::MultiStart::stopped), [`Front::stopped`](crate::Front::stopped)).
pub type Callback<'c> = dyn FnMut(&Progress<'_>) -> ControlFlow<()> + 'c;
