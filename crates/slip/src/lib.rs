//! The slip of every wheel of a robot, on the robot: encoder counts, gyro, accelerometer and measured motion go in one
//! sample at a time; each wheel's slip comes out with its sigma and its health. It needs no operating system: time is an
//! argument, and nothing is allocated after construction.
//!
//! ```text
//! v_i = e_i · (v_body + Ω × p_i)        s_i = 1 − v_i/(r ω_i) driving        s_i = r ω_i/v_i − 1 braking
//! ```
//!
//! ```
//! use grouser_slip::filter::{FilterSettings, SlipFilter};
//! use grouser_slip::{Measurement, Robot, Sample, Wheel};
//!
//! let wheels = vec![
//!     Wheel::powered("drive").at(0.3, 0.0).radius(0.1).ticks_per_turn(1000),
//!     Wheel::free("fifth").at(-0.3, 0.0).radius(0.1).ticks_per_turn(1000),
//! ];
//! let robot = Robot::new("bicycle".into(), wheels)?;
//! let mut filter = SlipFilter::new(&robot, FilterSettings::default())?;
//! for step in 0..300_u64 {
//!     let time_ns = step as i64 * 10_000_000;
//!     // The powered wheel turns 10 ticks a step, the free one 8: the robot travels at 80 % of the rim speed.
//!     for (wheel, raw) in [(0, 10 * step), (1, 8 * step)] {
//!         filter.update(Sample { time_ns, measurement: Measurement::WheelCount { wheel, raw } })?;
//!     }
//!     filter.update(Sample { time_ns, measurement: Measurement::YawRate { rate: 0.0 } })?;
//! }
//! let drive = filter.latest().wheels[0];
//! assert!((drive.slip.unwrap().value() - 0.2).abs() < 2.0 * drive.sigma.unwrap());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The primary type is [`filter::SlipFilter`], which weighs all sensors together. [`window::WindowEstimator`] compares
//! means over windows of time and keeps no model of the motion. On the slips of either stand [`detect::Detector`], which
//! reports the events that an operator must know, and [`control::Controller`], which drives the wheels.
//! [`prior`] holds what a soil model predicts of slip, [`start::StartCheck`] compares the sensors with the robot's
//! description before the first drive.
//!
//! Three outcomes are never mixed: a robot or settings that cannot be used are an [`Error`] with field, value, limit and
//! unit; a sample that cannot be used is a [`Fault`], which is counted and changes nothing; an estimate that cannot be
//! trusted has a [`Health`] that names the reason.
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
pub mod onboard;
pub mod prior;
mod reference;
mod robot;
mod sample;
pub mod settings;
mod speed;
pub mod start;
mod state;
mod wheel_estimate;
mod wheel_steering;
mod wheel_track;
pub mod window;

pub use body::BodyMotion;
pub use counter::{Counter, CounterWidth};
pub use error::{Error, Result};
pub use fault::{Fault, Rejected};
pub use grouser_terra::Slip;
pub use measured_slip::{MeasuredSlip, SlipLimits};
pub use reference::Reference;
pub use robot::{Encoder, MAX_WHEELS, Robot, Shaft, Wheel, WheelRole};
pub use sample::{Measurement, Sample};
pub use speed::{CountWindow, Measured, MixedSpeed, PeriodSpeed};
pub use state::{Degraded, Health, Invalid, Motion};
pub use wheel_estimate::WheelEstimate;
