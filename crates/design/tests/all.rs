//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

#[path = "../../opt/tests/support/random_starts.rs"]
mod random_starts;

mod best_seen;
mod builder;
mod certificate;
mod every_law;
mod files;
mod formulas;
mod fronts;
mod further_problems;
mod hock_schittkowski;
mod mission;
mod quantities;
mod refuted;
mod soil_box;
mod written_missions;
mod written_problems;
