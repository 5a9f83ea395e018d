//! The page as files, as one HTML file and as a server.
//!
//! [`assets::page`] is the page as one HTML file, which opens without a server; [`server::Server`] serves it:
//!
//! ```
//! let html = grouser_view::assets::page(None).html()?;
//! assert!(html.contains("id=\"wasm-explore\">H4sI"), "a gzip file in base64");
//! # Ok::<(), grouser_page::Error>(())
//! ```

#![forbid(unsafe_code)]

pub mod assets;
mod error;
pub mod feed;
mod gate;
pub mod run;
pub mod server;

pub use error::{Error, Result};
