//! Samples in, rows and a summary out.

use grouser_doctor::{Doctor, KnownStep, Uses};
use grouser_files::robot::RobotFile;
use grouser_slip::filter::Learnt;
use grouser_slip::modes::ModeFilter;
use grouser_slip::motion::Step;
use grouser_slip::{Health, Invalid, Measurement, Robot, Sample, WheelEstimate, WheelRole};

use crate::choice::Inputs;
use crate::error::Result;
use crate::filter_input::rotating_wheel;
use crate::fusion::Fusion;
use crate::moment::Moment;
use crate::mounting::Mounting;
use crate::offline::Offline;
use crate::options::Options;
use crate::record::Record;
use crate::sink::Sink;
use crate::steering::WheelSteering;
use crate::summary::Summary;
use crate::suspension::Suspension;

/// Runs samples in the order of time through the estimator.
///
/// [`run`](crate::run()) is a loop around it; a live source pushes its samples as they come.
///
/// ```
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_replay::{Engine, Inputs, Options, Row, Sink};
///
/// struct Rows(usize);
///
/// impl Sink for Rows {
///     fn row(&mut self, _row: &Row<'_>) -> std::io::Result<()> {
///         self.0 += 1;
///         Ok(())
///     }
/// }
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?; // its wheels are in the robot's order
/// let options = Options::default();
/// let mut engine = Engine::new(&robot, Inputs::of(&log, &robot, &options)?, &options)?;
/// let mut rows = Rows(0);
/// for sample in log.samples(&[])? {
///     engine.push(sample?, &mut rows)?;
/// }
/// let summary = engine.finish(&mut rows)?;
/// assert_eq!(rows.0, 5 * 2001);
/// assert!(summary.wheels[0].slip.p95.unwrap() > 0.33);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Engine {
    robot: Robot,
    inputs: Inputs,
    mounting: Mounting,
    steering: Option<WheelSteering>,
    suspension: Option<Suspension>,
    fusion: Box<Fusion>,
    doctor: Doctor,
    smoother: Option<Box<Offline>>,
    /// The wheels that contradict the others, bit by bit.
    left_out: u64,
    travel_variance: Option<f64>,
    record: Record,
    /// The time of the samples since a group was closed.
    group_ns: Option<i64>,
    /// The wheels that were read at that time, bit by bit.
    read: u64,
    moment: Moment,
}

impl Engine {
    /// An engine for a robot; [`Inputs`] says by what it is measured.
    ///
    /// # Errors
    /// [`Error::Settings`](crate::Error::Settings) for settings outside their limits.
    pub fn new(file: &RobotFile, inputs: Inputs, options: &Options) -> Result<Self> {
        let robot = file.robot.clone();
        let mut settings = file.settings;
        settings.reference = inputs.reference;
        settings.position_sigma = inputs.position_sigma.unwrap_or(settings.position_sigma);
        Ok(Self {
            fusion: Box::new(Fusion::new(file, &settings, &inputs, options)?),
            doctor: Doctor::new(file, &settings, inputs.wheel_sensor),
            smoother: (options.offline).then(|| Box::new(Offline::new(file, &inputs, options))),
            left_out: 0,
            travel_variance: None,
            record: Record::new(file, inputs, &settings, options),
            mounting: Mounting::new(&file.corrections, &inputs),
            steering: (file.steering.as_ref()).map(|of| WheelSteering::new(of, &robot)),
            suspension: Suspension::new(file),
            group_ns: None,
            read: 0,
            moment: Moment::default(),
            robot,
            inputs,
        })
    }

    /// Takes a sample, not earlier than those before; its wheel is an index in the robot's order. Rows of the time
    /// before go to `sink`.
    ///
    /// # Errors
    /// [`Error::Sink`](crate::Error::Sink).
    pub fn push(&mut self, mut sample: Sample, sink: &mut impl Sink) -> Result<()> {
        if self.group_ns.is_some_and(|group| group != sample.time_ns) {
            self.close_group(sink)?;
        }
        self.group_ns = Some(sample.time_ns);
        self.record.reach(sample.time_ns);
        if let Some(smoother) = &mut self.smoother {
            smoother.begin(sample.time_ns);
        }
        self.mounting.correct(&mut sample);
        if let Some(tilt) = self.suspension.as_ref().and_then(Suspension::tilt) {
            self.mounting.level(&mut sample, &tilt);
        }
        if let Measurement::Acceleration { left, .. } = &mut sample.measurement
            && self.inputs.is_acceleration_forward_only
        {
            *left = self.fusion.turn_acceleration();
        }
        self.fusion.learn(&sample.measurement);
        let carried = (self.suspension.as_mut()).map_or_else(Vec::new, |of| of.take(&mut sample));
        if self.inputs.wheel_sensor.uses(&sample.measurement) {
            self.doctor.take(&sample);
            self.record.take(&sample);
            let steered = self.steering.iter().flat_map(|of| of.angles(&sample));
            let steered = steered.inspect(|angle| self.doctor.take_steering(angle));
            let own =
                (!Suspension::is_raw(&sample.measurement)).then(|| self.mounting.with_turn(sample));
            for sample in carried.into_iter().chain(steered).chain(own) {
                self.fusion.update(sample);
            }
            if let Some(wheel) = rotating_wheel(&sample.measurement) {
                self.read |= 1 << wheel;
            }
        }
        Ok(())
    }

