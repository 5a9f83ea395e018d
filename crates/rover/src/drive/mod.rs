//! A drive: a scenario, the loop of robot, sensors, estimator and controller, and what came of it.

mod attitude_filter;
mod file;
mod firmness;
mod motor_driver;
mod outcome;
mod pilot;
mod referee;
mod run;
mod scenario;
mod suspension;
mod truth;
mod watch;

pub use file::{parse_scenario, read_scenario};
pub use outcome::{DriveResult, NamedDecision, Outcome, SlipScore};
pub use pilot::Pilot;
pub use run::{Drive, Frame, WheelFrame};
pub use scenario::{GroundShape, GroundSpec, Leg, Region, Scenario, SoilSpec};
