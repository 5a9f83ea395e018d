//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

#[path = "../../log/tests/support/processor_time.rs"]
mod processor_time;

mod closed_form;
mod control_page;
mod drive;
mod learnt_soil;
mod pooled_drives;
mod posture;
mod settling;
mod step_halving;
mod terrain;
mod tipping;
mod uneven;
mod written_scenarios;
