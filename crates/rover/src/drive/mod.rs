//! A simulated drive: a scenario, the loop of robot, sensors and on-board computer, and its result.
//!
//! The primary type is [`Simulation`]. The robot's computer is [`grouser_slip::onboard::OnBoard`], the object that a real
//! robot runs; only ground, robot and sensors are simulated.

mod baseline;
mod file;
mod frame;
mod motor_driver;
mod on_board;
mod outcome;
mod pilot;
mod referee;
mod scenario;
mod score;
mod simulation;
mod write;

pub use baseline::{MIN_GAIN, equal_speed_share};
pub use file::{parse_scenario, read_scenario};
pub use frame::{Frame, WheelFrame};
pub use outcome::{DriveResult, NamedDecision, Outcome, SlipScore};
pub use pilot::Pilot;
pub use scenario::{
    GroundShape, GroundSpec, LearnSpec, Leg, PlanSpec, Region, Scenario, SoilChanges, SoilOrigin,
    SoilSpec,
};
pub use simulation::Simulation;
pub use write::to_toml;
