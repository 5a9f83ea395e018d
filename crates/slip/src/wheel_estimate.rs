//! The estimate of one wheel: its slip, its speeds, how it moves and how far that can be trusted.

use grouser_terra::Slip;

use crate::speed::Measured;
use crate::state::{Health, Motion};

/// What is known of one wheel after the step that ends at `until_ns`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelEstimate {
    /// The slip; `None` where there is none worth a number, and for a free wheel that is the reference.
    pub slip: Option<Slip>,
    /// Standard deviation of its error.
    pub sigma: Option<f64>,
    /// Speed of the wheel's centre along its heading by the reference, m/s.
    pub forward_speed: Option<Measured>,
    /// Circumferential speed, m/s.
    pub rim_speed: Option<Measured>,
    /// How it moves, once that is known.
    pub motion: Option<Motion>,
    /// How far this can be trusted.
    pub health: Health,
    /// The end of the step, ns.
    pub until_ns: Option<i64>,
    /// Seconds since its health was last Ok.
    pub last_good_age: Option<f64>,
}

impl WheelEstimate {
    pub(crate) const NOTHING: Self = Self {
        slip: None,
        sigma: None,
        forward_speed: None,
        rim_speed: None,
        motion: None,
        health: Health::Uninitialised,
        until_ns: None,
        last_good_age: None,
    };
}
