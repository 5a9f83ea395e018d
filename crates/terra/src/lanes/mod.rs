//! Many operating points at once: eight lanes of f64.

mod batch;
mod group;
mod machine;
mod plan;
mod portable;
mod vector;

pub use batch::{BatchForces, BatchKernel, BatchOutcome, BatchPoints};
pub use portable::{LaneMask, Lanes};
