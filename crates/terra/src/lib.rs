//! The wheel in the soil.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

mod angle;
mod error;
mod slip;

pub use angle::Angle;
pub use error::{Error, Result};
pub use slip::{Slip, WheelMotion};
