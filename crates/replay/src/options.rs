//! The options of a run.

use grouser_files::robot::WheelSensor;
use grouser_slip::Reference;
use grouser_terra::Soil;

/// What a run can be given beyond the files.
///
/// ```
/// use grouser_replay::Options;
///
/// let options = Options { to_s: Some(20.0), ..Options::default() };
/// assert!(options.reference.is_none()); // the robot file's, else the best in the log
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Every slip uses the whole log, and not what the robot would have known at its time.
    pub offline: bool,
    /// What measures how fast the robot travels; `None`: the robot file's, else the best in the log.
    pub reference: Option<Reference>,
    /// By which sensor the wheels are measured; `None`: the robot file's, else the first in the log.
    pub wheel_sensor: Option<WheelSensor>,
    /// What lies before this is left out of rows and summary, s from the log's start.
    pub from_s: Option<f64>,
    /// What lies after this is left out, s from the log's start.
    pub to_s: Option<f64>,
    /// Learns the soil on which the robot drives, of which this one is known.
    pub learn_soil: Option<Soil>,
}

impl Options {
    /// Those of a whole log: every slip uses all of it.
    #[must_use]
    pub fn whole_log() -> Self {
        Self {
            offline: true,
            ..Self::default()
        }
    }
}
