//! Samples in, rows and a summary out.

use grouser_doctor::{Doctor, Uses, Window};
use grouser_files::robot::RobotFile;
use grouser_slip::filter::Learnt;
use grouser_slip::window::{WindowMeans, WindowSettings};
use grouser_slip::{Measurement, Reference, Robot, Sample, WheelRole};

use crate::choice::Inputs;
use crate::error::Result;
use crate::method::{Method, rotating_wheel};
use crate::moment::{Moment, Travel};
use crate::mounting::Mounting;
use crate::options::Options;
use crate::place_way::PlaceWay;
use crate::reckoning::Reckoning;
use crate::record::Record;
use crate::sink::Sink;
use crate::slips::Slips;
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
    slips: Slips,
    /// Their ways are those of the whole log.
    ways_means: Box<WindowMeans>,
    doctor: Doctor,
    record: Record,
    /// The time of the samples since a group was closed.
    group_ns: Option<i64>,
    /// The wheels that were read at that time, bit by bit.
    read: u64,
    moment: Moment,
    /// The wheels' speeds over the window, m/s.
    wheel_speeds: Vec<Option<f64>>,
}

/// The whole ways are counted over silences of the sensors up to this, s: counters, positions and displacements that come late
/// bring the way of the silence with them.
const WAYS_DROPOUT_S: f64 = 2.0;

impl Engine {
    /// An engine for a robot; [`Inputs`] says by what it is measured.
    ///
    /// # Errors
    /// [`Error::Settings`](crate::Error::Settings) for settings outside their limits.
    pub fn new(file: &RobotFile, inputs: Inputs, options: &Options) -> Result<Self> {
        let robot = file.robot.clone();
        let mut settings = file.settings;
        settings.reference = inputs.reference;
        settings.window = options.window_s.unwrap_or(settings.window);
        settings.position_sigma = inputs.position_sigma.unwrap_or(settings.position_sigma);
        let method = options.method_for(inputs.reference);
        // beside a free wheel the filter uses their displacements
        let goes_by_places = method == Method::Filter
            && inputs.reference == Reference::Displacement
            && (robot.wheels().iter()).all(|wheel| wheel.role == WheelRole::Powered);
        let by_places =
            goes_by_places.then(|| PlaceWay::new(&settings, file.filter.reference_latency));
        let of_ways = WindowSettings {
            dropout: settings.dropout.max(WAYS_DROPOUT_S),
            ..settings
        };
        let reckoning = Reckoning::new(settings.window, by_places);
        Ok(Self {
            slips: Slips::new(file, (settings, &inputs), options, method)?,
            ways_means: Box::new(WindowMeans::new(&robot, of_ways)?),
            doctor: Doctor::new(file, &settings, inputs.wheel_sensor),
            record: Record::new(file, inputs, (settings, options), reckoning),
            mounting: Mounting::new(file.corrections),
            steering: (file.steering.as_ref()).map(|of| WheelSteering::new(of, &robot)),
            suspension: Suspension::new(file),
            group_ns: None,
            read: 0,
            moment: Moment::default(),
            wheel_speeds: Vec::new(),
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
        self.mounting.correct(&mut sample.measurement);
        if let Measurement::Acceleration { left, .. } = &mut sample.measurement
            && self.inputs.is_acceleration_forward_only
        {
            *left = self.slips.turn_acceleration();
        }
        self.slips.learn(&sample.measurement);
        let carried = (self.suspension.as_mut()).map_or_else(Vec::new, |of| of.take(&mut sample));
        if self.inputs.wheel_sensor.uses(&sample.measurement) {
            self.doctor.take(&sample);
            self.record.take(&sample);
            let steered = self.steering.iter().flat_map(|of| of.angles(&sample));
            let steered = steered.inspect(|angle| self.doctor.take_steering(angle));
            let own = (!Suspension::is_raw(&sample.measurement)).then_some(sample);
            for sample in carried.into_iter().chain(steered).chain(own) {
                let _refused = self.ways_means.update(sample);
                self.slips.update(sample);
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

    /// What the filter has learnt of sensors and soil, for the next start; `None` of means over windows.
    #[must_use]
    pub fn learnt(&self) -> Option<Learnt> {
        self.slips.learnt()
    }

    /// Takes back what was learnt before a restart; means over windows learn nothing.
    ///
    /// # Errors
    /// [`Error::Settings`](crate::Error::Settings) for a number outside its limits; nothing changes then.
    pub fn restore(&mut self, learnt: &Learnt) -> Result<()> {
        self.slips.restore(learnt)
    }

    /// Ends the run: the last rows go to `sink`.
    ///
    /// # Errors
    /// As [`Engine::push`].
    pub fn finish(mut self, sink: &mut impl Sink) -> Result<Summary> {
        self.close_group(sink)?;
        for mut moment in self.slips.finish() {
            self.deliver(&mut moment, sink)?;
        }
        let estimated = self.slips.estimated(self.record.way_check());
        let findings = self.doctor.findings(Uses {
            reference: self.inputs.reference,
            has_heading: !self.record.has_ways_by_places(),
            has_acceleration: estimated.method == Method::Filter,
        });
        Ok(self.record.summary(estimated, findings))
    }

    /// All samples of one time have come.
    fn close_group(&mut self, sink: &mut impl Sink) -> Result<()> {
        let Some(now_ns) = self.group_ns.take() else {
            return Ok(());
        };
        let read = std::mem::take(&mut self.read);
        let Some(mut body) = self.slips.body() else {
            return Ok(());
        };
        if self.record.is_by_places() {
            body.along = self.slips.common_slip();
        }
        let (time_s, is_wanted) = self.record.when(now_ns);
        if is_wanted {
            let all = 0..self.robot.wheels().len();
            self.wheel_speeds.clear();
            (self.wheel_speeds).extend(all.map(|wheel| self.slips.rim_speed(wheel)));
            self.doctor.step(&Window {
                now_ns,
                time_s,
                body: &body,
                wheel_speeds: &self.wheel_speeds,
            });
        }
        let of_ways = self.ways_means.latest();
        let travel = of_ways.map_or((0.0, 0.0), |of| (of.travel_wheels, of.travel_reference));
        self.record.count(now_ns, &body, &self.wheel_speeds, travel);
        let mut moment = std::mem::take(&mut self.moment);
        let entered = (self.slips).enter((now_ns, read), &body, (&mut moment, &self.robot));
        if let Some(left_out) = entered {
            self.ways_means.leave_out(left_out);
            moment.travel = self.ways_means.latest().and_then(Travel::of);
        }
        for change in self.slips.new_events() {
            sink.event(change)?;
        }
        if let Some(smoother) = self.slips.smoother() {
            for mut done in smoother.push(moment, entered.unwrap_or(0)) {
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
        let soil = (moment.read != 0).then(|| self.slips.soil()).flatten();
        let known = (self.slips.is_reference_unused(), soil);
        self.record.deliver(moment, known, sink)
    }
}
