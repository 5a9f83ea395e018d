//! The robot's body: chassis, links and what holds them, and its motors.

mod leapfrog;
mod linkage;
mod motor;

pub use leapfrog::Leapfrog;
pub use linkage::{Body, BodyState, Hold, Link, Linkage, MAX_FREEDOMS, MAX_SPEEDS, Pose, Speeds};
pub(crate) use linkage::{MAX_CHAIN, solve};
pub use motor::{Motor, MotorNow};
