//! Wheel tests: one wheel on one soil at several slips.

pub mod columns;
mod misfit;
mod model;
mod table;
mod test;

pub use misfit::{LawScore, Misfit, rmse};
pub(crate) use misfit::{MAX_SCATTER_RATIO, misfits, sinkage_shift};
pub use model::{Fixed, Prediction, WheelModel, predict};
pub use table::read_table;
pub use test::{Quantity, Scatter, Support, WheelTest, fitted_range};
