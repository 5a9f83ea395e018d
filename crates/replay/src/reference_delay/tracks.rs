//! Ways and turns of a log as they are stamped: by the wheels, by the gyro, and by the reference.

use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_slip::{Measurement, Reference};

use super::rims::Rims;
use super::steps::{Step, Steps};
use super::track::Track;
use crate::choice::Inputs;
use crate::error::Result;
use crate::held::Held;
use crate::options::Options;
use crate::samples::{RobotSamples, is_used};

/// Nothing is known between two readings of a gyro that are further apart, s: whether a rate is of the moment of its stamp or
/// the mean since the one before, half of the time between them, is not known.
const MAX_GYRO_GAP_S: f64 = 0.07;
/// Length of a log that is used, s.
const MAX_LOG_S: f64 = 1800.0;

/// What the reference measured between two stamps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passed {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    /// m or rad.
    pub(super) amount: f64,
}

/// The tracks of a log.
#[derive(Clone, Debug, Default)]
pub(super) struct Tracks {
    /// Way of the rims along the robot, m.
    pub(super) rims: Track,
    /// Turn by the gyro, rad.
    pub(super) gyro: Track,
    /// Ways and turns by the reference.
    pub(super) ways: Vec<Passed>,
    pub(super) turns: Vec<Passed>,
}

impl Tracks {
    /// Of a log, to whose clocks `shifts` are added, ns; empty without an absolute reference.
    pub(super) fn of(
        log: &Log,
        file: &RobotFile,
        options: &Options,
        shifts: &[i64],
        mut held: Held,
    ) -> Result<Self> {
        let mut samples = RobotSamples::new(log, file)?;
        let inputs = Inputs::of(log, file, options)?;
        if matches!(inputs.reference, Reference::FreeWheel | Reference::Grip) {
            return Ok(Self::default());
        }
        let mut rims = Rims::new(file);
        let mut tracks = Self::default();
        let mut steps = Steps::new(inputs.reference, file.corrections.pose_yaw_offset);
        let mut start_ns = None;
        let mut last_rate: Option<(f64, f64)> = None;
        for sample in log.samples(shifts)? {
            let sample = sample?;
            if !held.keeps(&sample) {
                continue;
            }
            let sample = samples.convert(sample);
            let start = *start_ns.get_or_insert(sample.time_ns);
            let time_s = sample.time_ns.saturating_sub(start) as f64 * 1e-9;
            if time_s > MAX_LOG_S {
                break;
            }
            if !is_used(&sample.measurement, inputs.wheel_sensor) {
                continue;
            }
            if let Measurement::YawRate { rate } = sample.measurement {
                let rate = rate * file.corrections.yaw_rate_scale;
                let last = last_rate.replace((time_s, rate));
                match last.filter(|(last_s, _)| time_s - last_s <= MAX_GYRO_GAP_S) {
                    Some((last_s, last)) => {
                        tracks
                            .gyro
                            .add(time_s, 0.5 * (last + rate) * (time_s - last_s));
                    }
                    None => tracks.gyro.interrupt(time_s),
                }
            }
            rims.take(time_s, &sample);
            if let Some(step) = steps.take(time_s, &sample.measurement) {
                tracks.enter(step, rims.along);
            }
        }
        tracks.rims = rims.track;
        Ok(tracks)
    }

    fn enter(&mut self, step: Step, along: Option<[f64; 2]>) {
        let of = |amount| Passed {
            from_s: step.from_s,
            to_s: step.to_s,
            amount,
        };
        let [x, y] = step.way;
        self.ways
            .extend(along.map(|[cos, sin]| of(cos * x + sin * y)));
        self.turns.extend(step.turn.map(of));
    }
}
