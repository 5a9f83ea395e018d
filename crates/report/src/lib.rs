#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is [`Fields`], which [`fields!`] writes. [`Table`] aligns columns, [`number`] writes
//! numbers. The crate reads and prints nothing: text goes to the caller.
#![forbid(unsafe_code)]

mod datum;
mod field;
mod fields;
mod layout;
mod list;
pub mod number;
mod schema;
mod table;
mod unit;
mod words;
mod wrap;

pub use datum::Datum;
pub use fields::Fields;
pub use layout::Layout;
pub use table::Table;
pub use unit::unit_of;
pub use words::printable;
pub use wrap::wrapped;

/// A JSON object that keeps the order of its keys.
///
/// Numbers that are NaN or infinite become `null` when they enter it.
///
/// ```
/// use grouser_report::Object;
///
/// let object = Object::from_iter([("slip".to_owned(), f64::NAN.into())]);
/// assert!(object["slip"].is_null());
/// ```
pub type Object = serde_json::Map<String, serde_json::Value>;
