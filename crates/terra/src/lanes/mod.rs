//! Many operating points at once.

mod functions;
mod number;

pub use number::{LaneMask, Lanes};
