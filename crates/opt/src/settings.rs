//! How hard and how exactly to solve.

use crate::error::{Error, Result};

/// Tolerances and limits of one solve.
///
/// ```
/// use grouser_opt::{Differences, Limit, Method, Problem, ProblemParams, Settings, Status, solve};
///
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = x[0].cosh());
/// let problem = Problem::new(ProblemParams::new(&[5.0], 1, model))?;
/// let mut settings = Settings::default();
/// settings.max_iterations = 1;
/// let solution = solve(&problem, &Method::Minimax, &settings)?;
/// assert_eq!(solution.status, Status::Limit(Limit::Iterations));
/// # Ok::<(), grouser_opt::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Converged needs complementarity ≤ this · (|γ| + F) and ‖∇L‖∞ ≤ this · max(Σ λ_i ‖∇f_i‖∞, G), where
    /// F is max |f_i| and G is max ‖∇f_i‖∞ at the start, or 1 where that is less.
    pub optimality_tolerance: f64,
    /// A constraint is met when it is violated by no more than this.
    pub constraint_tolerance: f64,
    /// A step shorter than this · (1 + ‖x‖∞) ends the solve.
    pub step_tolerance: f64,
    /// The maximum number of iterations.
    pub max_iterations: usize,
    /// The maximum number of evaluations of the functions (an evaluation with derivatives counts once here too).
    pub max_values: usize,
    /// Pairs of random probes around a point before it is called a solution, each second pair a hundred times longer, beside
    /// those along each variable and each gradient; 0 for no probes at all. From a probe that lowers the level the search starts again.
    pub probes: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            optimality_tolerance: 1e-8,
            constraint_tolerance: 1e-8,
            step_tolerance: 1e-14,
            max_iterations: 1000,
            max_values: 10_000,
            probes: 64,
        }
    }
}

impl Settings {
    pub(crate) fn check(&self) -> Result<()> {
        for (field, value) in [
            ("optimality_tolerance", self.optimality_tolerance),
            ("constraint_tolerance", self.constraint_tolerance),
            ("step_tolerance", self.step_tolerance),
        ] {
            Error::check_range(field, value, 0.0, 1.0)?;
        }
        Ok(())
    }
}
