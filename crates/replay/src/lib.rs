//! A recorded log through the slip estimator, whole: what is used of the log is chosen, clocks are
//! aligned, every wheel gets its rows, and the log its summary. The command and the web app both stand
//! on it, so that they say the same.
//!
//! The primary function is [`run`]. It draws nothing and writes no files.
#![forbid(unsafe_code)]

mod align;
mod calibration;
mod choice;
mod error;
mod quantiles;
mod run;
mod samples;
mod soil_reading;
mod summary;

pub use calibration::{Calibration, calibrate_radius};
pub use error::{Error, Result};
pub use quantiles::Quantiles;
pub use run::{Options, Row, run};
pub use soil_reading::{SoilReading, soil_readings};
pub use summary::{AlongSummary, Spread, Status, Summary, WheelSummary, YawSummary};
