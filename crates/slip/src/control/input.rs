//! What the controller is told and what it orders.

use super::decision::{Decision, Mode};
use crate::filter::SlipPrior;
use crate::state::{Health, Motion};

/// What is known of a wheel. Numbers that are NaN or infinite count as absent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSeen {
    /// Its slip as estimated.
    pub slip: Option<f64>,
    /// Sigma of it.
    pub sigma: Option<f64>,
    /// How far it can be trusted.
    pub health: Health,
    /// How it moves.
    pub motion: Option<Motion>,
    /// Speed of its centre along its heading, m/s.
    pub forward_speed: Option<f64>,
    /// Speed of its rim by its own encoder, m/s.
    pub rim_speed: Option<f64>,
    /// Torque over the motor's greatest, signed, from its current.
    pub torque_share: Option<f64>,
    /// Torque that it takes over what the known soil would take at its slip and load: well below 1 on softer ground.
    pub firmness: Option<f64>,
    /// Load that it carries, N, as known or measured.
    pub load: f64,
}

/// What is known at one moment, and what the drive asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlInput<'a> {
    /// Now, ns on any clock.
    pub time_ns: i64,
    /// One per wheel, in the robot's order.
    pub wheels: &'a [WheelSeen],
    /// Forward speed of the robot by its reference, m/s.
    pub speed: Option<f64>,
    /// Heading, rad.
    pub heading: Option<f64>,
    /// Pitch, nose down positive, rad.
    pub pitch: Option<f64>,
    /// Roll, right side down positive, rad.
    pub roll: Option<f64>,
    /// The slip that soil and slope demand as far as they are known; a ground that takes much more is another one.
    pub demanded: Option<SlipPrior>,
    /// Speed that the drive asks for, m/s.
    pub asked_speed: f64,
    /// Heading that it asks for, rad.
    pub asked_heading: f64,
}

/// What a motor driver is to do: run the rim at this speed with no more than this torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelOrder {
    /// m/s.
    pub rim_speed: f64,
    /// Greatest torque over load and radius of the wheel: traction is shared by load.
    pub traction: f64,
    /// Steering angle beside the wheel's heading in the description, rad.
    pub steer: f64,
}

/// What the controller gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlOutput<'a> {
    /// One per wheel, in the robot's order.
    pub orders: &'a [WheelOrder],
    /// What the robot does.
    pub mode: Mode,
    /// The heading that it steers, rad.
    pub heading: f64,
    /// Slip of the powered wheels, weighed by load and smoothed over a second.
    pub slip: f64,
    /// The decision taken in this step.
    pub decision: Option<Decision>,
}
