//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod carts;

mod axes;
mod held;
mod paths;
mod turns;
