//! How the clocks of a log's sensors differ and which rows are readings, found in passes before the run.

use grouser_doctor::{Frozen, Held, ReferenceDelay, Tracks, gyro_offset};
use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_slip::Reference;

use crate::choice::{Inputs, robot_wheels};
use crate::error::Result;
use crate::mounting::Mounting;
use crate::options::Options;
use crate::postponed::Postponed;
use crate::samples::{RobotSamples, held, of_robot};
use crate::steering::WheelSteering;

/// How the clocks of a log's sensors differ and which rows are readings, found in passes before the run.
#[derive(Clone, Debug)]
pub(crate) struct Clocks {
    /// How much later the gyro's clock stamps the same moment than the encoders', s, where that is to be found.
    pub(crate) gyro_offset_s: Option<f64>,
    /// How much later than the wheels the gyro is, s, beside what is shifted by [`Clocks::shifts`].
    pub(crate) late_gyro_s: f64,
    pub(crate) reference_delay: Option<ReferenceDelay>,
    pub(crate) held: Held,
    /// Where the reference is constant while the wheels turn, if it is one of places.
    pub(crate) frozen: Option<Frozen>,
}

impl Clocks {
    pub(crate) fn of(log: &Log, file: &RobotFile, options: &Options) -> Result<Self> {
        let mut clocks = Self {
            gyro_offset_s: None,
            late_gyro_s: 0.0,
            reference_delay: None,
            held: held(log, file, options, &[])?,
            frozen: None,
        };
        if !log.unaligned_clocks().is_empty() {
            let wheels = robot_wheels(log, file)?;
            let sensor = Inputs::of(log, file, options)?.wheel_sensor;
            let mut tracks = Tracks::new(file, Reference::Grip, sensor);
            for sample in log.samples(&[])? {
                if tracks.take(&of_robot(sample?, &wheels)) {
                    break;
                }
            }
            clocks.gyro_offset_s = gyro_offset(&tracks);
        }
        let shifts = clocks.shifts(log);
        let passed = tracks(log, file, options, &shifts, clocks.held.clone())?;
        if let Some((tracks, frozen)) = passed {
            clocks.reference_delay = ReferenceDelay::find(&[tracks], file);
            clocks.frozen = Some(frozen);
        }
        if let Some(delay) = clocks.reference_delay {
            clocks.late_gyro_s = delay.gyro_delay_s.unwrap_or(0.0);
            clocks.gyro_offset_s = clocks.gyro_offset_s.or(delay.gyro_delay_s);
        }
        Ok(clocks)
    }

    /// What is added to the times of each clock of the log, ns.
    pub(crate) fn shifts(&self, log: &Log) -> Vec<i64> {
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

    /// Uses the delay of the reference where it is clear and the file states none: as the filter's latency, or, of a reference
    /// that is early, by postponing it; a gyro that is not on the wheels' time is corrected as well.
    pub(crate) fn apply_delay(&mut self, file: &mut RobotFile) -> Postponed {
        let late_gyro_s = self.late_gyro_s;
        let postponed = |reference_s| Postponed::by(reference_s, late_gyro_s);
        let is_used = |delay: &&mut ReferenceDelay| {
            delay.is_clear && !delay.is_stated && !delay.is_beyond_correction()
        };
        let Some(delay) = self.reference_delay.as_mut().filter(is_used) else {
            return postponed(0.0);
        };
        delay.is_applied = true;
        if delay.delay_s < 0.0 {
            return postponed(-delay.delay_s);
        }
        file.filter.reference_latency = delay.delay_s;
        postponed(0.0)
    }
}

/// How far wheels, gyro and reference moved over a log, and where the reference did not; `None` without an absolute reference.
fn tracks(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    shifts: &[i64],
    mut held: Held,
) -> Result<Option<(Tracks, Frozen)>> {
    let mut samples = RobotSamples::new(log, file)?;
    let inputs = Inputs::of(log, file, options)?;
    if matches!(inputs.reference, Reference::FreeWheel | Reference::Grip) {
        return Ok(None);
    }
    let mut mounting = Mounting::new(&file.corrections, &inputs);
    let mut tracks = Tracks::new(file, inputs.reference, inputs.wheel_sensor);
    let mut frozen = Frozen::new(&file.robot, inputs.wheel_sensor);
    let mut is_long = false;
    let steering = (file.steering.as_ref()).map(|of| WheelSteering::new(of, &file.robot));
    for sample in log.samples(shifts)? {
        let sample = sample?;
        if !held.keeps(&sample) {
            continue;
        }
        let mut sample = samples.convert(sample);
        mounting.correct(&mut sample);
        frozen.take(&sample);
        if !is_long {
            let steered = steering.iter().flat_map(|of| of.angles(&sample));
            for steered in steered {
                tracks.take(&steered);
            }
            is_long = tracks.take(&sample);
        }
    }
    frozen.finish();
    Ok(Some((tracks, frozen)))
}

/// The delay of the reference in several logs, each a run. `None` where they do not show it: too short, no absolute reference, or
/// hardly a change of speed or of turn, or where halves of the logs or wheels and gyro contradict each other.
///
/// # Errors
/// What is wrong with a log.
///
/// ```
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_replay::{Options, calibrate_reference_delay};
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?;
/// // A free wheel is on the clock of the other wheels.
/// assert!(calibrate_reference_delay(&[log], &robot, &Options::default())?.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn calibrate_reference_delay(
    logs: &[Log],
    file: &RobotFile,
    options: &Options,
) -> Result<Option<ReferenceDelay>> {
    let mut all = Vec::new();
    for log in logs {
        let held = held(log, file, options, &[])?;
        all.extend(tracks(log, file, options, &[], held)?.map(|of| of.0));
    }
    Ok(ReferenceDelay::find(&all, file))
}
