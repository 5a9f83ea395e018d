//! What the estimator knows after a sample.

use grouser_terra::Slip;

use crate::body::BodyMotion;
use crate::fault::Rejected;
use crate::speed::Measured;
use crate::state::{Health, Motion};

/// What is known after a sample.
#[derive(Clone, Copy, Debug)]
pub struct Estimate<'a> {
    /// The newest time of any sample, ns.
    pub time_ns: i64,
    /// One per wheel, in the robot's order.
    pub wheels: &'a [WheelEstimate],
    /// The robot as a whole.
    pub body: BodyEstimate,
    /// Samples refused so far.
    pub rejected: Rejected,
}

/// What is known of one wheel: means over the window that ends at `until_ns`.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// The end of the window, ns.
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

/// What is known of the robot as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyEstimate {
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
