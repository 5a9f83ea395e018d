//! Robots on soft ground: a robot's body, wheels, motors and sensors, simulated on terrain whose soil yields.
//!
//! ```
//! use grouser_rover::robot::RobotModel;
//! use grouser_rover::statics::{PostureLimits, Standing};
//!
//! let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/five-wheel.toml");
//! let model = RobotModel::read(file.as_ref())?;
//! let standing = Standing::new(&model, (0.0, 0.0), &PostureLimits::default(), None)?;
//! // the wheels carry the weight, and the robot stands with room to tilt
//! let sum: f64 = standing.loads.loads.iter().sum();
//! assert!((sum / model.weight() - 1.0).abs() < 1e-9);
//! assert!(standing.margins.tip_over > 0.5); // rad
//! # Ok::<(), grouser_rover::Error>(())
//! ```
//!
//! | for | there is |
//! |---|---|
//! | a drive of a scenario with its result | [`drive::Simulation`] |
//! | a robot on the ground, step by step | [`dynamics::Vehicle`] |
//! | a robot at rest | [`statics::Standing`] |
//! | terrain | [`ground::Ground`] |
//! | what sensors show of the truth | [`sensors::Sensors`] |
//!
//! The primary types are [`drive::Simulation`] and [`robot::RobotModel`]. The crate does not estimate or control: the
//! simulated robot runs [`grouser_slip::onboard::OnBoard`], as a real one does.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod body;
pub mod drive;
pub mod dynamics;
mod error;
pub mod ground;
pub mod robot;
pub mod sensors;
pub mod statics;
mod terrain_fault;
pub mod vector;

pub use error::{Error, Result};
