//! The tests of this crate.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod derivatives;
mod unit;
