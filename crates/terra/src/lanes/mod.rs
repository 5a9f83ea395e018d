//! Many operating points at once: eight lanes of f64.

mod batch;
mod curve;
mod forces;
mod load;
mod machine;
mod nodes;
mod plan;
mod portable;
mod sheet;
mod tracked;
mod vector;

pub use batch::{BatchForces, BatchKernel, BatchOutcome, BatchPoints};
pub use portable::{LaneMask, Lanes};
pub use tracked::{TrackedSolution, TrackedWheel};
