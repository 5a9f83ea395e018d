//! The effective radius from runs without slip.

use grouser_files::robot::RobotFile;
use grouser_log::Log;

use crate::error::{Error, Result};
use crate::options::Options;
use crate::run::run;

/// What a calibration found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Calibration {
    /// Effective radius over the radius in the robot file, of all runs together.
    pub factor: f64,
    /// The same of each run alone: how far they agree is how far the factor can be trusted.
    pub factors: Vec<f64>,
}

impl Calibration {
    /// Half the spread between the runs; `None` of one run.
    ///
    /// ```
    /// use grouser_files::{columns, robot};
    /// use grouser_log::Log;
    /// use grouser_replay::{Options, calibrate_radius};
    ///
    /// let example = std::path::Path::new("../../examples/five-wheel");
    /// let robot = robot::read(&example.join("robot.toml"))?;
    /// let open = || -> Result<Log, Box<dyn std::error::Error>> {
    ///     Ok(Log::find(&[example.join("log.csv")], columns::read(&example.join("columns.toml"))?)?)
    /// };
    /// // One run twice: both give the same factor.
    /// let found = calibrate_radius(&[open()?, open()?], &robot, &Options::default())?;
    /// assert_eq!(found.half_spread(), Some(0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn half_spread(&self) -> Option<f64> {
        let least = self.factors.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.factors.iter().copied().fold(0.0, f64::max);
        (self.factors.len() > 1).then_some(0.5 * (most - least))
    }
}

/// The factor by which the radii of all powered wheels are to be multiplied so that runs on ground
/// without slip show none: the way by the reference over the way by the wheels.
///
/// Assumes: no slip in these runs, one factor for all wheels. What is left of a true slip in them ends
/// up in the radius and lowers every slip found with it: use hard, level ground and gentle driving.
///
/// # Errors
/// As [`run`]; [`Error::NoCalibration`] where the ways do not give a sensible factor.
///
/// ```
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_replay::{Options, calibrate_radius};
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?;
/// let found = calibrate_radius(&[log], &robot, &Options::default())?;
/// // This run slips: the calibration would take its slip for a smaller radius.
/// assert!(found.factor < 1.0 && found.half_spread().is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn calibrate_radius(logs: &[Log], file: &RobotFile, options: &Options) -> Result<Calibration> {
    let (mut reference, mut wheels) = (0.0, 0.0);
    let mut factors = Vec::new();
    for log in logs {
        let along = run(log, file, options, |_| Ok(()))?.along;
        let travel_reference = along.travel_reference.ok_or(Error::NoReference {
            reference: "any",
            needs: "a displacement, a pose, a speed over ground or a free wheel",
        })?;
        let factor = travel_reference / along.travel_wheels;
        if !(factor > 0.2 && factor < 5.0) {
            return Err(Error::NoCalibration {
                travel_reference,
                travel_wheels: along.travel_wheels,
            });
        }
        factors.push(factor);
        reference += travel_reference.abs();
        wheels += along.travel_wheels.abs();
    }
    Ok(Calibration {
        factor: reference / wheels,
        factors,
    })
}
