//! One model of the robot's motion, for every sensor: state, transition, measurements.
//!
//! | file | knows |
//! |---|---|
//! | `state` | the nine numbers, and the logarithmic slip |
//! | `belief` | mean and covariance, and the scalar Kalman update |
//! | `step` | what the sensors measured over a step of time: the only input |
//! | `wheels` | the common motion of the wheels over a step |
//! | `noise` | the kinds of noise and their levels |
//! | `evidence` | what a step shows of a mode, and readings that may be outliers |
//! | `model` | how a belief passes over a step |
//! | `tape` | what the pass did, for the pass back (`smooth`) |

mod belief;
mod evidence;
mod model;
mod noise;
mod state;
mod step;
mod tape;
mod wheels;

pub use belief::{Belief, Correction, Row, dot};
pub use evidence::{Evidence, Judgement, OUTLIER_SIGMA, OUTLIERS, log_density, surprise};
pub use model::{CREEP, MAX_ACCELERATION, Motion, Record, SLOW, start};
pub use noise::{KINDS, Levels, Noise};
pub use state::*;
pub use step::{NewFrame, Reading, Step, Value, WheelStep};
pub use tape::{Entry, Tape};
pub use wheels::{
    CommonMotion, JITTER, MIN_SPEED, MIN_SQUARED_SPEED, add_equation, common_motion,
    turn_by_parallel_wheels,
};
