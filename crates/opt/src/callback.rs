//! How a solve talks to its caller while it runs.

use core::ops::ControlFlow;

/// The state of a solve after an iteration.
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
