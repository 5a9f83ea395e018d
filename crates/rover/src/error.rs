//! What is wrong with a robot, a terrain or a scenario.

use grouser_files::nearest;
use grouser_terra::OutOfRange;
use std::path::PathBuf;

use crate::terrain_fault::TerrainFault;

/// The result of everything that checks a description.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A description that cannot be used.
///
/// ```
/// use grouser_rover::{Error, robot::RobotModel};
///
/// let error = RobotModel::read("no-such-robot.toml".as_ref()).unwrap_err();
/// assert!(matches!(error, Error::File(_)));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside its limits (NaN always does).
    #[error("{of}: {range}")]
    OutOfRange {
        /// What it belongs to.
        of: String,
        /// The number and its limits.
        range: OutOfRange,
    },
    /// Something needed is not there.
    #[error("{of} lacks {what}")]
    Missing {
        /// What it belongs to.
        of: String,
        /// What is missing.
        what: String,
    },
    /// A name that stands for nothing.
    #[error("{of} names `{name}`, which does not exist{}", .meant.as_ref().map(|m| format!("; did you mean `{m}`?")).unwrap_or_default())]
    Unknown {
        /// What names it.
        of: String,
        /// The name.
        name: String,
        /// The nearest name that exists.
        meant: Option<String>,
    },
    /// More than the simulation holds.
    #[error("{what}: {count}, but at most {limit} are possible")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
        /// The limit.
        limit: usize,
    },
    /// A terrain file that cannot be used.
    #[error("{}: {fault}", .file.display())]
    Terrain {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        fault: TerrainFault,
    },
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", .file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// One of our own files says something wrong.
    #[error(transparent)]
    File(#[from] grouser_files::Error),
    /// The controller has no slip setpoint: no slip gives a drawbar pull.
    #[error("wheel \"{wheel}\" under {load} N on \"{soil}\" has no drawbar pull at any slip")]
    NoSlipSetpoint {
        /// The wheel.
        wheel: String,
        /// The soil.
        soil: String,
        /// What the wheel carries, N.
        load: f64,
    },
    /// The laws of wheel and soil refuse a number.
    #[error("{of}: {source}")]
    Law {
        /// Of which wheel or soil.
        of: String,
        /// What they say.
        source: grouser_terra::Error,
    },
    /// The estimator refuses a robot or a setting.
    #[error(transparent)]
    Estimator(#[from] grouser_slip::Error),
}

impl Error {
    /// Checks that `value` lies in [low, high].
    pub(crate) fn check(
        of: &str,
        field: &'static str,
        value: f64,
        limits: (f64, f64),
        unit: &'static str,
    ) -> Result<()> {
        OutOfRange::check(field, value, limits, unit).map_err(|range| Self::OutOfRange {
            of: of.to_owned(),
            range,
        })
    }

    /// What to do about it, where there is something to say.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::File(error) => error.hint(),
            Self::Terrain { fault, .. } => fault.hint().map(str::to_owned),
            Self::NoSlipSetpoint { .. } => {
                Some("give `optimum` under `[control]` in the scenario".to_owned())
            }
            _ => None,
        }
    }
}

/// The index of a name that `of` gives.
pub(crate) fn find<'a>(
    of: &str,
    name: &str,
    mut names: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize> {
    names
        .clone()
        .position(|other| other == name)
        .ok_or_else(|| Error::Unknown {
            of: of.to_owned(),
            name: name.to_owned(),
            meant: nearest(name, names.by_ref()).map(Into::into),
        })
}
