//! How a solve ended. None of these is an error.

/// A constraint that a point does not meet.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Violation {
    /// The constraint's name.
    pub name: String,
    /// By how much.
    pub amount: f64,
}

/// Which budget ran out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Limit {
    /// [`Settings::max_iterations`](crate::Settings::max_iterations).
    Iterations,
    /// [`Settings::max_values`](crate::Settings::max_values).
    Values,
}

/// The outcome of a solve.
///
/// ```
/// use grouser_opt::{Limit, Status};
///
/// assert!(Status::SmallStep.is_solved());
/// assert!(!Status::Limit(Limit::Values).is_solved());
/// assert_eq!(Status::Unbounded.name(), "unbounded");
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Status {
    /// The optimality conditions hold to the tolerance.
    Converged,
    /// No longer step could be taken; the optimality conditions hold less exactly than required.
    SmallStep,
    /// The model of the problem promises no decrease above rounding; the conditions hold less exactly
    /// than required.
    SmallDirectionalDerivative,
    /// No step improves on the point, yet the optimality conditions are far from holding: the functions
    /// have a kink here, or their derivatives are wrong.
    Stalled,
    /// A budget ran out.
    Limit(Limit),
    /// The caller said stop.
    Stopped,
    /// No point meets all constraints, as far as the search could see: the solution's `x` is the
    /// least-infeasible point found, and these constraints are violated there.
    NoFeasiblePoint(Vec<Violation>),
    /// A function or its gradient is not finite where the search must go.
    NotFinite {
        /// The function's name.
        function: String,
        /// Why, where the model says it ([`Model::failure`](crate::Model::failure)).
        reason: Option<String>,
    },
    /// The objective falls without limit.
    Unbounded,
}

impl Status {
    /// Is the point a solution: converged, or as near to it as rounding lets it come?
    #[must_use]
    pub fn is_solved(&self) -> bool {
        matches!(
            self,
            Self::Converged | Self::SmallStep | Self::SmallDirectionalDerivative
        )
    }

    /// The name used in files and JSON.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::SmallStep => "small_step",
            Self::SmallDirectionalDerivative => "small_directional_derivative",
            Self::Stalled => "stalled",
            Self::Limit(_) => "limit",
            Self::Stopped => "stopped",
            Self::NoFeasiblePoint(_) => "no_feasible_point",
            Self::NotFinite { .. } => "not_finite",
            Self::Unbounded => "unbounded",
        }
    }
}
