#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is [`GrouserOnBoard`], which C sees as an opaque pointer. With feature `std` a panic is caught and becomes
//! [`GROUSER_ERROR_INTERNAL`]; on bare metal it calls the firmware's `abort`. The crate has no estimator of its own.
#![cfg_attr(not(feature = "std"), no_std)]
#![allow(
    unsafe_code,
    reason = "a C interface reads and writes through the caller's pointers"
)]

extern crate alloc;

mod abi;
#[cfg(all(not(feature = "std"), target_os = "none"))]
mod bare;
mod border;
mod copy_out;
mod create;
mod message;
mod run;
mod sample;

pub use abi::*;
pub use copy_out::{grouser_body, grouser_command, grouser_wheel};
#[cfg(feature = "std")]
pub use create::grouser_new_from_toml;
pub use create::{
    GrouserOnBoard, grouser_abi, grouser_default_settings, grouser_free, grouser_new,
    grouser_wheel_count,
};
pub use run::{grouser_push, grouser_set_steering_angle, grouser_tick};
