//! How a robot moves: its body, the forces under its wheels, its motors, and time.

mod linkage;
mod motor;
mod vehicle;
mod wheel_force;

pub use linkage::{
    Body, BodyState, GRAVITY, Hold, Link, Linkage, MAX_FREEDOMS, MAX_SPEEDS, Pose, Speeds,
};
pub(crate) use linkage::{MAX_CHAIN, solve};
pub use motor::{Motor, MotorNow};
pub use vehicle::{Ledger, Vehicle, WheelNow};
pub use wheel_force::{WheelContact, WheelLoad, WheelMotionNow};
