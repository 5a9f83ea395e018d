//! The slip controller: what the robot does with what it knows of its slip.
//!
//! After fig. 11 of \[Ani2012\]: the estimated slip is compared with its setpoint; torque is raised or reduced wheel by
//! wheel; where that does not help the supervisor changes the robot's mode (traverse, back out, detour) or ends the drive.
//! Each [`Decision`] comes with its reason.
//!
//! ```text
//! rim_i = min( v_i* (1 + x),  v̂_i/(1 − s_i*) )      s_i* = s_opt + k_p e_i + k_i ∫ e_i dt,   e_i = s_opt − ŝ_i
//! ```
//!
//! with v_i* the setpoint of wheel i's speed, x the feedforward of slip, v̂_i and ŝ_i as estimated. The motor driver turns
//! the rim's speed into torque, up to a limit that shares the traction by load: a rim that runs slower pulls with less
//! torque. The integral moves only while slip limits the wheel (anti-windup).
//!
//! The primary type is [`Controller`]. It does not estimate: [`crate::onboard`] joins it with the filter.

mod command;
mod controller;
mod decision;
mod decision_queue;
mod feedforward;
mod geometry;
mod motor_guard;
mod observation;
mod sensor_watchdog;
mod settings;
mod supervisor;
mod wheel_controller;

pub use command::{ControlOutput, WheelCommand};
pub use controller::Controller;
pub use decision::{Action, Decision, Ending, Mode, Reason};
pub use observation::{ControlInput, Request, WheelObservation};
pub use settings::{ControlSettings, Decides};

/// A number that is finite.
fn finite(x: Option<f64>) -> Option<f64> {
    x.filter(|x| x.is_finite())
}
