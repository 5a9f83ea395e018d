//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

#[path = "../../log/tests/support/processor_time.rs"]
mod processor_time;

mod four_wheels;
mod noise;
mod open_loop;
mod sane;
mod wild;
mod world;

mod control;
mod control_backwards;
mod control_decisions;
mod control_wheels;
mod counters;
mod detect;
mod filter;
mod filter_modes;
mod filter_outputs;
mod filter_promises;
mod ground_reference;
mod learnt_soil;
mod legal_settings;
mod mode_machine;
mod modes;
mod motion_model;
mod names;
mod onboard;
mod onboard_start;

mod prior;
mod robot_description;
mod soil_learner;
mod soil_tables;
mod speed_laws;
mod start_check;
mod steered;
mod tick_properties;
mod turning;
mod winding_reference;
