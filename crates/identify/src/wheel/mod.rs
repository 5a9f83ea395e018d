//! Wheel tests: one wheel on one soil at several slips.

mod model;
mod test;

pub use model::{Fixed, Prediction, WheelModel, predict};
pub use test::{Quantity, Scatter, WheelTest};
