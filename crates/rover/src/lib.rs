//! Robots on soft ground.
#![forbid(unsafe_code)]

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
