//! Soil parameters from simple tests, with what the data say about each, and the model held against
//! measurement.
#![forbid(unsafe_code)]

mod error;
pub mod least_squares;

pub use error::{Error, Result};
