//! Ways and turns of a log as they are stamped: by the wheels, by the gyro, and by the reference.

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_slip::{Measurement, Reference, Sample};

use super::rims::Rims;
use super::steps::{Step, Steps};
use super::track::Track;

/// Nothing is known between two readings of a gyro that are further apart, s: whether a rate is of the moment of its stamp or
/// the mean since the one before, half of the time between them, is not known.
const MAX_GYRO_GAP_S: f64 = 0.15;
/// Length of a log that is used, s.
const MAX_LOG_S: f64 = 1800.0;
/// Readings that are kept: [`MAX_LOG_S`] at intervals of 9 ms.
const MAX_READINGS: usize = 200_000;

/// What the reference measured between two stamps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passed {
    pub(crate) from_s: f64,
    pub(crate) to_s: f64,
    /// m or rad.
    pub(crate) amount: f64,
}

impl Passed {
    pub(super) const fn begins(time_s: f64) -> Self {
        Self {
            from_s: time_s,
            to_s: time_s,
            amount: 0.0,
        }
    }
}

/// How far wheels, gyro and reference moved over a log, for [`ReferenceDelay::find`](super::ReferenceDelay::find).
#[derive(Clone, Debug)]
pub struct Tracks {
    sensor: WheelSensor,
    /// The powered wheels along the robot, m.
    pub(crate) rims: Rims,
    /// Turn by the gyro, rad.
    pub(crate) gyro: Track,
    steps: Steps,
    start_ns: Option<i64>,
    last_rate: Option<(f64, f64)>,
    /// What the reference measured; where there is none, turns by the wheels.
    pub(crate) ways: Vec<Passed>,
    pub(crate) turns: Vec<Passed>,
    has_reference: bool,
}

impl Tracks {
    /// For a log whose motion is measured by `reference` and whose wheels by `sensor`.
    #[must_use]
    pub fn new(file: &RobotFile, reference: Reference, sensor: WheelSensor) -> Self {
        Self {
            sensor,
            rims: Rims::new(file),
            gyro: Track::default(),
            steps: Steps::new(reference),
            start_ns: None,
            last_rate: None,
            ways: Vec::new(),
            turns: Vec::new(),
            has_reference: !matches!(reference, Reference::FreeWheel | Reference::Grip),
        }
    }

    /// The same with memory reserved for everything that it keeps: nothing is allocated later.
    #[must_use]
    pub(crate) fn with_room(mut self) -> Self {
        self.rims.track.reserve(MAX_READINGS);
        self.gyro.reserve(MAX_READINGS);
        self.ways.reserve(MAX_READINGS);
        self.turns.reserve(MAX_READINGS);
        self
    }

    /// Takes a sample that is a reading of the robot's origin, corrected as the robot file states it, not earlier than those before; is the log long enough now?
    pub fn take(&mut self, sample: &Sample) -> bool {
        let start = *self.start_ns.get_or_insert(sample.time_ns);
        let time_s = sample.time_ns.saturating_sub(start) as f64 * 1e-9;
        if time_s > MAX_LOG_S || !self.sensor.uses(&sample.measurement) {
            return time_s > MAX_LOG_S;
        }
        if let Measurement::YawRate { rate } = sample.measurement {
            let last = self.last_rate.replace((time_s, rate));
            match last.filter(|(last_s, _)| time_s - last_s <= MAX_GYRO_GAP_S) {
                Some((last_s, last)) => {
                    let turn = 0.5 * (last + rate) * (time_s - last_s);
                    self.gyro.add(time_s, turn);
                }
                None => self.gyro.interrupt(time_s),
            }
        }
        let turned = self.rims.take(time_s, sample);
        self.turns.extend(turned.filter(|_| !self.has_reference));
        if let Some(step) = self.steps.take(time_s, &sample.measurement) {
            self.enter(step, self.rims.along);
        }
        false
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
