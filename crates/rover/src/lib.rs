//! Robots on soft ground.
#![forbid(unsafe_code)]

pub mod dynamics;
mod error;
pub mod ground;
pub mod robot;
pub mod vector;

pub use error::{Error, Result};
