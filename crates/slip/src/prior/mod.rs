//! What the soil model says of a slip before it is measured: tables made once, looked up at 10 Hz.
//!
//! Each carries the uncertainty of the soil: its parameters are varied one by one, and what each does to the slip adds in
//! squares. Making a table solves the stress model some hundred times and allocates; looking up does neither.

mod doubt;
mod skid;
mod slope;
mod soil_levels;
mod table;

pub use doubt::SoilDoubt;
pub use skid::FreeWheelSkid;
pub use slope::SlipDemand;
pub use soil_levels::{STIFFNESSES, STRENGTHS, scaled_soil};
