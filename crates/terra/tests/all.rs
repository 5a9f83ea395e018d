//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

mod batches;
mod by_hand;
mod cliffs;
mod derivative_oracles;
mod effort;
mod faults;
mod interfaces;
mod lanes;
mod literature;
mod loaded;
mod loads_and_slopes;
mod lug_cases;
mod number_kinds;
mod points;
mod properties;
mod reference_cases;
mod side_disc;
mod simulation_accuracy;
mod slip_laws;
mod small_loads;
mod soil_columns;
mod steepest_slope;
