//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

mod trial;

mod faults_encoder;
mod faults_sensors;
mod faults_shared;
mod faults_start;
mod faults_time;
mod five_wheel_example;
mod known_truth;
mod nominal;
mod soak;
