//! What the robot knows at the time: the model of the motion under several modes of the slip, weighed by evidence.
//!
//! An interacting-multiple-model filter (Blom and Bar-Shalom 1988). The modes differ only in how fast the slip wanders.
//!
//! | file | knows |
//! |---|---|
//! | `table` | the modes, and how often one follows another |
//! | `filter` | one belief a mode, mixed, passed over a step and weighed |
//! | `wheel` | what each wheel has of its own beyond the common slip, by the same modes |
//! | `learnt` | the noise of the reference, learnt from its readings |
//! | `refused` | input that is no number |
//! | `exceeds` | the probability that slip exceeds a limit, and for how long |

mod exceeds;
mod filter;
mod learnt;
mod refused;
mod table;
mod wheel;

pub use exceeds::{Exceeds, normal_tail};
pub use filter::{ModeFilter, body_motion};
pub use refused::Refused;
pub use table::{JUMPING, MODES, WALKS};
pub use wheel::WheelSlip;
