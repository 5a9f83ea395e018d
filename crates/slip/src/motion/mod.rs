//! One model of the robot's motion, for every sensor: state, transition, measurements.
//!
//! | file | knows |
//! |---|---|
//! | `state` | the nine numbers, and the logarithmic slip |
//! | `belief` | mean and covariance, and the scalar Kalman update |
//! | `step` | what the sensors measured over a step of time: the only input |
//! | `wheels` | the common motion of the wheels over a step |
//! | `noise` | the kinds of noise and their levels |
//! | `model` | how a belief passes over a step |
//! | `tape` | what the pass did, for the pass back (`smooth`) |

mod belief;
mod model;
mod noise;
mod state;
mod step;
mod tape;
mod wheels;

pub use belief::{Belief, Correction, Row, dot};
pub use model::{CREEP, Motion, start};
pub use noise::{KINDS, Levels, Noise};
pub use state::*;
pub use step::{Reading, Step, Value, WheelStep};
pub use tape::{Entry, Tape};
pub use wheels::{CommonMotion, common_motion};
