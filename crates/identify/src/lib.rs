#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is [`Identification`], which a [`Job`] file leads to ([`identify()`]); each kind of test
//! has its own module. The crate fits; the laws are in `grouser-terra`.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod branches;
mod compare;
mod doubt;
mod error;
mod identification;
mod identified;
mod inherited;
mod job;
mod judged;
pub mod least_squares;
mod parameter;
pub mod plate;
mod plausible;
mod readings;
pub mod shear;
pub mod table;
mod unit_mistake;
pub mod wheel;

pub use compare::compare_laws;
pub use doubt::Doubt;
pub use error::{Error, Result};
pub use identification::{Identification, PlateStage, ShearStage, WheelNumber, WheelStage};
pub use identified::IdentifiedNumber;
pub use job::{BagTest, Job, PlateSource, WheelJob};
pub use judged::identify;
pub use parameter::Parameter;
pub use plausible::Plausibility;
