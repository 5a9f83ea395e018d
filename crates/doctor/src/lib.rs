#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! | for | there is |
//! |---|---|
//! | mistakes over a log, row by row | [`Doctor`], [`Findings`], [`Mistake`] |
//! | a size of the speed over ground | [`WheelSign`] |
//!
//! The primary type is [`Doctor`]. It does not read logs, and estimates no slip.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod axes;
mod doctor;
mod encoder_signs;
mod exchange;
mod findings;
mod mistake;
mod motion;
mod paths;
mod pose;
mod speed_sign;
mod steering;
mod turn_pair;
mod turns;

pub use axes::AxisCheck;
pub use doctor::{Doctor, Window};
pub use exchange::ExchangeCheck;
pub use findings::{Findings, Uses};
pub use mistake::Mistake;
#[doc(hidden)]
pub use motion::{common_heading, displacement, wheel_travel};
pub use pose::{PoseCheck, PoseFault};
pub use speed_sign::WheelSign;
pub use steering::SteeringFault;
pub use turns::TurnCheck;
