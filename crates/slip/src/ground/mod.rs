//! What the wheels tell of the ground: where the contact begins, which way it leans, how strong the soil is.
//!
//! Slower than the estimator and beside it: fed at 10 Hz or less, with a wheel's slip, load, sinkage and torque.

mod entry;
mod lean;
mod reading;
mod strength;
mod stretch;

pub use entry::{Uncertain, entry_angle_from_sinkage, sinkage_from_camera};
pub use lean::{ContactLean, LeanOutcome, contact_lean};
pub use reading::WheelReading;
pub use strength::{GroundSettings, Knowledge, SoilEstimate, SoilIdentifier, SoilPrior, Taken};
