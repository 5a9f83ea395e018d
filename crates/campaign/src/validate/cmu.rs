//! The single-wheel test bed of Carnegie Mellon's Robomechanics Lab: steady-state averages per trial.

use std::path::Path;

use grouser_terra::{Angle, GrouserRule, Grousers, Kinematics, RigidWheel};

use grouser_identify::table::Table;
use grouser_identify::wheel::{Support, WheelTest, columns};
use grouser_identify::{Error, Result};

/// The file of the trials below the folder of measured data.
pub const TRIALS: &str = "cmu-wheel/trials.csv";

/// Radius and width of the rim, m.
pub const SIZE: (f64, f64) = (0.058, 0.05);

/// The file of further trials of the wheel with grousers, which a folder of measured data may have.
pub const LUG_TRIALS: &str = "cmu-lugs/trials.csv";

/// The grousers: height (m), number and thickness (m). The thickness follows from the share of the circumference,
/// a tenth, that the model published with the trials gives to their tips.
pub const GROUSERS: (f64, f64, f64) = (0.005, 24.0, 0.0015);

/// One trial.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Trial {
    /// Slip angle, rad: positive where the wheel drifts to its left.
    pub slip_angle: f64,
    /// The slip that the test bed states: rim speed against travel speed, whatever the slip angle.
    pub stated_slip: f64,
    /// The trial as a wheel test; its sinkage is the height below the test bed's zero.
    pub test: WheelTest,
    /// Standard deviation of the pull within the trial, N.
    pub pull_deviation: f64,
    /// Standard deviation of the side force within the trial, N.
    pub side_deviation: f64,
}

/// The wheel without grousers.
///
/// # Errors
/// None in fact: the sizes are sound.
///
/// ```
/// let wheel = grouser_campaign::validate::cmu::smooth_wheel()?;
/// assert!(wheel.grousers().is_none());
/// # Ok::<(), grouser_identify::Error>(())
/// ```
pub fn smooth_wheel() -> Result<RigidWheel> {
    RigidWheel::new(SIZE.0, SIZE.1).map_err(|source| Error::Law {
        what: "the wheel of the test bed".to_owned(),
        source,
    })
}

/// The wheel with its grousers. The test bed's rim speed is that of the rim, as this rule takes it.
///
/// # Errors
/// None in fact: the sizes are sound.
pub fn grouser_wheel() -> Result<RigidWheel> {
    let (height, count, thickness) = GROUSERS;
    let rule = GrouserRule::Lugs { count, thickness };
    smooth_wheel()?
        .with_grousers(Grousers { height, rule })
        .map_err(|source| Error::Law {
            what: "the grousers of the test bed".to_owned(),
            source,
        })
}

/// Reads the trials of a wheel (`smooth` or `grouser`), |stated slip| at most `max_slip`.
///
/// The carriage's speed V is the travel speed, so that V cos β is the speed in the wheel's plane. The columns are those of
/// `identify` ([`columns`]): forces of the sensor have the other sign. Locked wheels at a slip angle of 90° have no slip and are left out.
///
/// # Errors
/// As [`Table::read`]; [`Error::Content`] where a column is missing.
pub fn trials(path: &Path, wheel: &str, max_slip: f64) -> Result<Vec<Trial>> {
    let table = Table::read(path)?;
    let angle = table.numbers(columns::SLIP_ANGLE)?;
    let slip = table.numbers(columns::SLIP)?;
    let rim = table.numbers(columns::RIM)?;
    let travel = table.numbers(columns::TRAVEL)?;
    let side = columns::side_force(&table)?;
    let side_deviation = table.numbers(columns::SIDE_DEVIATION)?;
    let pull = table.numbers(columns::PULL)?;
    let pull_deviation = table.numbers(columns::PULL_DEVIATION)?;
    let load = table.numbers(columns::LOAD)?;
    let sinkage = table.numbers(columns::SINKAGE)?;
    let wheels = table.texts("wheel").ok_or_else(|| Error::Content {
        path: path.to_owned(),
        message: "there is no column `wheel`".to_owned(),
    })?;
    let mut out = Vec::new();
    for i in 0..table.len() {
        if wheels[i] != wheel || slip[i].abs() > max_slip {
            continue;
        }
        // a locked wheel dragged sideways: neither rim nor wheel plane has a speed, so that there is no slip
        if angle[i] == 90.0 && rim[i] == 0.0 {
            continue;
        }
        let beta = Angle::from_deg(angle[i]);
        // at 90° the wheel has no speed in its plane, to the last bit
        let forward = if angle[i] == 90.0 { 0.0 } else { beta.cos() };
        let kinematics =
            Kinematics::from_speeds(travel[i] * forward, travel[i] * beta.sin(), rim[i]).map_err(
                |source| Error::Law {
                    what: format!("trial in row {}", i + 1),
                    source,
                },
            )?;
        out.push(Trial {
            slip_angle: beta.rad(),
            stated_slip: slip[i],
            test: WheelTest {
                kinematics,
                support: Support::Load(load[i]),
                pull: Some(pull[i]),
                side: side[i],
                torque: None,
                sinkage: Some(sinkage[i]),
            },
            pull_deviation: pull_deviation[i],
            side_deviation: side_deviation[i],
        });
    }
    Ok(out)
}
