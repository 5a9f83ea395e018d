//! Results as JSON, text, tables and a schema, all from one list of fields.
//!
//! A [`Fields`] names each quantity of a result once: its key with the unit, its words, and where its value comes from.
//! The JSON object, the lines and tables for people, the CSV table and the JSON schema are views of that list, so that
//! they cannot contradict each other.
//!
//! ```
//! use grouser_report::fields;
//!
//! #[derive(Clone, Copy)]
//! struct Wheel { load: f64, sinkage: Option<f64> }
//!
//! let fields = fields! { |wheel: Wheel|
//!     "load_n" "load" .shown("N") = wheel.load;
//!     "sinkage_m" "sinkage" .shown("mm") = wheel.sinkage;
//! };
//! let wheel = Wheel { load: 80.0, sinkage: Some(0.0125) };
//! assert_eq!(fields.lines(wheel), "load       80  N\nsinkage  12.5  mm\n");
//! assert_eq!(fields.csv([wheel]), "load_n,sinkage_m\n80,0.0125\n");
//! assert_eq!(fields.object(wheel)["sinkage_m"], 0.0125);
//! assert_eq!(fields.schema()["properties"]["load_n"]["unit"], "N");
//! ```
//!
//! The primary type is [`Fields`], which [`fields!`] writes. [`Table`] aligns columns, [`number`] writes numbers. The crate reads and prints
//! nothing: text goes to the caller.
#![forbid(unsafe_code)]

mod datum;
mod field;
mod fields;
mod list;
pub mod number;
mod schema;
mod table;
mod unit;
mod words;

pub use datum::Datum;
pub use field::Field;
pub use fields::Fields;
pub use table::Table;
pub use unit::unit_of;
pub use words::printable;

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
