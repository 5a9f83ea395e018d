//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

mod carts;
#[path = "support/measured_data.rs"]
mod measured_data;
#[path = "support/processor_time.rs"]
mod processor_time;
mod scratch;
mod written;

mod any_bytes;
mod bag_damages;
mod built_messages;
mod choosing;
mod column_meanings;
mod container_faults;
mod csv_faults;
mod databases;
mod decode_again;
mod decoded_messages;
mod definitions;
mod field_inputs;
mod flipped_bits;
mod growing;
mod interop;
mod killed_loggers;
mod logs;
mod long_definitions;
mod mcap_damages;
mod measured_bags;
mod message_types;
mod nmea;
mod orientations;
mod others_files;
mod readings;
mod recordings;
mod recovered_files;
mod seeds;
mod sheets;
mod strange_drivers;
mod streams;
mod suggestions;
mod surveys;
mod table_fixes;
mod table_rows;
mod transform_poses;
mod truncated_files;
mod unpacking_limits;
mod writers;
