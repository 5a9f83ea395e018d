//! From soil to route and back: a map of what is believed, a plan over it, driving, learning, and a new plan from where
//! the robot stands.
//!
//! [`Navigator`] is the robot's side and reads nothing but its own estimates.

mod believed_map;
mod drive;
mod navigator;

pub use believed_map::MissionSettings;
pub use drive::{PlannedDrive, drive};
pub use navigator::{Navigator, Replanning};
