//! Robots: what a description says, as the dynamics and the statics need it.

mod model;
// mod urdf;

pub use model::{RobotModel, WheelMount};
// pub use urdf::read_urdf;
