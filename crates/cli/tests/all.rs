//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

mod repository;
mod reservations;

mod code_lines;
mod command;
mod dependencies;
mod docs;
mod estimate;
mod estimate_calibration;
mod hostile_logs;
mod identify;
mod install_script;
mod layering;
mod log;
mod measured_data;
mod module_cycles;
mod optimize;
mod owners_mistakes;
mod recordings;
mod results;
mod test_commands;
mod version;
mod whole_files;
