//! What the page computes, as one function of text: a request in JSON gives an answer in JSON, with the keys,
//! units and numbers of the command's `--json`. The browser calls it through four exported functions
//! ([`abi`]), the server directly.
//!
//! ```
//! let answer = grouser_page_wasm::answer(r#"{"call": "catalogue"}"#);
//! assert!(answer.starts_with(r#"{"soils":[{"key":"dry-sand","#));
//! ```
//!
//! It keeps no state between two requests, and draws nothing but figures that are saved.

pub mod abi;
mod answer;
#[cfg(feature = "explore")]
mod catalogue;
#[cfg(feature = "explore")]
mod contact;
#[cfg(feature = "explore")]
mod curve;
#[cfg(feature = "drive")]
mod drive;
#[cfg(feature = "log")]
mod estimate;
#[cfg(any(feature = "drive", feature = "optimize"))]
mod examples;
#[cfg(feature = "figure")]
mod figure;
#[cfg(feature = "optimize")]
mod optimize;
mod request;
#[cfg(feature = "explore")]
mod slip_model;
#[cfg(feature = "explore")]
mod wheel;

pub use answer::{answer, answer_with};
