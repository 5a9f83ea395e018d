//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

#[path = "../../log/tests/support/measured_data.rs"]
mod measured_data;
mod shipped;

mod articulated;
mod axes;
mod calibration;
mod descriptions;
mod displacements;
mod exchanged;
mod five_wheel;
mod ground_changes;
mod held;
mod jackal;
mod kobuki;
mod late_positions;
mod logs_that_say_nothing;
mod measured_poses;
mod mounting;
mod observability;
mod offline;
mod places;
mod reference_delay;
mod rim_ways;
mod robotino;
mod robotino_free_wheel;
mod speed_sign;
mod steered;
mod whole_log_check;
mod written_messages;
mod wrong_geometry;
