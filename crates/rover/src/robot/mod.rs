//! Robots: what a description says, as the dynamics and the statics need it.

mod model;

pub use model::{RobotModel, WheelMount};
