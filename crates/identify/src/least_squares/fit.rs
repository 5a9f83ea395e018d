//! What a fit found.

use super::Bounded;

/// How a fit ended.
///
/// ```
/// use grouser_identify::least_squares::Status;
///
/// assert!(Status::Stalled.is_solved() && !Status::StepLimit.is_solved());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The residuals are perpendicular to every direction in which the parameters may move.
    Converged,
    /// No further step lowers the cost by more than rounding.
    Stalled,
    /// The limit of steps was reached.
    StepLimit,
    /// The residuals have no value at the start.
    NoValue,
}

impl Status {
    /// Is the answer a local minimum as far as rounding lets one see?
    #[must_use]
    pub const fn is_solved(self) -> bool {
        matches!(self, Self::Converged | Self::Stalled)
    }

    /// Its name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Stalled => "stalled",
            Self::StepLimit => "step-limit",
            Self::NoValue => "no-value",
        }
    }
}

/// A fit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fit {
    /// How it ended.
    pub status: Status,
    /// The parameters.
    pub x: Vec<f64>,
    /// The residuals there, in standard deviations.
    pub residuals: Vec<f64>,
    /// Their derivatives by row.
    pub jacobian: Vec<Vec<f64>>,
    /// The sum of the losses.
    pub cost: f64,
    /// Evaluations of the residuals.
    pub evaluations: u32,
    /// Evaluations of the derivatives.
    pub jacobians: u32,
    /// The bounds.
    pub bounds: Vec<Bounded>,
}

impl Fit {
    /// Does parameter `index` lie on a bound?
    #[must_use]
    pub fn on_bound(&self, index: usize) -> bool {
        let (x, bound) = (self.x[index], &self.bounds[index]);
        x <= bound.lower || x >= bound.upper
    }

    /// Is parameter `index` an offset, whose bounds are symmetric about 0? It is not judged by its own size.
    pub(crate) fn is_offset(&self, index: usize) -> bool {
        let bound = &self.bounds[index];
        bound.lower == -bound.upper && bound.upper.is_finite()
    }
}
