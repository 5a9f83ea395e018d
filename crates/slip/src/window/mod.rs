//! Slip of every wheel as means over windows of time.
//!
//! The window estimator compares how far each rim runs in a window with how far the wheel's centre travels by one
//! reference. It keeps no model of the motion; [`filter`](crate::filter) weighs all sensors together.

mod estimator;
mod means;
mod output;
mod reference_track;
mod settings;

pub use estimator::WindowEstimator;
pub use means::WindowMeans;
pub use output::{WindowBody, WindowOutput};
pub use settings::WindowSettings;
