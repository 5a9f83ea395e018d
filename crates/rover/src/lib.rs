#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! | for | there is |
//! |---|---|
//! | a drive of a scenario with its result | [`drive::Simulation`] |
//! | a robot on the ground, step by step | [`dynamics::Vehicle`] |
//! | a robot at rest | [`statics::Standing`] |
//! | terrain | [`ground::Ground`] |
//! | what sensors show of the truth | [`sensors::Sensors`] |
//!
//! The primary types are [`drive::Simulation`] and [`robot::RobotModel`]. The crate does not estimate or
//! control: the simulated robot runs [`grouser_slip::onboard::OnBoard`], as a real one does.
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
