//! How several objectives become one question.

use crate::error::{Error, Result};
use crate::problem::Problem;

/// What "best" means when there are several objectives f_i.
///
/// ```
/// use grouser_opt::{Differences, Method, Problem, ProblemParams, Settings, solve};
///
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| {
///     f[0] = (x[0] - 1.0).powi(2);
///     f[1] = (x[0] + 1.0).powi(2);
/// });
/// let problem = Problem::new(ProblemParams::new(&[3.0], 2, model))?;
/// let settings = Settings::default();
/// // The worst of both is least half-way; a sum that weighs the first three times is least at 0.5.
/// let minimax = solve(&problem, &Method::Minimax, &settings)?;
/// assert!(minimax.x[0].abs() < 1e-6);
/// let weighted = solve(&problem, &Method::Weighted { weights: vec![3.0, 1.0] }, &settings)?;
/// assert!((weighted.x[0] - 0.5).abs() < 1e-6);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Method {
    /// Minimise max_i f_i(x): the best worst case.
    #[default]
    Minimax,
    /// Minimise γ subject to f_i(x) − w_i γ ≤ goal_i. A weight of 0 makes the goal a hard limit.
    Attain {
        /// goal_i, one per objective.
        goals: Vec<f64>,
        /// w_i ≥ 0, one per objective, at least one above 0.
        weights: Vec<f64>,
    },
    /// Minimise Σ w_i f_i(x). Of an objective in several worlds ([`ProblemParams::worlds`](crate::ProblemParams)) the worst
    /// w_i f_i counts alone.
    Weighted {
        /// w_i ≥ 0, one per objective, at least one above 0.
        weights: Vec<f64>,
    },
    /// Minimise max_i w_i (f_i(x) − ideal_i); an objective of weight 0 does not count.
    Chebyshev {
        /// ideal_i: the best that each objective could reach alone, or any point below the front.
        ideal: Vec<f64>,
        /// w_i ≥ 0, one per objective, at least one above 0.
        weights: Vec<f64>,
    },
}

impl Method {
    pub(crate) fn check(&self, problem: &Problem<'_>) -> Result<()> {
        let names = problem.objectives();
        let (points, weights) = match self {
            Self::Minimax => return Ok(()),
            Self::Attain { goals, weights } => (Some(("goal", goals)), weights),
            Self::Weighted { weights } => (None, weights),
            Self::Chebyshev { ideal, weights } => (Some(("ideal", ideal)), weights),
        };
        if let Some((field, values)) = points {
            Error::check_length(field, values.len(), names.len())?;
            for (name, &value) in names.iter().zip(values) {
                Error::check_finite(field, name, value)?;
            }
        }
        Error::check_length("weights", weights.len(), names.len())?;
        for (name, &weight) in names.iter().zip(weights) {
            Error::check_range(&format!("weight of `{name}`"), weight, 0.0, f64::MAX)?;
        }
        if weights.iter().all(|&w| w == 0.0) {
            return Err(Error::Empty {
                what: "objective with a weight above 0",
            });
        }
        Ok(())
    }
}
