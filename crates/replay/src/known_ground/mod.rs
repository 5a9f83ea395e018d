//! Slip where nothing measures the ground: by what the motors draw on grounds whose slip was measured before.
//!
//! ```text
//! runs with a reference → learn_grounds → KnownGrounds (a file) → slips_by_known_grounds ← a run without a reference
//! ```

mod file;
mod learn;
mod ripple;
mod slip_range;
mod stretch;
mod stretches;

pub use file::{read_known_grounds, to_toml};
pub use learn::{Coverage, GroundSlip, GroundSlips, learn_grounds, slips_by_known_grounds};
pub use ripple::roller_ripple;
pub use slip_range::SlipRange;
pub use stretch::{KnownGround, KnownGrounds, Roller, Stretch};
