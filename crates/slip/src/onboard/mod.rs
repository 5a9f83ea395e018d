//! What a robot's computer runs: samples in, wheel commands out.
//!
//! ```text
//! samples ─► attitude, carriers ─► filter ─► detector, firmness ─► controller ─► wheel commands
//!                                    ▲
//!                  soil tables (slip demand on the slope, free wheel's skid), or the soil learnt while driving
//! ```
//!
//! [`OnBoard::update`] takes every sample as it arrives; [`OnBoard::tick`] runs at the rate of the control loop. Nothing is
//! allocated after construction, no clock is read, and nothing panics. The simulation of `grouser-rover` and a robot run
//! this same object; `examples/onboard_log.rs` of `grouser-replay` drives it from a recorded log.
//!
//! The primary type is [`OnBoard`]. What it does not do: it reads no files and knows no linkage beyond the
//! [`WheelCarrier`]s of its settings.

mod attitude;
mod carrier;
mod clock;
mod computer;
mod firmness;
mod learn;
mod settings;
mod soil_tables;
mod start_guard;
mod state;

pub use attitude::AttitudeFilter;
pub use carrier::{CarrierLink, Carriers, MAX_CARRIER_LINKS, MAX_JOINTS, WheelCarrier};
pub use computer::OnBoard;
pub use learn::{
    LEVELS, SLIP_POINTS, SlipTable, SoilBelief, SoilDemand, SoilEstimate, SoilFamily, SoilInterval,
    SoilLearnSettings, SoilLearner, SoilMember,
};
pub use settings::{OnBoardSettings, StartPolicy, WheelSetup};
pub use soil_tables::{SoilTables, TORQUE_POINTS, TorqueTable};
pub use state::OnBoardState;
