//! Nonlinear least squares: Levenberg-Marquardt with bounds and Huber's loss, from many starts, and what
//! the data say about each parameter.
//!
//! Residuals are written once over a generic number ([`grouser_opt::Exact`]) or with their own derivatives
//! ([`grouser_opt::Model`]), each divided by its standard deviation.

mod between_tests;
mod eigen;
mod fit;
mod loss;
mod marquardt;
mod multi_start;
mod profile;
mod qr;
mod redundancy;
mod student;
mod uncertainty;

pub use fit::{Fit, Status};
pub use loss::Loss;
pub use marquardt::{Settings, fit};
pub use multi_start::{StartSettings, multi_start};
pub use profile::{Interval, profile};
pub(crate) use qr::solve_damped;
pub(crate) use redundancy::redundancy;
pub(crate) use student::NORMAL_MEDIAN_SIZE;
pub use student::student_quantile;
pub use uncertainty::{Uncertainty, Verdict};

use crate::error::{Error, Result};

/// One parameter: its bounds, where the search begins, and its natural size.
///
/// ```
/// use grouser_identify::least_squares::Bounded;
///
/// assert_eq!(Bounded::free(2.0).upper, f64::INFINITY);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    /// Where the search begins.
    pub start: f64,
    /// The least value.
    pub lower: f64,
    /// The greatest value.
    pub upper: f64,
}

impl Bounded {
    /// A parameter without bounds.
    #[must_use]
    pub const fn free(start: f64) -> Self {
        Self {
            start,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
        }
    }

    pub(crate) fn check(&self, index: usize) -> Result<()> {
        if self.start >= self.lower && self.start <= self.upper && self.start.is_finite() {
            Ok(())
        } else {
            Err(Error::Start {
                index,
                start: self.start,
                lower: self.lower,
                upper: self.upper,
            })
        }
    }
}
