#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! | for | there is |
//! |---|---|
//! | a log, row by row | [`run`](run()), [`run_into`] with a [`Sink`] |
//! | a live source | [`Engine`], [`RobotSamples`] |
//! | the output as messages of ROS 2 | [`messages`] |
//! | true slips beside the estimates | [`Truth`], [`Compared`] |
//! | the effective radius; with track and scale of the gyro; the reference's delay; intervals | [`calibrate_radius`], [`calibrate_geometry`], [`calibrate_reference_delay`], [`calibrate_intervals`] |
//! | a soil's reading of the slips | [`soil_readings`] |
//! | changes of ground from motor currents | [`GroundChange`] |
//!
//! The primary types are [`Engine`] and [`Summary`]. A run that ends with doubts is no error:
//! [`FusedSummary::doubts`] names them. The crate draws nothing and writes no files.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod calibration;
mod checks;
mod choice;
mod clocks;
mod engine;
mod error;
mod filter_input;
mod fusion;
mod gaps;
mod geometry;
mod ground_change;
mod ground_watch;
mod intervals;
mod markers;
pub mod messages;
mod moment;
mod mounting;
mod odometry;
mod offline;
mod options;
mod postponed;
mod quantiles;
mod record;
mod run;
mod samples;
mod sink;
mod soil_learning;
mod soil_reading;
mod start;
mod steering;
mod summary;
mod suspension;
mod tally;
mod truth;
mod ways;
mod wheel_points;
mod wheel_sign;

pub use calibration::{Calibration, calibrate_radius};
pub use checks::{Doubt, ReferenceUse, WayCheck};
pub use choice::{Inputs, unused_currents};
pub use clocks::calibrate_reference_delay;
pub use engine::Engine;
pub use error::{Error, Result};
pub use geometry::{Factor, GeometryCalibration, calibrate_geometry};
pub use ground_change::GroundChange;
pub use intervals::{IntervalCalibration, calibrate_intervals};
pub use odometry::Odometry;
pub use options::Options;
pub use quantiles::Quantiles;
pub use run::{run, run_into};
pub use samples::RobotSamples;
pub use sink::{Row, Sink, Step};
pub use soil_reading::{SoilReading, reference_skid, soil_readings};
pub use start::check_start;
pub use summary::{
    AlongSummary, EventAt, FusedSummary, Spread, Status, Summary, UNKNOWN, WheelSummary, YawSummary,
};
pub use truth::{Compared, ComparedSlip, Truth, TruthError};
