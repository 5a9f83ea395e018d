//! Plate-sinkage tests: a flat plate pressed into the ground, force against depth.

mod align;
mod bag;
mod fit;
mod left_out;
mod test;

pub use bag::{BagSource, DepthColumn, PlateRecord, read_bag};
pub use fit::{PlateFit, PlateParameter, PlateSettings, fit_plates};
pub use left_out::LeftOut;
pub(crate) use left_out::too_few;
pub use test::{Plate, PlateTest, read_table};
