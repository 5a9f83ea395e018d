//! A robot at rest: what its wheels carry, how stable it stands, and what it can climb.
//!
//! The primary type is [`Standing`]; `grouser robot ROBOT.toml --stance` prints it.

mod climb;
mod equations;
mod loads;
mod margins;
mod posture;
mod stance;
mod standing;

pub use climb::{ClimbStep, climb};
pub use loads::{WheelLoads, wheel_loads};
pub use margins::{Edge, StabilityMargins, stability_margins};
pub use posture::{Posture, PostureLimits, adjusted_posture};
pub use stance::{Footing, Stance, stance};
pub use standing::Standing;
