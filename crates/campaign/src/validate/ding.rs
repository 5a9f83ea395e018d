//! The smooth wheel of Ding et al. (2011) on the lunar simulant HIT-LSS1, read off their figures.

use grouser_terra::{Kinematics, Slip};

use grouser_identify::wheel::{Support, WheelTest};
use grouser_identify::{Error, Result};

/// Radius and width, m; load, N.
pub const WHEEL: (f64, f64, f64) = (0.15735, 0.165, 80.0);

/// K as that paper gives it for this soil, m.
pub const K_SHEAR_RANGE: (f64, f64) = (9.7e-3, 13.1e-3);

/// Slip, drawbar pull (N), torque (N m) and sinkage (mm). Source: Ding et al., J. Terramechanics 48 (2011)
/// \[Ding11\], digitised.
pub const POINTS: [(f64, f64, f64, f64); 6] = [
    (0.0, -6.5, 0.0, 5.0),
    (0.1, 11.0, 3.0, 5.5),
    (0.2, 14.5, 4.2, 7.5),
    (0.3, 15.0, 4.8, 10.0),
    (0.4, 15.0, 5.0, 12.5),
    (0.6, 15.0, 5.3, 17.5),
];

/// The points as wheel tests.
///
/// # Errors
/// None in fact: the slips are sound.
pub fn tests() -> Result<Vec<WheelTest>> {
    POINTS
        .into_iter()
        .map(|(slip, pull, torque, sinkage)| {
            let slip = Slip::new(slip).map_err(|source| Error::Law {
                what: "a slip of Ding's figures".to_owned(),
                source,
            })?;
            Ok(WheelTest {
                kinematics: Kinematics::straight(slip),
                support: Support::Load(WHEEL.2),
                pull: Some(pull),
                side: None,
                torque: Some(torque),
                sinkage: Some(1e-3 * sinkage),
            })
        })
        .collect()
}
