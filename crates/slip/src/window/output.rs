//! The output of the window estimator.

use grouser_terra::Slip;

use crate::body::BodyMotion;
use crate::speed::Measured;
use crate::state::Motion;
use crate::wheel_estimate::WheelEstimate;

/// What is known after a sample.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct WindowOutput<'a> {
    /// The newest time of any sample, ns.
    pub time_ns: i64,
    /// One per wheel, in the robot's order.
    pub wheels: &'a [WheelEstimate],
    /// The robot as a whole.
    pub body: WindowBody,
}

/// What is known of the robot as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindowBody {
    /// Its motion by the reference.
    pub motion: Option<BodyMotion>,
    /// The motion that its powered wheels would give it without slip.
    pub wheels_motion: Option<BodyMotion>,
    /// Slip of the robot along its track: the wheels' motion against the reference's, in the direction
    /// of the command, or of the wheels' motion where there is no command.
    pub along: Option<Slip>,
    /// Standard deviation of its error.
    pub along_sigma: Option<f64>,
    /// How the robot moves along its track.
    pub along_motion: Option<Motion>,
    /// Yaw rate by gyro or by the reference, rad/s.
    pub yaw_rate: Option<Measured>,
    /// Yaw rate that the powered wheels would give without slip, rad/s.
    pub wheels_yaw_rate: Option<Measured>,
    /// How far the wheels say the robot went along its track while it moved, m: the distance without
    /// compensation.
    pub travel_wheels: f64,
    /// How far it went along its track while it moved, by the reference, m.
    pub travel_reference: f64,
    /// The end of the window, ns.
    pub until_ns: Option<i64>,
}
