#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod error;
pub mod paper;
pub mod stress;
pub mod validate;

pub use error::{Error, Result};
