//! From soil to route and back: a map of what is believed, a plan over it, driving, learning, and a new plan from where
//! the robot stands.
//!
//! [`Navigator`] is the robot's side and reads nothing but its own estimates.

mod believed_map;
mod drive;
mod navigator;
mod oracle;
mod policy;
mod robot;
mod world;

pub use believed_map::{BelievedMap, MissionSettings};
pub use drive::{PlannedDrive, drive};
pub use navigator::{Navigator, Replanning};
pub use policy::{Mission, MissionResult, Policy};
pub use robot::Ended;
pub use world::{World, WorldSoil};
