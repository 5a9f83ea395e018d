//! How a robot moves on the ground: the forces under its wheels, and time.

mod fastest;
mod vehicle;
mod wheel_force;

pub use fastest::fastest_rate;
pub(crate) use vehicle::STEP_LIMITS_S;
pub use vehicle::{Ledger, Vehicle, WheelNow};
pub use wheel_force::{SoilUnder, WheelContact, WheelLoad, WheelMotionNow};
