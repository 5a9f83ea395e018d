//! The page of Grouser: its files, one HTML file out of them, and the runs that it shows.
//!
//! The primary type is [`Document`], one HTML file that opens without a server: the page's view of a run with the run
//! in it, or the whole page with the modules that compute in the browser.
//!
//! ```
//! # #[cfg(feature = "html")] {
//! use grouser_page::Document;
//!
//! let report = serde_json::json!({ "title": "an empty report", "runs": [] });
//! let html = Document::of_report("report.json", &report).html()?;
//! assert!(html.starts_with("<!doctype html>") && !html.contains("src=\"http"));
//! # }
//! # Ok::<(), grouser_page::Error>(())
//! ```
//!
//! [`run`] has the runs in columns: [`run::DriveRecorder`] takes the frames of a simulated drive, [`run::LogRecorder`]
//! the rows of a log through the estimator, [`run::LogParts`] the same in parts while they are found, and [`run::overview`]
//! reads the whole log's rim speeds before. [`answer`] has what the optimiser found. The crate neither simulates nor
//! estimates, and opens and writes no files.
#![forbid(unsafe_code)]

#[cfg(feature = "optimize")]
pub mod answer;
#[cfg(feature = "html")]
mod bundle;
#[cfg(feature = "html")]
mod document;
#[cfg(feature = "html")]
mod error;
#[cfg(feature = "html")]
pub mod files;
#[cfg(any(feature = "drive", feature = "log"))]
pub mod run;

#[cfg(feature = "html")]
pub use document::{Document, attribute, server_policy};
#[cfg(feature = "html")]
pub use error::{Error, Result};
