#![doc = include_str!("../README.md")]
//!
//! ## In this crate
//!
//! The primary type is [`WheelOnSoil`]; [`BatchKernel`] computes many points at once, and [`Contact`] has
//! the same laws over any kind of number ([`grouser_real::Real`]), dual numbers included.
//!
//! Three outcomes are never mixed: bad input is an [`Error`] that names field, value, limit and unit; a load
//! that nothing carries is a [`LoadOutcome`]; what lies outside a law's comfortable range is computed and
//! carries a [`Caution`].
//!
//! Sources by their keys: \[Ani2012\] Ani, Xu, Xue, Liu & Zhang, J. Cent. South Univ. 19, 2458-2467, with its
//! equations (P1)…(P24) · \[WR67\] Wong & Reece, J. Terramechanics 4 (1967) I and II · \[Bekker69\] Introduction
//! to Terrain-Vehicle Systems · \[JH61\] Janosi & Hanamoto 1961 · \[Wong08\] Theory of Ground Vehicles ·
//! \[Ishigami07\] J. Field Robotics 24 · \[Ding11\] J. Terramechanics 48.
//!
//! The crate contains no robots, time, sensors or terrain; other crates build these on it.
#![cfg_attr(not(feature = "std"), no_std)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// denied in the workspace; `lanes::machine` alone allows it
#![deny(unsafe_code)]
// a new law or status has to be led to every `match`
#![cfg_attr(not(test), warn(clippy::wildcard_enum_match_arm))]

mod angle;
mod bulldozing;
pub mod catalogue;
mod caution;
mod contact;
mod derivative;
mod error;
mod fitted_range;
mod followed;
mod forces;
mod gravity;
mod kernel;
mod kinematics;
mod lanes;
mod law_preset;
mod lugs;
mod multi_pass;
mod open_soil;
mod operating_point;
mod pressure;
mod quadrature;
mod settings;
mod shear;
mod side_disc;
mod sinkage;
mod slip;
mod slip_model;
mod slip_search;
mod slip_velocity;
pub mod slope;
mod soil;
mod soil_history;
mod status;
mod traction;
mod wheel;
mod wheel_on_soil;

pub use angle::Angle;
pub use bulldozing::{Bulldozing, bulldozing_hegedus};
pub use caution::{Caution, Cautions, is_deep};
pub use contact::{
    Contact, ContactAngles, Motion, StressPosition, WheelSize, entry_angle,
    sinkage_from_entry_angle,
};
pub use derivative::{DualInputs, DualSolution};
pub use error::{Error, Result};
pub use fitted_range::FittedRange;
pub use forces::Forces;
pub use gravity::{
    EARTH_GRAVITY_M_PER_S2, MARS_GRAVITY_M_PER_S2, MOON_GRAVITY_M_PER_S2, gravity_of,
};
pub use grouser_real::{FieldValue, OutOfRange, ReadField, ResultField};
pub use kernel::Kernel;
pub use kinematics::Kinematics;
pub use lanes::{
    BatchColumns, BatchInput, BatchKernel, BatchPoints, BestOf, BestSlipColumns, LaneMask, Lanes,
    SoilColumns, instructions,
};
pub use law_preset::{LawPreset, ModelError};
pub use lugs::{LugPassage, lug_mobilisation, lug_spacing_skonieczny, lug_transport_layer};
pub use multi_pass::{MultiPass, PassChange};
pub use open_soil::OpenSoil;
pub use operating_point::OperatingPoint;
pub use pressure::{
    Bekker, Pressure, Reece, SinkageExponent, SlipSinkage, level_off, transport_depth_reece,
};
pub use settings::{Accuracy, Settings};
pub use shear::{MohrCoulomb, ShearLaw, mobilised_janosi, transition_angle_wong_reece};
pub use side_disc::passive_pressure_coulomb;
pub use sinkage::{LoadOutcome, LoadSolution, MAX_MISS, Prescribed, Sinkage, SinkageSolution};
pub use slip::{Slip, WheelMotion};
pub use slip_model::{Mobilised, ModelOutcome, ModelSlip, slip_ani, slip_model};
pub use slip_velocity::{DrivingSlip, SlipNorm, SlipVelocity};
pub use soil::{LawChoice, Soil, SoilLaws, SoilParams};
pub use soil_history::{Entry, SideForce, SoilHistory};
pub use status::SolveStatus;
pub use traction::{BestSlip, SlopeOutcome, SteepestSlope};
pub use wheel::{GrouserRule, Grousers, RigidWheel};
pub use wheel_on_soil::WheelOnSoil;
