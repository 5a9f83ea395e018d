//! Elevation models in, slip maps out: a few rows at a time, so that memory does not grow with the file.

mod dem;
mod predictor;
mod writer;

pub use dem::{Dem, DemCaution, Window};
pub(crate) use predictor::{from_planes, to_planes};
pub use writer::{RasterLayout, write_raster};
