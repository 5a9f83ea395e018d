//! The smooth wheel of Ding et al. (2011) on the lunar simulant HIT-LSS1, read off their figures.

use std::path::Path;

use grouser_terra::{GrouserRule, Grousers, Kinematics, RigidWheel, Slip};

use grouser_identify::table::{Column, Table};
use grouser_identify::wheel::{Support, WheelTest, columns};
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

/// The file of the same wheel with lugs, which a folder of measured data may have.
pub const LUGGED: &str = "roverdevkit/ding_2011_lugged.csv";

/// Thickness of its lugs, m: not stated with the data. 2 mm changes the transported layer by 6 %.
const LUG_THICKNESS_M: f64 = 0.002;

/// The wheel with lugs and its tests: the file states height, number, load and what was measured.
///
/// # Errors
/// As [`Table::read`]; [`Error::Content`] where a column is missing; [`Error::Law`] for a size or slip that the laws
/// refuse.
pub fn lugged_tests(path: &Path) -> Result<(RigidWheel, Vec<WheelTest>)> {
    let table = Table::read(path)?;
    let number = |name: &'static [(&'static str, f64)]| table.numbers(Column(name));
    let height = number(&[("grouser_height_m", 1.0)])?;
    let count = number(&[("grouser_count", 1.0)])?;
    let load = table.numbers(columns::LOAD)?;
    let slip = table.numbers(columns::SLIP)?;
    let pull = table.numbers(columns::PULL)?;
    let sinkage = table.numbers(columns::SINKAGE)?;
    let torque = table.numbers(columns::TORQUE)?;
    let law = |source| Error::Law {
        what: "a row of Ding's lugged wheel".to_owned(),
        source,
    };
    let (Some(&height), Some(&count)) = (height.first(), count.first()) else {
        return Err(Error::Content {
            path: path.to_owned(),
            message: "there is no row".to_owned(),
        });
    };
    let rule = GrouserRule::Lugs {
        count,
        thickness: LUG_THICKNESS_M,
    };
    let wheel = RigidWheel::new(WHEEL.0, WHEEL.1)
        .and_then(|wheel| wheel.with_grousers(Grousers { height, rule }))
        .map_err(law)?;
    let tests = (0..table.len())
        .map(|i| {
            Ok(WheelTest {
                kinematics: Kinematics::straight(Slip::new(slip[i]).map_err(law)?),
                support: Support::Load(load[i]),
                pull: Some(pull[i]),
                side: None,
                torque: Some(torque[i]),
                sinkage: Some(sinkage[i]),
            })
        })
        .collect::<Result<_>>()?;
    Ok((wheel, tests))
}
