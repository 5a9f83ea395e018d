//! A robot at rest: what its wheels carry, and how stable it stands.
//!
//! The primary type is [`Standing`]; `grouser robot ROBOT.toml --stance` prints it.

mod equations;
mod loads;
mod margins;
mod posture;
mod posture_control;
mod stance;
mod standing;

pub use loads::{LoadsOnPlanes, WheelLoads, wheel_loads};
pub use margins::{Edge, StabilityMargins, TipOverCone, stability_margins};
pub use posture::{Posture, PostureLimits, adjusted_posture};
pub use posture_control::{PostureControl, tip_over_margin};
pub use stance::{Footing, Stance, stance};
pub use standing::Standing;
