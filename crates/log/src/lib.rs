//! Robot logs as samples of the slip estimator in the order of time, whatever they were written as: MCAP files, ROS 1 bags,
//! and tables of text (CSV and its relatives, plain or gzip) read through a column map.
//!
//! Reading streams: memory does not grow with the file; rows may stand up to 1024 places from where their
//! time belongs, messages up to 4096. A table is read whole or not at all: whatever is wrong ends it with an
//! error that names line and column. A bag is read as far as it can be, and what was left out is counted
//! ([`LeftOut`]).
//!
//! ```
//! use grouser_files::columns;
//! use grouser_log::Log;
//! use grouser_slip::Measurement;
//!
//! let example = std::path::Path::new("../../examples/five-wheel");
//! let map = columns::read(&example.join("columns.toml"))?;
//! let log = Log::find(&[example.join("log.csv")], map)?;
//! let mut turn = 0.0;
//! for sample in log.samples(&[])? {
//!     if let Measurement::YawRate { rate } = sample?.measurement {
//!         turn += rate * 0.02; // 50 Hz
//!     }
//! }
//! assert!((turn - 0.94).abs() < 0.01); // 0.15 rad/s for 6 s, and the gyro's bias of 0.001 for 40 s
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | for | there is |
//! |---|---|
//! | samples of a robot's sensors | [`Log::find_any`], which chooses columns and topics; [`Log::over`] for anything readable |
//! | samples of a live source | [`Preview`], then [`Intake`] |
//! | tables of text | [`csv`] |
//! | decoded messages in the order of time | [`Messages`] |
//! | one number over time | [`series()`] |
//! | messages as the file has them, and its damage | [`container::Container`] |
//! | what a file holds | [`Survey`], [`Sheet`] |
//! | writing | [`write`](mod@write) |
//!
//! Messages are decoded by the definitions that their file holds ([`message::Decoder`]).
//!
//! The primary types are [`Log`] and [`Intake`]. The crate estimates nothing: it does not know the robot.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod container;
pub mod csv;
mod error;
mod find;
mod log;
mod measures;
mod merge;
pub mod message;
mod messages;
mod order;
mod recording;
mod series;
mod sheet;
mod slots;
mod source;
mod split;
mod suggest;
mod survey;
pub mod write;

pub use error::{Cell, Error, Result};
pub use find::run_files;
pub use log::Log;
pub use measures::Measures;
pub use merge::Samples;
pub use messages::{Clock, LOOK_AHEAD, LeftOut, Messages, Stamped};
pub use recording::{Intake, Preview, UsedTopic};
pub use series::{Series, series};
pub use sheet::{Guess, Sheet, SheetColumn, SheetTime};
pub use suggest::{suggest_for_sheets, suggest_for_survey};
pub use survey::{Survey, Topic, Use};
