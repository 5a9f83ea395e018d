//! What runs on the robot: encoder pulses and counts become speeds, speeds become the slip of every
//! wheel, each with its sigma and its state. It needs no operating system: time is an argument, and
//! nothing is allocated after construction.
//!
//! A wheel at p_i that drives along e_i travels at v_i = e_i · (v_body + Ω × p_i); its rim runs at
//! r ω_i; the two make its slip ([`grouser_terra::Slip`]).
//!
//! ```
//! use grouser_slip::{
//!     CounterWidth, Encoder, Measurement, Reference, Robot, Sample, Shaft, Wheel, WheelRole,
//! };
//! use grouser_slip::window::{WindowEstimator, WindowSettings};
//! use grouser_terra::Angle;
//!
//! let encoder = Encoder {
//!     shaft: Shaft::Wheel,
//!     gear: 1.0,
//!     ticks_per_turn: Some(1000.0),
//!     counter: CounterWidth::new(16)?,
//!     reversed: false,
//!     rate_step: 0.0,
//! };
//! let wheel = |name: &str, x, role| Wheel {
//!     name: name.into(),
//!     x,
//!     y: 0.0,
//!     heading: Angle::from_deg(0.0),
//!     radius: 0.1,
//!     role,
//!     encoder,
//!     width: None,
//!     load: None,
//! };
//! let wheels = vec![wheel("drive", 0.3, WheelRole::Powered), wheel("fifth", -0.3, WheelRole::Free)];
//! let robot = Robot::new("bicycle".into(), wheels)?;
//! let settings = WindowSettings { reference: Reference::FreeWheel, ..WindowSettings::default() };
//! let mut estimator = WindowEstimator::new(&robot, settings)?;
//! for step in 0..200_u64 {
//!     let time_ns = step as i64 * 10_000_000;
//!     // The powered wheel turns 10 ticks a step, the free one 8: the robot travels at 80 % of the rim.
//!     for (wheel, raw) in [(0, 10 * step), (1, 8 * step)] {
//!         estimator.update(Sample { time_ns, measurement: Measurement::WheelCount { wheel, raw } })?;
//!     }
//!     estimator.update(Sample { time_ns, measurement: Measurement::YawRate { rate: 0.0 } })?;
//! }
//! let slip = estimator.latest().unwrap().wheels[0].slip.unwrap();
//! assert!((slip.value() - 0.2).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The primary type is [`WindowEstimator`]. It does not read files, know of soil, or filter: each slip is
//! that of a window of time, from what was measured in it. Beside it [`ground`] learns the soil's strength and
//! contact angles from slower readings, [`filter`] weighs all sensors together, [`detect`] calls what an operator must hear of, and
//! [`start`] looks whether the robot is what its description says.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

extern crate alloc;

mod body;
mod clock;
pub mod control;
mod counter;
pub mod detect;
mod error;
mod fault;
pub mod filter;
pub mod ground;
mod history;
mod measured_slip;
pub mod prior;
mod reference;
mod robot;
mod sample;
mod speed;
pub mod start;
mod state;
mod wheel_estimate;
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