    /// All samples of the present time have come: their rows go to `sink` at once, not with the next time's first
    /// sample. A sample of the same time that comes after it begins a group of its own.
    ///
    /// # Errors
    /// As [`Engine::push`].
    pub fn flush(&mut self, sink: &mut impl Sink) -> Result<()> {
        self.close_group(sink)
    }

    /// What the filter has learnt of sensors and soil, for the next start.
    #[must_use]
    pub fn learnt(&self) -> Learnt {
        self.fusion.learnt()
    }

    /// Takes back what was learnt before a restart.
    ///
    /// # Errors
    /// [`Error::Settings`](crate::Error::Settings) for a number outside its limits; nothing changes then.
    pub fn restore(&mut self, learnt: &Learnt) -> Result<()> {
        Ok(self.fusion.restore(learnt)?)
    }

    /// Ends the run: the last rows go to `sink`.
    ///
    /// # Errors
    /// As [`Engine::push`].
    pub fn finish(mut self, sink: &mut impl Sink) -> Result<Summary> {
        self.close_group(sink)?;
        let (fusion, mut steps) = self.steps();
        fusion.finish(&mut |end_ns, step, filter| steps.take(end_ns, step, filter));
        if let Some(mut smoother) = self.smoother.take() {
            for mut moment in smoother.finish(&mut self.record) {
                self.deliver(&mut moment, sink)?;
            }
            self.travel_variance = Some(smoother.travel_variance());
        }
        let fused = self.fusion.summary(self.record.way_check());
        let findings = self.doctor.findings(Uses {
            reference: self.inputs.reference,
            has_heading: self.record.has_heading(),
            has_acceleration: true,
        });
        let soil = self.fusion.soil();
        Ok((self.record).summary(fused, soil, findings, self.travel_variance))
    }

    /// The filter, and what takes its steps.
    fn steps(&mut self) -> (&mut Fusion, Steps<'_>) {
        let steps = Steps {
            doctor: &mut self.doctor,
            record: &mut self.record,
            smoother: self.smoother.as_deref_mut(),
            left_out: self.left_out,
        };
        (&mut self.fusion, steps)
    }

    /// All samples of one time have come.
    fn close_group(&mut self, sink: &mut impl Sink) -> Result<()> {
        let Some(now_ns) = self.group_ns.take() else {
            return Ok(());
        };
        let read = std::mem::take(&mut self.read);
        let (fusion, mut steps) = self.steps();
        fusion.advance(&mut |end_ns, step, filter| steps.take(end_ns, step, filter));
        let mut moment = std::mem::take(&mut self.moment);
        let travel = self.record.travel();
        self.fusion.enter((now_ns, read), travel, &mut moment);
        self.left_out = inconsistent(&moment.wheels, &self.robot);
        for change in self.fusion.new_events() {
            sink.event(change)?;
        }
        if let Some(smoother) = &mut self.smoother {
            for mut done in smoother.push(moment, &mut self.record) {
                self.deliver(&mut done, sink)?;
            }
            return Ok(());
        }
        self.deliver(&mut moment, sink)?;
        self.moment = moment;
        Ok(())
    }

    /// Counts a moment and hands it to the sink.
    fn deliver(&mut self, moment: &mut Moment, sink: &mut impl Sink) -> Result<()> {
        let soil = (moment.read != 0).then(|| self.fusion.soil()).flatten();
        let known = (self.fusion.is_reference_unused(), soil);
        self.record.deliver(moment, known, sink)
    }
}

/// What takes the steps of the filter.
struct Steps<'a> {
    doctor: &'a mut Doctor,
    record: &'a mut Record,
    smoother: Option<&'a mut Offline>,
    left_out: u64,
}

impl Steps<'_> {
    fn take(&mut self, end_ns: i64, step: &Step, filter: &ModeFilter) {
        let known = KnownStep::online(step, filter);
        let (time_s, is_wanted) = self.record.when(end_ns);
        if is_wanted {
            self.doctor.step((end_ns, time_s), &known, self.left_out);
        }
        self.record.judge_ground(end_ns, &known);
        match &mut self.smoother {
            Some(smoother) => smoother.take(end_ns, step, self.left_out),
            None => self.record.count(end_ns, &known),
        }
    }
}

/// The powered wheels whose sensors contradict the others, bit by bit; none where all of them do: such a robot is carried.
fn inconsistent(wheels: &[WheelEstimate], robot: &Robot) -> u64 {
    let (mut found, mut bit, mut has_other) = (0, 1, false);
    for (wheel, described) in wheels.iter().zip(robot.wheels()) {
        if described.role == WheelRole::Powered {
            if wheel.health == Health::Invalid(Invalid::Inconsistent) {
                found |= bit;
            } else {
                has_other = true;
            }
        }
        bit <<= 1;
    }
    if has_other { found } else { 0 }
}
