//! One log through the engine.

use std::io;

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_log::Log;
use grouser_slip::Reference;

use crate::align::gyro_offset;
use crate::choice::{Inputs, robot_wheels};
use crate::engine::Engine;
use crate::error::Result;
use crate::method::Method;
use crate::samples::of_robot;
use crate::sink::{Row, Rows, Sink};
use crate::summary::Summary;

/// What a run can be given beyond the files.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Which engine finds the slips; `None`: the filter where the robot's speed is measured.
    pub method: Option<Method>,
    /// Runs the filter forward and backward: every slip then uses the whole log.
    pub smooth: bool,
    /// What measures how fast the robot travels; `None`: the robot file's, else the best in the log.
    pub reference: Option<Reference>,
    /// By which sensor the wheels are measured; `None`: the robot file's, else the first in the log.
    pub wheel_sensor: Option<WheelSensor>,
    /// The window of means, s; `None`: the robot file's.
    pub window_s: Option<f64>,
    /// What lies before this is left out of rows and summary, s from the log's start.
    pub from_s: Option<f64>,
    /// What lies after this is left out, s from the log's start.
    pub to_s: Option<f64>,
}

/// Runs a log through the estimator; `take` gets a row for every wheel whenever that wheel was read.
///
/// # Errors
/// Whatever makes the log useless; an [`Error::Sink`](crate::Error::Sink) of `take`'s own.
pub fn run(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    take: impl FnMut(&Row<'_>) -> io::Result<()>,
) -> Result<Summary> {
    run_into(log, file, options, &mut Rows(take))
}

/// As [`run`], into a [`Sink`] that takes more than rows.
///
/// # Errors
/// As [`run`].
pub fn run_into(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    sink: &mut impl Sink,
) -> Result<Summary> {
    let wheels = robot_wheels(log, file)?;
    let inputs = Inputs::of(log, file, options)?;
    let mut engine = Engine::new(file, inputs, options)?;
    let mut shifts = vec![0; log.clocks()];
    let unaligned = log.unaligned_clocks();
    if !unaligned.is_empty() {
        let offset_s = gyro_offset(log, file, &wheels, inputs.wheel_sensor)?;
        engine.set_clock_offset(offset_s);
        #[allow(
            clippy::cast_possible_truncation,
            reason = "the offset is at most half a second"
        )]
        let shift_ns = (offset_s.unwrap_or(0.0) * -1e9).round() as i64;
        for clock in unaligned {
            shifts[clock] = shift_ns;
        }
    }
    for sample in log.samples(&shifts)? {
        engine.push(of_robot(sample?, &wheels), sink)?;
    }
    engine.finish(sink)
}
