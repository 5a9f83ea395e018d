//! Robot logs as typed records in the order of time, whatever they were written as: today tables of
//! text (CSV and its relatives, plain or gzip) read through a column map.
//!
//! Reading streams: memory does not grow with the file, and rows may stand up to 1024 places from
//! where their time belongs. Whatever is wrong ends the log with an error that names line and column:
//! a log is read whole or not at all.
//!
//! ```
//! use grouser_files::columns;
//! use grouser_log::{Log, Reading};
//!
//! let example = std::path::Path::new("../../examples/five-wheel");
//! let map = columns::read(&example.join("columns.toml"))?;
//! let log = Log::find(&[example.join("log.csv")], map)?;
//! let mut turn = 0.0;
//! for record in log.records(&[])? {
//!     if let Reading::YawRate { rate } = record?.reading {
//!         turn += rate * 0.02; // 50 Hz
//!     }
//! }
//! assert!((turn - 0.94).abs() < 0.01); // 0.15 rad/s for 6 s, and the gyro's bias of 0.001 for 40 s
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! MCAP files and ROS 1 bags are read message by message by [`container::Container`], whole or damaged,
//! and decoded by the definitions they hold ([`message::Decoder`]); [`Survey`] tells what one holds.
//!
//! The primary type is [`Log`]. It knows nothing of robots or slip.
#![forbid(unsafe_code)]

pub mod container;
mod csv;
mod error;
mod log;
pub mod message;
mod messages;
mod order;
mod record;
mod recording;
mod series;
mod sheet;
mod slots;
mod source;
mod suggest;
mod survey;
pub mod write;

pub use csv::LINE_LIMIT;
pub use error::{Cell, Error, Result};
pub use log::{Log, Records};
pub use messages::{Clock, LOOK_AHEAD, LeftOut, Messages, Stamped};
pub use record::{Reading, Record};
pub use recording::UsedTopic;
pub use series::{Series, series};
pub use sheet::{Guess, Sheet, SheetColumn, SheetTime};
pub use suggest::{suggest_for_sheet, suggest_for_survey};
pub use survey::{Survey, Topic, Use};
