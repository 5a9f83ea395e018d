#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! | for | there is |
//! |---|---|
//! | mistakes over a log, row by row | [`Doctor`], [`Findings`], [`Mistake`] |
//! | the start check of the robot, over a log | [`check_start`], [`StartOutcome`] |
//! | clocks that differ, readings that are repeated, before a run | [`gyro_offset`], [`ReferenceDelay`], [`Held`] |
//!
//! The primary type is [`Doctor`]. It does not read logs, and estimates no slip.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod axes;
mod distance;
mod doctor;
mod encoder_signs;
mod exchange;
mod findings;
mod frozen;
mod gyro_clock;
mod held;
mod mistake;
mod motion;
mod paths;
mod pose;
mod reference_delay;
mod speed_sign;
mod start;
mod steering;
mod turn_pair;
mod turns;
mod wiring;

pub use axes::AxisCheck;
pub use distance::DistanceCheck;
pub use doctor::{Doctor, Window};
pub use exchange::ExchangeCheck;
pub use findings::{Findings, Uses};
pub use gyro_clock::gyro_offset;
pub use held::{Held, HeldReference};
pub use mistake::Mistake;
pub use motion::wheel_travel;
pub use pose::{PoseCheck, PoseFault};
pub use reference_delay::{ReferenceDelay, Tracks};
pub use start::{StartOutcome, check_start};
pub use steering::SteeringFault;
pub use turns::TurnCheck;
