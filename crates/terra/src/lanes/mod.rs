//! Many operating points at once: eight lanes of f64.

mod batch;
mod best;
mod columns;
mod forces;
mod load;
mod machine;
mod nodes;
mod plan;
mod portable;
mod searches;
mod sheet;
mod slope;
mod vector;

pub use batch::{BatchKernel, instructions};
pub use best::{BestOf, BestSlipColumns};
pub use columns::{BatchColumns, BatchInput, BatchPoints, SoilColumns};
pub(crate) use nodes::EightNodes;
pub use portable::{LaneMask, Lanes};
