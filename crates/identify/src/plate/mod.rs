//! Plate-sinkage tests: a flat plate pressed into the ground, force against depth.

mod align;
mod bag;
mod fit;
mod test;

pub use bag::{BagSource, DepthColumn, PlateRecord, read_bag};
pub(crate) use fit::too_few;
pub use fit::{LeftOut, PlateFit, PlateParameter, PlateSettings, fit_plates};
pub use test::{Plate, PlateTest, read_table};
