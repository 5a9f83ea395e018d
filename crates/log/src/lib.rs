//! Robot logs as typed records in the order of time, whatever they were written as: today tables of
//! text (CSV and its relatives, plain or gzip) read through a column map.
//!
//! Reading streams: memory does not grow with the file, and rows may stand up to 1024 places from
//! where their time belongs. Whatever is wrong ends the log with an error that names line and column:
//! a log is read whole or not at all.
//!
//! ```no_run
//! use grouser_files::columns;
//! use grouser_log::{Log, Reading};
//!
//! let map = columns::read("examples/robotino/columns.toml".as_ref())?;
//! let log = Log::find(&["table.csv.gz".into()], map)?;
//! for record in log.records(&[])? {
//!     let record = record?;
//!     if let Reading::WheelRate { wheel, rate } = record.reading {
//!         let name = &log.wheels()[wheel];
//!         // …
//! #       let _ = (name, rate, record.time_ns);
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The primary type is [`Log`]. It knows nothing of robots or slip.
#![forbid(unsafe_code)]

mod csv;
mod error;
mod log;
mod order;
mod record;
mod source;

pub use csv::{CsvReader, LINE_LIMIT};
pub use error::{Cell, Error, Result};
pub use log::{Log, Records};
pub use record::{Reading, Record};
