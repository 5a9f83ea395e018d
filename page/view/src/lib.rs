//! The page as files, as one HTML file and as a server.
//!
//! The primary function is [`pack::page`], which puts the page into one self-contained HTML file that opens
//! without a server:
//!
//! ```
//! let html = grouser_view::pack::page(None)?;
//! assert!(html.starts_with("<!doctype html>") && !html.contains("src=\"http"));
//! # Ok::<(), grouser_view::Error>(())
//! ```

#![forbid(unsafe_code)]

pub mod assets;
mod bundle;
mod error;
mod gate;
pub mod pack;
pub mod server;

pub use error::{Error, Result};
