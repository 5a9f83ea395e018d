//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

mod comparison;
mod copies;
mod coverage;
mod differing_tests;
mod doubts;
mod identification;
mod jobs;
mod least_squares;
mod nist_strd;
mod plates;
mod recorded_plates;
mod units;
mod wheel_derivatives;
mod wheel_predictions;
