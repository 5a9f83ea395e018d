//! What the models say of the motion together.

use grouser_real::Real;

use super::model::rim_share;
use crate::speed::Measured;

/// The estimate, along the direction of the rims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ModelMotion {
    /// Speed, m/s: that of the rims less the slip; and its share of theirs.
    pub(crate) speed: f64,
    pub(crate) rim_share: f64,
    /// Common slip and its standard deviation.
    pub(crate) slip: f64,
    pub(crate) slip_sigma: f64,
    /// Sideways over forward speed.
    pub(crate) drift: f64,
    pub(crate) drift_sigma: f64,
    /// Error of the turn rate, rad/s, and its variance.
    pub(crate) turn_error: Measured,
    /// Place and heading in the reference's frame.
    pub(crate) place: [f64; 2],
    pub(crate) heading: f64,
}

impl ModelMotion {
    /// With this share of the slip kept, and its prior (mean and standard deviation) for the rest, beside rims of `rim` (m/s).
    pub(super) fn faded(mut self, kept: f64, [mean, sigma]: [f64; 2], rim: f64) -> Self {
        if kept < 1.0 {
            self.slip = mean + kept * (self.slip - mean);
            let lost = Real::sqrt(1.0 - kept * kept) * sigma;
            self.slip_sigma = Real::hypot(kept * self.slip_sigma, lost);
            self.rim_share = rim_share(self.slip).0;
            self.speed = rim * self.rim_share;
        }
        self
    }
}
