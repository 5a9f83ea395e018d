//! A log through the slip filter.

use grouser_files::robot::RobotFile;
use grouser_slip::detect::{Change, DetectSettings, Detector};
use grouser_slip::filter::{FilterSettings, Learnt, Recorder, SlipFilter};
use grouser_slip::onboard::SoilEstimate;
use grouser_slip::{Degraded, Health, Measurement, Reference, Robot, Sample, SensorSettings};

use crate::checks::{Doubt, ReferenceUse, WayCheck, doubts};
use crate::choice::Inputs;
use crate::error::Result;
use crate::filter_input::reaches_filter;
use crate::moment::Moment;
use crate::options::Options;
use crate::soil_learning::SoilLearning;
use crate::summary::{EventAt, FusedSummary};

/// Maximum number of events that are kept: the first of the log.
const MAX_EVENTS: usize = 10_000;

/// The filter, what is counted of it, and what looks back.
#[derive(Debug)]
pub(crate) struct Fusion {
    robot: Robot,
    reference: Reference,
    waiting: Vec<Sample>,
    filter: SlipFilter,
    detector: Detector,
    torques: Vec<Option<f64>>,
    start_ns: Option<i64>,
    events: Vec<EventAt>,
    more_events: u64,
    /// Events of the time that was closed last.
    new_events: Vec<Change>,
    is_offline: bool,
    learning: Option<Box<SoilLearning>>,
}

impl Fusion {
    pub(crate) fn new(
        file: &RobotFile,
        settings: &SensorSettings,
        inputs: &Inputs,
        options: &Options,
    ) -> Result<Self> {
        let robot = &file.robot;
        let learning = (options.learn_soil.as_ref())
            .map(|soil| SoilLearning::new(file, soil).map(Box::new))
            .transpose()?;
        let own = FilterSettings {
            // a log is in order of time: there is nothing to wait for
            horizon: 0.0,
            position_sigma: inputs.position_sigma.unwrap_or(file.filter.position_sigma),
            ..file.filter
        };
        let detect = DetectSettings {
            standstill_speed: settings.standstill_speed,
            ..DetectSettings::default()
        };
        Ok(Self {
            waiting: Vec::new(),
            filter: SlipFilter::new(robot, own)?,
            detector: Detector::new(robot, detect)?,
            torques: vec![None; robot.wheels().len()],
            reference: settings.reference,
            robot: robot.clone(),
            start_ns: None,
            events: Vec::new(),
            more_events: 0,
            new_events: Vec::new(),
            is_offline: options.offline,
            learning,
        })
    }

    /// A measurement as the sensor shows it, for the learning of the soil: slopes act on its pull.
    pub(crate) fn learn(&mut self, raw: &Measurement) {
        if let Some(learning) = &mut self.learning {
            learning.take(raw);
        }
    }

    /// A sample of the time at hand: which of them stands first in the log must not matter.
    pub(crate) fn update(&mut self, sample: Sample) {
        if reaches_filter(&sample.measurement, self.reference, &self.robot) {
            self.waiting.push(sample);
        }
    }

    fn take(&mut self, sample: Sample, record: &mut Recorder<'_>) {
        if let Measurement::WheelTorque { wheel, torque } = sample.measurement
            && let Some(slot) = self.torques.get_mut(wheel)
        {
            *slot = Some(torque);
        }
        // a refused sample is counted
        let _ = self.filter.update_recorded(sample, record);
    }

    /// All samples of one time have been taken: `record` is shown the steps that are complete.
    pub(crate) fn advance(&mut self, record: &mut Recorder<'_>) {
        let mut samples = std::mem::take(&mut self.waiting);
        samples.sort_by_key(|sample| rank(&sample.measurement));
        for sample in samples.drain(..) {
            self.take(sample, record);
        }
        self.waiting = samples;
    }

