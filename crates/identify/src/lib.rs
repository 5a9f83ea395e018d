//! Soil parameters from simple tests, with what the data say about each.
//!
//! ```text
//! plate tests → n, k_c, k_phi      ln p = ln(k_c/b + k_phi) + n ln(z − z_0)
//! shear tests → c, φ, K            τ = (c + σ tan φ)(1 − e^(−j/K))
//! wheel tests → the rest           min Σ ρ((model − measured)/scatter), Levenberg-Marquardt, exact derivatives
//! ```
//!
//! ```
//! use grouser_identify::plate::{Plate, PlateSettings, PlateTest, fit_plates};
//! // a disc of 60 mm on a soil of n = 1.21 and k = 2387 kPa/mⁿ
//! let plate = Plate::disc(0.06)?;
//! let depth: Vec<f64> = (1..=40).map(|i| 1e-3 * f64::from(i)).collect();
//! let force = depth.iter().map(|z| 2387e3 * z.powf(1.21) * plate.area).collect();
//! let test = PlateTest { name: "disc".into(), plate, depth, force };
//! let found = fit_plates(&[test], &PlateSettings::default())?;
//! assert!((found.n - 1.21).abs() < 1e-9 && (found.k_phi / 2387e3 - 1.0).abs() < 1e-9);
//! # Ok::<(), grouser_identify::Error>(())
//! ```
//!
//! The primary type is [`Identification`], which a [`Job`] file leads to ([`identify()`]); each kind of test
//! has its own module. The crate fits; the laws are in `grouser-terra`.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod error;
mod identification;
mod identified;
mod job;
pub mod least_squares;
mod parameter;
pub mod plate;
pub mod shear;
pub mod table;
pub mod wheel;

pub use error::{Error, Result};
pub use identification::{
    Identification, PlateStage, ShearStage, WheelNumber, WheelStage, identify,
};
pub use identified::IdentifiedNumber;
pub use job::{BagTest, Job, PlateSource, WheelJob};
pub use parameter::Parameter;
