//! An MCAP file out of any bytes: read, decoded, and never more than it can hold.
#![no_main]

mod container;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| container::read(b"\x89MCAP0\r\n", bytes));
