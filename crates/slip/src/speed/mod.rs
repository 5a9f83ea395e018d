//! Speed of rotation from an encoder's pulses, each law with its quantisation variance.
//!
//! | law | needs | variance of ω | good at |
//! |---|---|---|---|
//! | [`PeriodSpeed`] | the time of each edge | set by the timer and the change of speed | low speed |
//! | [`MixedSpeed`] | counts, and the times of first and last edge | (2π n/(N T²))² · σ_t² · 2 | all |

mod mixed;
mod period;

pub use mixed::MixedSpeed;
pub use period::PeriodSpeed;

/// A number with the variance of its error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Variance of its error, in its unit squared.
    pub variance: f64,
}

impl Measured {
    /// Standard deviation of its error.
    #[must_use]
    pub fn sigma(self) -> f64 {
        grouser_real::Real::sqrt(self.variance)
    }
}