    /// Enters what is known, with the distances so far by wheels and filter, into `moment`.
    pub(crate) fn enter(
        &mut self,
        (now_ns, read): (i64, u64),
        travel: [f64; 2],
        moment: &mut Moment,
    ) {
        let known = self.filter.latest();
        moment.enter((now_ns, read), known.wheels, &known.body, travel);
        let start_ns = *self.start_ns.get_or_insert(now_ns);
        self.new_events.clear();
        if read != 0 {
            let changes = self.detector.update(now_ns, known.wheels, &self.torques);
            for change in changes {
                self.new_events.push(change);
                if self.events.len() < MAX_EVENTS {
                    self.events.push(EventAt {
                        time_s: now_ns.saturating_sub(start_ns) as f64 * 1e-9,
                        change,
                    });
                } else {
                    self.more_events += 1;
                }
            }
        }
        for (index, wheel) in moment.wheels.iter_mut().enumerate() {
            if self.reference == Reference::Grip && wheel.health == Health::Ok {
                // the speed was known from a standstill, which is over
                wheel.health = Health::Degraded(Degraded::Relative);
            }
            wheel.motion = self.detector.motion(index, wheel.motion);
        }
        if let Some(learning) = &mut self.learning {
            learning.step(now_ns, &moment.wheels, (&known.body, &self.torques));
        }
    }

    /// What was learnt of the soil.
    pub(crate) fn soil(&self) -> Option<SoilEstimate> {
        self.learning.as_ref().map(|learning| learning.estimate())
    }

    /// Events of the time that was closed last.
    pub(crate) fn new_events(&self) -> &[Change] {
        &self.new_events
    }

    pub(crate) fn learnt(&self) -> Learnt {
        self.filter.learnt()
    }

    pub(crate) fn restore(&mut self, learnt: &Learnt) -> grouser_slip::Result<()> {
        self.filter.restore(learnt)
    }

    /// The log is over: `record` is shown the steps that waited for readings.
    pub(crate) fn finish(&mut self, record: &mut Recorder<'_>) {
        self.filter.finish_recorded(record);
    }

    /// The acceleration to the left of a robot that moves along its heading, v Ω, m/s².
    pub(crate) fn turn_acceleration(&self) -> f64 {
        let body = self.filter.latest().body;
        body.forward.value * body.yaw_rate.value
    }

    /// How much of the reference was used so far; `None` before its first reading.
    fn reference_use(&self) -> Option<ReferenceUse> {
        let known = self.filter.latest();
        let readings = known.reference_readings;
        (readings > 0).then(|| ReferenceUse {
            readings,
            used: readings.saturating_sub(known.reference_refused),
        })
    }

    /// Was nothing of an absolute reference used so far? Slips are then what was expected beforehand.
    pub(crate) fn is_reference_unused(&self) -> bool {
        let is_absolute = matches!(
            self.reference,
            Reference::Displacement | Reference::Pose | Reference::Speed
        );
        is_absolute && self.reference_use().is_none_or(|of| of.used == 0)
    }

    pub(crate) fn summary(&self, ways: WayCheck) -> FusedSummary {
        let known = self.filter.latest();
        let reference = self.reference_use();
        let unused = (self.is_reference_unused()).then_some(Doubt::ReferenceUnused);
        FusedSummary {
            reference,
            ways,
            doubts: unused.into_iter().chain(doubts(reference, &ways)).collect(),
            is_offline: self.is_offline,
            dropped: known.dropped,
            clock_steps: known.clock_steps,
            events: self.events.clone(),
            more_events: self.more_events,
            rejected: known.rejected,
        }
    }
}

/// What is taken first of one time: what moves the state on, then the wheels, then what is held against both.
const fn rank(measurement: &Measurement) -> (u8, usize) {
    match *measurement {
        Measurement::Acceleration { .. } => (1, 0),
        Measurement::YawRate { .. } => (2, 0),
        Measurement::WheelTorque { wheel, .. } => (3, wheel),
        Measurement::WheelCount { wheel, .. }
        | Measurement::WheelEdge { wheel, .. }
        | Measurement::WheelAngle { wheel, .. }
        | Measurement::WheelRate { wheel, .. } => (4, wheel),
        Measurement::Position { .. } => (5, 0),
        Measurement::Displacement { .. } | Measurement::Pose { .. } | Measurement::Speed { .. } => {
            (5, 1)
        }
        _ => (0, 0),
    }
}
