#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! | file | read | written |
//! |---|---|---|
//! | robot | [`robot::read`] | [`robot::to_toml`] |
//! | soil | [`soil::read`] | [`soil::to_toml`] |
//! | column map | [`columns::read`] | [`columns::to_toml`] |
//! | URDF | [`urdf`] | |
//!
//! The primary types are [`Document`] and [`Section`], over which each kind of file is one module, and
//! [`TomlText`], which writes them. [`WholeFile`] writes any file as a whole or not at all. The crate reads the descriptions of logs, not logs.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod actuator;
pub mod body;
pub mod columns;
mod document;
mod entries;
mod error;
mod fields;
pub mod gravity;
mod key_unit;
mod parse;
mod partial_file;
mod quantity_name;
pub mod regular;
pub mod robot;
mod section;
pub mod soil;
pub mod steering;
mod suggestion;
pub mod suspension;
mod toml_text;
pub mod topics;
pub mod unit;
pub mod urdf;
pub mod wheel_sizes;
mod whole_file;

pub use document::{DEPTH_LIMIT, Document, FORMAT, SIZE_LIMIT};
pub use entries::Entry;
pub use error::{Error, PLACEHOLDER, Place, Result};
pub use fields::{read_fields, write_fields};
pub use key_unit::{of_key, unit_of_key};
pub use quantity_name::is_quantity_name;
pub use section::Section;
pub use suggestion::nearest;
pub use toml_text::TomlText;
pub use whole_file::{WholeFile, WriteError, write_whole};
