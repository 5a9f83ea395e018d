//! The lugged wheel of NASA Glenn's single-wheel rig on the lunar simulant GRC-3, at published soil numbers.

use std::path::Path;

use grouser_terra::{Angle, GrouserRule, Grousers, Kinematics, OpenSoil, RigidWheel, Slip, Soil};

use super::fitting::law_error;
use grouser_identify::Result;
use grouser_identify::table::{Column, Table};
use grouser_identify::wheel::{Support, WheelTest, columns};

/// The file of the readings below the folder of measured data.
pub const READINGS: &str = "nasa-trec/pull_angle.csv";

/// Radius and width of the rim (m), and load (N). Source: Hu et al. 2024 (arXiv 2405.11001).
const WHEEL: (f64, f64, f64) = (0.25, 0.2, 171.7);

/// Height (m) and number of the lugs; their thickness is not stated with the readings, and taken as 0. Source: the same.
const LUGS: (f64, f64) = (0.025, 24.0);

/// The wheel.
///
/// # Errors
/// None in fact: the sizes are sound.
pub fn wheel() -> Result<RigidWheel> {
    let (height, count) = LUGS;
    let rule = GrouserRule::Lugs {
        count,
        thickness: 0.0,
    };
    RigidWheel::new(WHEEL.0, WHEEL.1)
        .and_then(|wheel| wheel.with_grousers(Grousers { height, rule }))
        .map_err(law_error)
}

/// GRC-3. Source: He et al. 2013, as given by the public code roverdevkit; K, `c_1` and `c_2` are not published with it and
/// are those that this code assumes.
#[must_use]
pub fn soil() -> OpenSoil {
    Soil::bekker(1.0e3, 700.0e3, 0.9)
        .cohesion(400.0)
        .phi(Angle::from_deg(42.0))
        .k_shear(0.018)
        .stress_position(0.4, 0.2)
}

/// The readings: slip, and the angle whose tangent is pull over load. Slips just below 0 are digitised zeros.
///
/// # Errors
/// As [`Table::read`]; [`Error::Content`](grouser_identify::Error::Content) where a column is missing.
pub fn tests(path: &Path) -> Result<Vec<WheelTest>> {
    let table = Table::read(path)?;
    let slips = table.numbers(columns::SLIP)?;
    let angles = table.numbers(Column(&[("pull_over_load_angle_deg", 1.0)]))?;
    let test = |(slip, angle): (f64, f64)| {
        Ok(WheelTest {
            kinematics: Kinematics::straight(Slip::new(slip).map_err(law_error)?),
            support: Support::Load(WHEEL.2),
            pull: Some(WHEEL.2 * Angle::from_deg(angle).tan()),
            side: None,
            torque: None,
            sinkage: None,
        })
    };
    slips.into_iter().zip(angles).map(test).collect()
}
