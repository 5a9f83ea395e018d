//! How a solve talks to its caller while it runs.

use core::ops::ControlFlow;

/// The state of a solve after an iteration.
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
    /// Iterations done.
    pub iteration: usize,
    /// The current point.
    pub x: &'a [f64],
    /// The current level γ: what is being minimised.
    pub utility: f64,
    /// The greatest violation of a nonlinear constraint.
    pub violation: f64,
    /// ‖∇L‖∞ with the latest multipliers.
    pub stationarity: f64,
}

/// Called once an iteration; `Break` ends the solve with [`Status::Stopped`](crate::Status::Stopped).
pub type Callback<'c> = dyn FnMut(&Progress<'_>) -> ControlFlow<()> + 'c;
