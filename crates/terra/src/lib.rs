//! The wheel in the soil.
#![cfg_attr(not(feature = "std"), no_std)]
// denied in the workspace; `lanes::machine` alone allows it
#![deny(unsafe_code)]

mod angle;
mod bulldozing;
pub mod catalogue;
mod caution;
mod closed_form;
mod contact;
mod error;
mod forces;
mod kinematics;
mod lanes;
mod operating_point;
mod pressure;
mod quadrature;
mod settings;
mod shear;
mod sinkage;
mod slip;
mod slip_model;
mod soil;
mod traction;
mod wheel;
mod wheel_on_soil;

pub use angle::Angle;
pub use bulldozing::{Bulldozing, bulldozing_hegedus};
pub use caution::{Caution, Cautions};
pub use closed_form::ClosedForm;
pub use contact::{
    Contact, ContactAngles, Motion, WheelSize, entry_angle, sinkage_from_entry_angle,
};
pub use error::{Error, Result};
pub use forces::Forces;
pub use kinematics::Kinematics;
pub use lanes::{BatchForces, BatchKernel, BatchOutcome, BatchPoints, LaneMask, Lanes};
pub use operating_point::OperatingPoint;
pub use pressure::{Bekker, Pressure, Reece, SinkageExponent};
pub use settings::{Accuracy, Settings};
pub use shear::{MohrCoulomb, ShearLaw, mobilised_janosi, transition_angle_wong_reece};
pub use sinkage::{LoadSolution, LoadStatus, SinkageSolution};
pub use slip::{Slip, WheelMotion};
pub use slip_model::{Mobilised, ModelOutcome, ModelSlip, slip_ani, slip_model};
pub use soil::{Soil, SoilLaws, SoilParams};
pub use traction::{BestSlip, SlopeOutcome};
pub use wheel::{GrouserRule, Grousers, RigidWheel};
pub use wheel_on_soil::WheelOnSoil;
