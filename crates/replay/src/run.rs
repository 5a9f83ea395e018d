//! One log through the engine.

use std::io;

use grouser_files::robot::RobotFile;
use grouser_log::Log;

use crate::choice::Inputs;
use crate::clocks::Clocks;
use crate::engine::Engine;
use crate::error::Result;
use crate::options::Options;
use crate::samples::RobotSamples;
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
    let mut clocks = Clocks::of(log, file, options)?;
    let mut samples = RobotSamples::new(log, file)?;
    let inputs = Inputs::of(log, file, options)?;
    let mut file = file.clone();
    let mut postponed = clocks.apply_delay(&mut file);
    let shifts = clocks.shifts(log);
    let mut held = clocks.held;
    // the robot would not have known of it
    let frozen = clocks.frozen.as_ref().filter(|_| options.offline);
    let dropout_s = held.dropout_s().unwrap_or(0.0);
    file.filter.dropout = file.filter.dropout.max(dropout_s);
    let mut engine = Engine::new(&file, inputs, options)?;
    for sample in log.samples(&shifts)? {
        let sample = sample?;
        if !held.keeps(&sample) || frozen.is_some_and(|of| !of.keeps(&sample)) {
            continue;
        }
        for sample in postponed.take(samples.convert(sample)) {
            engine.push(sample, sink)?;
        }
    }
    for sample in postponed.finish() {
        engine.push(sample, sink)?;
    }
    let mut summary = engine.finish(sink)?;
    summary.held_reference = held.counts();
    summary.clock_offset_s = clocks.gyro_offset_s;
    summary.reference_delay = clocks.reference_delay;
    let is_frozen = clocks.frozen.and_then(|of| of.found(options.offline));
    let mistakes = std::mem::take(&mut summary.findings.mistakes);
    summary.findings.mistakes = is_frozen.into_iter().chain(mistakes).collect();
    Ok(summary)
}
