//! What wheels and inertial sensors measure over one step, for one hypothesis.

/// The measurements of wheels and inertial sensors over one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// Length, s.
    pub(super) dt: f64,
    /// Way of the rims over the step, m, and its direction beside the robot's heading, rad.
    pub(super) rim_way: f64,
    pub(super) direction: f64,
    /// Turn of the robot over the step, rad.
    pub(super) turn: f64,
    /// Turn per way, rad/m, of a robot that turns as it is steered: in place of the turn.
    pub(super) curvature: Option<f64>,
    pub(super) turn_error: TurnError,
    /// By how much more than before the turn rate is reduced, rad/s.
    pub(super) removed: f64,
    /// Specific force along the direction, m/s², and its noise density, m/s/√s.
    pub(super) acceleration: Option<(f64, f64)>,
    /// The greatest slip of the rims together.
    pub(super) max_slip: f64,
}

/// What is known of the error of the turn rate.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TurnError {
    /// Does a gyro measure the turn rate, or do the wheels?
    pub(crate) by_gyro: bool,
    /// What the turn rate was reduced by already, rad/s.
    pub(crate) removed: f64,
    /// Standard deviation of the rest, rad/s.
    pub(crate) sigma: f64,
    /// How long it stays the same, s.
    pub(crate) memory: f64,
}

/// The rims' mean speed over their last window, which ties speed and slip.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rim {
    /// m/s.
    pub(crate) speed: f64,
    /// Variance of it, m²/s².
    pub(crate) variance: f64,
    /// By how much the window's middle lies before now, s.
    pub(crate) lag: f64,
    /// What the rims themselves show of their change since, m/s.
    pub(crate) rise: f64,
    /// Speed gained since by the specific force, m/s.
    pub(crate) gained: f64,
}
