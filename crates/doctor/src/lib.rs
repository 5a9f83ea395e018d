#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! | for | there is |
//! |---|---|
//! | mistakes over a log, row by row | [`Doctor`], [`Findings`], [`Mistake`] |
//! | the start check of the robot, over a log | [`check_start`], [`StartOutcome`] |
//! | clocks that differ, readings that are repeated or frozen, before a run | [`gyro_offset`], [`ReferenceDelay`], [`Held`], [`Frozen`] |
//!
//! The primary type is [`Doctor`]. It does not read logs, and estimates no slip.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod causes;
mod comparison;
mod courses;
mod distance;
mod doctor;
mod findings;
mod frozen;
mod held;
mod mistake;
mod motion;
mod passed;
mod reference_delay;
mod speeds;
mod start;
mod steering;
mod turning;
mod turns;
mod window;
mod wiring;

pub use distance::DistanceCheck;
pub use doctor::Doctor;
pub use findings::{AxisCheck, Findings, Uses};
pub use frozen::Frozen;
pub use held::{Held, HeldReference};
pub use mistake::{Mistake, PoseFault, SteeringFault};
pub use motion::wheel_travel;
pub use passed::{KnownStep, Pairing, Passed};
pub use reference_delay::{ReferenceDelay, Tracks, gyro_offset};
pub use start::{StartOutcome, check_start};
pub use turns::TurnCheck;
