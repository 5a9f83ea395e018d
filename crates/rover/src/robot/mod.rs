//! Robots: what a description says, as the dynamics and the statics need it.

mod actuator;
mod model;

pub use actuator::{Actuated, Actuator};
pub use model::{RobotModel, WheelMount};
