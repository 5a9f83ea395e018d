//! Synthetic robot runs with known truth: what an encoder and a gyro would have shown of a drive whose
//! slips are prescribed. For examples and tests; not published.
//!
//! Every number comes from a seed and from operations that IEEE 754 fixes (no sine, no exponential),
//! so that the files it writes are the same bytes on every machine.
//!
//! ```
//! use grouser_synthetic::FiveWheel;
//! let run = FiveWheel::default().generate();
//! assert_eq!(run.rows.len(), 2001); // 40 s at 50 Hz
//! ```
//!
//! The primary type is [`FiveWheel`]. It is no simulation of forces: the soil model has no part in it,
//! so that what is tested against it is tested against something else.
#![forbid(unsafe_code)]

mod course;
mod drive;
mod faults;
mod five_wheel;
mod known_truth;
mod noise;
mod sensors;
mod test_drive;

pub use course::{Course, Event, Step, slip};
pub use drive::{Command, Leg, command};
pub use faults::{Fault, inject};
pub use five_wheel::{FiveWheel, NAMES, Row, Run, START_NS, Truth, WHEELS, Wheel};
pub use known_truth::{Disturbance, KnownTruth, SlipProfile, TruthStep};
pub use noise::{Noise, Wander};
pub use sensors::{Camera, Sensors};
