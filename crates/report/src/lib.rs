//! Results as text and tables: numbers with a chosen count of digits, aligned columns.
#![forbid(unsafe_code)]

pub mod number;
mod table;

pub use table::Table;
