//! The same model over a whole log: a pass back over what the pass forward did, and levels of noise by maximum likelihood.
//!
//! `fit` finds the levels, the jumps of the slip and the outliers; `wheel_slips` each wheel's slip by the smoothed motion,
//! `travel` the distance and its variance.

mod back;
mod fit;
mod jumps;
mod level;
mod travel;
mod wheel_slips;

pub use back::{Back, Residual, back, smoothed};
pub use fit::{Fit, fit};
pub use travel::travel;
pub use wheel_slips::{WheelSlip, wheel_slips};
