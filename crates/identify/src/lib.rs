//! Soil parameters from simple tests, with what the data say about each, and the model held against
//! measurement.
#![forbid(unsafe_code)]

mod error;
pub mod least_squares;
mod parameter;
pub mod table;
pub mod validate;
pub mod wheel;

pub use error::{Error, Result};
pub use parameter::Parameter;
