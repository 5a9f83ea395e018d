//! A log through the check of units, signs and axes.

use grouser_doctor::StartOutcome;
use grouser_files::robot::RobotFile;
use grouser_log::Log;

use crate::choice::Inputs;
use crate::error::{Error, Result};
use crate::options::Options;
use crate::samples::{RobotSamples, held};

/// Compares the sensors of a log with each other: units, signs and axes.
///
/// ```
/// use grouser_doctor::StartOutcome;
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_replay::{Options, check_start};
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], columns::read(&example.join("columns.toml"))?)?;
/// let outcome = check_start(&log, &robot, &Options::default())?;
/// assert!(!matches!(outcome, StartOutcome::Implausible { .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Whatever makes the log useless, and a robot that the filter does not take.
pub fn check_start(log: &Log, file: &RobotFile, options: &Options) -> Result<StartOutcome> {
    let mut samples = RobotSamples::new(log, file)?;
    let sensor = Inputs::of(log, file, options)?.wheel_sensor;
    let mut held = held(log, file, options, &[])?;
    let readings = log.samples(&vec![0; log.clocks()])?.filter_map(|sample| {
        let sample = match sample {
            Ok(sample) => samples.convert(Some(sample).filter(|sample| held.keeps(sample))?),
            Err(error) => return Some(Err(Error::from(error))),
        };
        sensor.uses(&sample.measurement).then_some(Ok(sample))
    });
    grouser_doctor::check_start(file, readings)
}
