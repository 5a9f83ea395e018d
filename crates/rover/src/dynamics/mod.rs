//! How a robot moves on the ground: the forces under its wheels, and time.

mod contact_frame;
mod fastest;
mod vehicle;
mod wheel_force;

pub use contact_frame::{CONTACT_REACH_SHARE, ContactFrame};
pub use fastest::fastest_rate;
pub(crate) use vehicle::STEP_LIMITS_S;
pub use vehicle::{Ledger, Vehicle, WheelNow};
pub use wheel_force::{SoilUnder, WheelContact, WheelLoad, WheelMotionNow};
