//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

#[path = "../../log/tests/support/processor_time.rs"]
mod processor_time;

mod any_bytes;
mod measurements;
mod path_faults;
mod soils;
mod toml_faults;
mod topics;
mod urdf;
mod whole_files;
mod written_files;
