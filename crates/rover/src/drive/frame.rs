//! A moment of a simulated drive: what is true beside what is estimated.

use grouser_slip::Sample;
use grouser_slip::control::{Mode, WheelObservation};
use grouser_slip::onboard::SoilEstimate;

use crate::robot::Actuator;

/// A wheel in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelFrame {
    /// True slip over the estimator's window.
    pub slip: Option<f64>,
    /// True slip at this moment.
    pub slip_now: Option<f64>,
    /// What the robot's computer knows.
    pub observation: WheelObservation,
    /// Torque of the motor, N m.
    pub torque: f64,
    /// Load, N.
    pub load: f64,
    /// Sinkage, m.
    pub sinkage: f64,
    /// Speed of the rim and of the centre along its heading, m/s.
    pub speeds: [f64; 2],
    /// The ground's force along its heading and to the left, N.
    pub forces: [f64; 2],
    /// Place of its centre in the world, m.
    pub place: [f64; 3],
    /// Its direction in the world, rad from x towards y.
    pub heading: f64,
}

/// What is true and what is known at one moment.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Frame<'a> {
    /// s since the start.
    pub time: f64,
    /// m.
    pub place: [f64; 3],
    /// Roll, pitch, yaw, rad.
    pub angles: [f64; 3],
    /// True forward speed, m/s.
    pub speed: f64,
    /// Estimated forward speed, m/s.
    pub estimated_speed: Option<f64>,
    /// What the robot does.
    pub mode: Mode,
    /// Requested speed, m/s.
    pub requested_speed: f64,
    /// Electrical energy so far, J.
    pub energy: f64,
    /// Progress along the legs, m.
    pub distance: f64,
    /// True margin against tipping over, rad, of a chassis with actuators.
    pub tip_over_margin: Option<f64>,
    /// The actuators of the chassis, with where they are.
    pub actuators: &'a [Actuator],
    /// The wheels.
    pub wheels: &'a [WheelFrame],
    /// The controller's slip setpoint: once soil is learnt, the slip of maximum tractive efficiency on it.
    pub optimum: f64,
    /// What the robot's computer has learnt of the soil, where it learns.
    pub soil: Option<SoilEstimate>,
    /// The samples that arrived in this period.
    pub samples: &'a [Sample],
}
