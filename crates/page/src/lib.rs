#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! [`run`] has the runs in columns: [`run::DriveRecorder`] takes the frames of a simulated drive,
//! [`run::LogRecorder`] the rows of a log through the estimator, [`run::LogParts`] the same in parts while
//! they are found, and [`run::overview`] reads the whole log's rim speeds before. [`answer`] has what the
//! optimiser found. The crate neither simulates nor estimates, and opens and writes no files.
#![forbid(unsafe_code)]

#[cfg(feature = "optimize")]
pub mod answer;
#[cfg(feature = "html")]
mod bundle;
#[cfg(feature = "html")]
mod document;
#[cfg(feature = "html")]
mod error;
#[cfg(feature = "html")]
pub mod files;
#[cfg(any(feature = "drive", feature = "log"))]
pub mod run;

#[cfg(feature = "html")]
pub use document::{Document, attribute, server_policy};
#[cfg(feature = "html")]
pub use error::{Error, Result};
