//! Soil learnt while driving: a weight for each of 16 soils, updated by Bayes' rule from what slip, pull and torque show.
//!
//! ```text
//! slips, torques, sinkages, force ─► means over half a turn ─► weights of 16 soils ─► belief in use
//!                                                                  ▲                       │
//!                              tables of pull and torque over slip ┘     slip demand, slip setpoint, expected torque
//! ```
//!
//! The specific force measures the pull: forwards over upwards it is the pull of all wheels over the load of all wheels, on
//! a slope and while accelerating alike. Sinkages and entry angles enter where they are measured; without them the rest
//! does. A soil that no slip can climb has its weight like any other.

mod belief;
mod contact;
mod family;
mod learner;
mod readings;
mod settings;

pub use belief::{SoilBelief, SoilEstimate, SoilInterval};
pub use family::{LEVELS, SLIP_POINTS, SlipTable, SoilFamily, SoilMember};
pub use learner::{SoilDemand, SoilLearner};
pub use settings::SoilLearnSettings;
