//! The same model over a whole log: a pass back over what the pass forward did, and levels of noise by maximum likelihood.
//!
//! `fit` finds the levels, the jumps of the slip and the outliers; `wheel_slips` each wheel's slip by the smoothed motion.

mod back;
mod fit;
mod jumps;
mod level;
mod wheel_slips;

pub use back::{Back, Residual, back};
pub use fit::{Fit, fit};
pub use wheel_slips::{WheelSlip, wheel_slips};
