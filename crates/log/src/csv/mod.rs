//! Tables of text: CSV and its relatives, line by line.
//!
//! [`Lines`] reads lines of bounded length and [`lines()`] cuts a text into lines, [`split`] cuts a line into its fields,
//! [`finite`] reads a number, and every error names its line and column ([`Cell`](crate::Cell)). Logs, operating points
//! and soil tests are all read by these.

mod date;
mod fields;
mod lines;
mod number;
mod reader;
mod row;

pub use crate::error::NotANumber;
pub use fields::{BadQuote, Field, lines, quoted, split};
pub(crate) use lines::names;
pub use lines::{LINE_LIMIT, Lines};
pub use number::finite;
pub(crate) use number::{time_ns, time_of_two};
pub(crate) use reader::{Counts, CsvReader, TABLE_LOOK_AHEAD};
