//! One log through the engine.

use std::io;

use grouser_files::robot::RobotFile;
use grouser_log::Log;

use crate::align::gyro_offset;
use crate::choice::{Inputs, robot_wheels};
use crate::engine::Engine;
use crate::error::Result;
use crate::held::Held;
use crate::method::Method;
use crate::options::Options;
use crate::reference_delay::{Postponed, ReferenceDelay, reference_delay};
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
    let clocks = Clocks::of(log, file, options)?;
    let mut summary = run_once(log, file, options, &clocks, sink)?;
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
        let mut nowhere = Rows(|_: &Row<'_>| Ok(()));
        let beside = run_once(log, file, &by_windows, &clocks, &mut nowhere)?;
        for (wheel, other) in summary.wheels.iter_mut().zip(beside.wheels) {
            wheel.window_slip = Some(other.slip);
        }
    }
    Ok(summary)
}

/// How the clocks of a log's sensors differ and which rows are readings, found in passes before the run.
#[derive(Clone, Debug)]
struct Clocks {
    /// How much later the gyro's clock stamps the same moment than the encoders', s, where that is to be found.
    gyro_offset_s: Option<f64>,
    reference_delay: Option<ReferenceDelay>,
    held: Held,
}

impl Clocks {
    fn of(log: &Log, file: &RobotFile, options: &Options) -> Result<Self> {
        let mut clocks = Self {
            gyro_offset_s: None,
            reference_delay: None,
            held: Held::of(log, file, options, &[])?,
        };
        if !log.unaligned_clocks().is_empty() {
            let wheels = robot_wheels(log, file)?;
            let sensor = Inputs::of(log, file, options)?.wheel_sensor;
            clocks.gyro_offset_s = gyro_offset(log, file, &wheels, sensor)?;
        }
        let shifts = clocks.shifts(log);
        clocks.reference_delay = reference_delay(log, file, options, &shifts, &clocks.held)?;
        Ok(clocks)
    }

    /// What is added to the times of each clock of the log, ns.
    fn shifts(&self, log: &Log) -> Vec<i64> {
        let mut shifts = vec![0; log.clocks()];
        #[allow(
            clippy::cast_possible_truncation,
            reason = "the offset is at most half a second"
        )]
        let shift_ns = (self.gyro_offset_s.unwrap_or(0.0) * -1e9).round() as i64;
        for clock in log.unaligned_clocks() {
            shifts[clock] = shift_ns;
        }
        shifts
    }
}

fn run_once(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    clocks: &Clocks,
    sink: &mut impl Sink,
) -> Result<Summary> {
    let mut samples = RobotSamples::new(log, file)?;
    let inputs = Inputs::of(log, file, options)?;
    let mut file = file.clone();
    let method = options.method_for(&file.robot, inputs.reference);
    let mut delay = clocks.reference_delay;
    let early_ns = (delay.as_mut()).map_or(0, |delay| delay.apply(&mut file, method));
    let mut held = clocks.held.clone();
    let dropout_s = held.dropout_s().unwrap_or(0.0);
    file.filter.dropout = file.filter.dropout.max(dropout_s);
    let mut engine = Engine::new(&file, inputs, options)?;
    engine.set_clocks(clocks.gyro_offset_s, delay);
    let mut postponed = Postponed::by(early_ns);
    for sample in log.samples(&clocks.shifts(log))? {
        let sample = sample?;
        if !held.keeps(&sample) {
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
    Ok(summary)
}
