#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is [`filter::SlipFilter`], which weighs all sensors together.
//! [`detect::Detector`] reports the events in its slips that an operator must know, and [`control::Controller`] drives the
//! wheels by them. [`prior`] holds what a soil model predicts of slip,
//! [`start::StartCheck`] compares the sensors with the robot's description before the first drive.
//!
//! Three outcomes are never mixed: a robot or settings that cannot be used are an [`Error`] with field,
//! value, limit and unit; a sample that cannot be used is a [`Fault`], which is counted and changes
//! nothing; an estimate that cannot be trusted has a [`Health`] that names the reason.
//!
//! The crate reads no files and knows neither terrain nor the robot's linkage.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

extern crate alloc;

mod body;
mod clock;
pub mod control;
mod counter;
pub mod detect;
mod error;
mod fault;
pub mod filter;
mod history;
mod measured_slip;
#[doc(hidden)]
pub mod modes;
#[doc(hidden)]
pub mod motion;
pub mod onboard;
mod period;
pub mod prior;
mod reference;
mod robot;
mod sample;
mod sensor_settings;
pub mod settings;
#[doc(hidden)]
pub mod smooth;
mod speed;
pub mod start;
mod state;
mod wheel_estimate;
mod wheel_steering;
mod wheel_track;

pub use body::BodyMotion;
pub use counter::{Counter, CounterWidth};
pub use error::{Error, Result};
pub use fault::{Fault, Rejected};
pub use grouser_terra::Slip;
pub use measured_slip::{MeasuredSlip, SlipLimits};
pub use reference::Reference;
pub use robot::{Encoder, MAX_WHEELS, Robot, Shaft, Wheel, WheelRole};
pub use sample::{
    Measurement, MeasurementField, MeasurementKind, MeasurementPart, MeasurementParts, Sample,
};
pub use sensor_settings::SensorSettings;
pub use speed::{Measured, MixedSpeed, PeriodSpeed};
pub use state::{Degraded, Health, Invalid, Motion};
pub use wheel_estimate::WheelEstimate;
#[doc(hidden)]
pub use wheel_steering::Steering;
