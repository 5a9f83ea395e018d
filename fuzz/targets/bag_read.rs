//! A ROS 1 bag out of any bytes: read, decoded, and never more than it can hold.
#![no_main]

mod container;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| container::read(b"#ROSBAG V2.0\n", bytes));
