//! Grouser's TOML files, read with their units, limits and places, into plain structs of the crates
//! below: a file says `radius_m = 0.1`, and a wrong key, unit or number is refused with its line, its
//! limit and the word that was probably meant.
//!
//! Every file begins with `format = 1`; a newer one is refused by number. A file holds at most 1 MiB
//! and nests at most 64 deep; a path that is no regular file is refused before it is opened.
//!
//! ```
//! use grouser_files::{Document, robot};
//!
//! let text = r#"
//! format = 1
//! name = "cart"
//! [[wheel]]
//! name = "left"
//! x_m = 0.0
//! y_m = 0.2
//! raduis_m = 0.1
//! drive = "powered"
//! "#;
//! let error = robot::parse(&Document::from_text("cart.toml", text.into())?).unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "cart.toml:8:1: [[wheel]] number 1 has no such key as `raduis_m`"
//! );
//! assert_eq!(error.hint().unwrap(), "did you mean `radius_m`?");
//! # Ok::<(), grouser_files::Error>(())
//! ```
//!
//! | file | read | written |
//! |---|---|---|
//! | robot | [`robot::read`] | [`robot::to_toml`] |
//! | soil | [`soil::read`] | [`soil::to_toml`] |
//! | column map | [`columns::read`] | [`columns::to_toml`] |
//! | URDF | [`urdf`] | |
//!
//! The primary types are [`Document`] and [`Section`], over which each kind of file is one module, and [`TomlText`], which
//! writes them. The crate reads the descriptions of logs, not logs.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod body;
pub mod columns;
mod document;
mod entries;
mod error;
mod fields;
pub mod gravity;
mod parse;
pub mod regular;
pub mod robot;
mod section;
pub mod soil;
pub mod steering;
mod suggestion;
mod toml_text;
pub mod topics;
pub mod unit;
pub mod urdf;
pub mod wheel_sizes;

pub use document::{DEPTH_LIMIT, Document, FORMAT, SIZE_LIMIT};
pub use entries::Entry;
pub use error::{Error, PLACEHOLDER, Place, Result};
pub use fields::read_fields;
pub use section::Section;
pub use suggestion::nearest;
pub use toml_text::TomlText;
