//! What the controller gives: a command for each wheel, the mode, and the decision of the step.

use super::decision::{Decision, Mode};

/// What a wheel's motor driver and steering are to do.
///
/// The motor driver holds the rim's speed with no more torque than `traction` · load · radius, so that traction is
/// shared by load. The default is a wheel at rest without torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelCommand {
    /// Speed of the rim, m/s.
    pub rim_speed: f64,
    /// Greatest torque over load and radius of the wheel, 1.
    pub traction: f64,
    /// Steering angle beside the wheel's heading in the robot's description, rad.
    pub steering_angle: f64,
}

/// The result of one step of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ControlOutput<'a> {
    /// One per wheel, in the robot's order.
    pub commands: &'a [WheelCommand],
    /// What the robot does.
    pub mode: Mode,
    /// Setpoint of the heading, rad.
    pub heading: f64,
    /// Slip of the powered wheels, weighted by load and smoothed over a second.
    pub slip: f64,
    /// The decision of this step.
    pub decision: Option<Decision>,
}

/// Setpoints of the robot as a whole, from which those of the wheels follow.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionCommand {
    /// Forward speed, m/s.
    pub(super) speed: f64,
    /// Yaw rate, rad/s.
    pub(super) yaw_rate: f64,
    /// Heading, rad.
    pub(super) heading: f64,
    /// Does slip limit the wheels? Not while the robot turns on the spot.
    pub(super) limits_slip: bool,
    /// Has the drive ended?
    pub(super) stopped: bool,
    /// The slip setpoint: the optimum, or what the ground demands.
    pub(super) slip: f64,
    /// Share of its speed at which a rim runs at least.
    pub(super) min_speed_share: f64,
}
