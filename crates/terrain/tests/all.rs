//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

mod climb;
mod map;
mod mission;
mod plan;
mod planes;
mod planned_drive;
mod relief_of_examples;
mod soil_map;
mod table;
