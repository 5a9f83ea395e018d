//! Many operating points at once: eight lanes of f64.

mod batch;
mod dispatch;
mod functions;
mod group;
mod number;
mod plan;

pub use batch::{BatchForces, BatchKernel, BatchOutcome, BatchPoints};
pub use number::{LaneMask, Lanes};
