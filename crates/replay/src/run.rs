//! One log through the engine.

use std::io;

use grouser_files::robot::RobotFile;
use grouser_log::Log;

use crate::align::gyro_offset;
use crate::choice::{Inputs, robot_wheels};
use crate::engine::Engine;
use crate::error::Result;
use crate::method::Method;
use crate::options::Options;
use crate::samples::of_robot;
use crate::sink::{Row, Rows, Sink};
use crate::summary::Summary;

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
///
/// ```
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_replay::{Options, Row, Sink, run_into};
///
/// /// Counts the rows.
/// #[derive(Default)]
/// struct Count(usize);
/// impl Sink for Count {
///     fn row(&mut self, _: &Row<'_>) -> std::io::Result<()> {
///         self.0 += 1;
///         Ok(())
///     }
/// }
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?;
/// let mut count = Count::default();
/// let summary = run_into(&log, &robot, &Options::default(), &mut count)?;
/// assert_eq!(count.0, 5 * 2001);
/// assert_eq!(summary.wheels.len(), 5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_into(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    sink: &mut impl Sink,
) -> Result<Summary> {
    let mut summary = run_once(log, file, options, sink)?;
    // Where the filter's own checks fail, the window estimator's result stands beside it.
    if summary
        .fused
        .as_ref()
        .is_some_and(|fused| !fused.doubts.is_empty())
    {
        let by_windows = Options {
            method: Some(Method::Window),
            smooth: false,
            learn_soil: None,
            ..*options
        };
        let beside = run_once(log, file, &by_windows, &mut Rows(|_: &Row<'_>| Ok(())))?;
        for (wheel, other) in summary.wheels.iter_mut().zip(beside.wheels) {
            wheel.window_slip = Some(other.slip);
        }
    }
    Ok(summary)
}

fn run_once(
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
