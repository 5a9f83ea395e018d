#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is [`Model`]: a wheel on a soil with the variables of the unit ([`VARIABLES`]). [`package`] writes the
//! file; `interface` has the functions of the standard over [`Model`].
mod archive;
mod description;
mod error;
pub mod interface;
mod model;
mod package;
mod resources;
mod variables;

pub use error::{Error, Result};
pub use model::{Inputs, Model, Outputs};
pub use package::package;
pub use variables::{INPUTS, OUTPUTS, VARIABLES, Variable};
