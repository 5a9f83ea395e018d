//! How a robot moves on the ground: the forces under its wheels, and time.

mod vehicle;
mod wheel_force;

pub use vehicle::{Ledger, Vehicle, WheelNow};
pub use wheel_force::{SoilUnder, WheelContact, WheelLoad, WheelMotionNow};
