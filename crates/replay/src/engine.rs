//! Samples in, rows and a summary out.

use grouser_doctor::{Doctor, ReferenceDelay, Uses, Window};
use grouser_files::robot::{Corrections, RobotFile};
use grouser_slip::filter::Learnt;
use grouser_slip::onboard::SoilEstimate;
use grouser_slip::window::{WindowBody, WindowEstimator, WindowMeans, WindowSettings};
use grouser_slip::{
    Health, Invalid, Measurement, Motion, Reference, Robot, Sample, Slip, WheelRole,
};

use crate::choice::Inputs;
use crate::error::{Error, Result};
use crate::fusion::Fusion;
use crate::ground_watch::GroundWatch;
use crate::method::Method;
use crate::moment::{Moment, Travel, side_slip_angle};
use crate::odometry::Odometry;
use crate::options::Options;
use crate::place_way::PlaceWay;
use crate::reckoning::{Reckoning, inconsistent};
use crate::samples::rotating_wheel;
use crate::sink::{Row, Sink, Step};
use crate::smooth::latency_ns;
use crate::steering::WheelSteering;
use crate::summary::{Status, Summary};
use crate::tally::Tally;
use crate::ways::Ways;

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
    settings: WindowSettings,
    slips: Slips,
    /// Their ways are those of the whole log.
    ways_means: Box<WindowMeans>,
    span: (f64, f64),
    start_ns: Option<i64>,
    longest_gap_s: f64,
    /// The time of the samples that came last.
    group_ns: Option<i64>,
    /// Have samples come since a group was closed?
    is_open: bool,
    /// The wheels that were read at that time, bit by bit.
    read: u64,
    tallies: Vec<Tally>,
    ways: Ways,
    doctor: Doctor,
    ground: GroundWatch,
    corrections: Corrections,
    steering: Option<WheelSteering>,
    reckoning: Reckoning,
    odometry: Option<Odometry>,
    clock_offset_s: Option<f64>,
    reference_delay: Option<ReferenceDelay>,
    moment: Moment,
    /// The wheels' rim speeds over the window, m/s.
    rims: Vec<Option<f64>>,
    /// Cosine and sine of each wheel's heading.
    headings: Vec<(f64, f64)>,
}

/// The whole ways are counted over silences of the sensors up to this, s: counters, positions and displacements that come late
/// bring the way of the silence with them.
const WAYS_DROPOUT_S: f64 = 2.0;

/// What finds the slips. Beside the filter, ways and turns are counted over windows.
enum Slips {
    Filter(Box<Fusion>, Box<WindowMeans>),
    Window(Box<WindowEstimator>),
}

impl Slips {
    /// Was nothing of an absolute reference used so far?
    fn is_reference_unused(&self) -> bool {
        match self {
            Self::Filter(fusion, _) => fusion.is_reference_unused(),
            Self::Window(_) => false,
        }
    }

    /// What is learnt of the soil so far.
    fn soil(&self) -> Option<SoilEstimate> {
        match self {
            Self::Filter(fusion, _) => fusion.soil(),
            Self::Window(_) => None,
        }
    }

    fn update(&mut self, sample: Sample) {
        // A refused sample is counted; its wheel still gets its row.
        match self {
            Self::Filter(fusion, means) => {
                let _refused = means.update(sample);
                fusion.update(sample);
            }
            Self::Window(estimator) => {
                let _refused = estimator.update(sample);
            }
        }
    }

    /// Ways and means over windows; `None` before the first sample.
    fn body(&self) -> Option<WindowBody> {
        match self {
            Self::Filter(_, means) => means.latest().copied(),
            Self::Window(estimator) => Some(estimator.latest()?.body),
        }
    }

    /// The acceleration to the left by which a robot without sideways motion turns, m/s².
    fn turn_acceleration(&self) -> f64 {
        match self {
            Self::Filter(fusion, _) => fusion.turn_acceleration(),
            Self::Window(_) => 0.0,
        }
    }

    /// The common slip of the powered wheels by the filter.
    fn common_slip(&self) -> Option<Slip> {
        match self {
            Self::Filter(fusion, _) => fusion.common_slip(),
            Self::Window(_) => None,
        }
    }

    /// The mean rim speed of a wheel over the window, m/s.
    fn rim_speed(&self, wheel: usize) -> Option<f64> {
        let speed = match self {
            Self::Filter(_, means) => means.rim_speed(wheel),
            Self::Window(estimator) => estimator.latest()?.wheels.get(wheel)?.rim_speed,
        };
        Some(speed?.value)
    }
}

impl Engine {
    /// An engine for a robot; [`Inputs`] says by what it is measured.
    ///
    /// # Errors
    /// [`Error::Settings`] for settings outside their limits; [`Error::NothingToSmooth`] for smoothing without the filter.
    pub fn new(file: &RobotFile, inputs: Inputs, options: &Options) -> Result<Self> {
        let robot = file.robot.clone();
        let mut settings = file.settings;
        settings.reference = inputs.reference;
        settings.window = options.window_s.unwrap_or(settings.window);
        settings.position_sigma = inputs.position_sigma.unwrap_or(settings.position_sigma);
        let method = options.method_for(&robot, inputs.reference);
        let slips = match method {
            Method::Filter => Slips::Filter(
                Box::new(Fusion::new(file, &settings, options)?),
                Box::new(WindowMeans::new(&robot, settings)?),
            ),
            Method::Window if options.learn_soil.is_some() => {
                return Err(Error::NothingToLearnFrom);
            }
            Method::Window if options.smooth => return Err(Error::NothingToSmooth),
            Method::Window => Slips::Window(Box::new(WindowEstimator::new(&robot, settings)?)),
        };
        // beside a free wheel the filter uses their displacements
        let goes_by_places = method == Method::Filter
            && inputs.reference == Reference::Displacement
            && (robot.wheels().iter()).all(|wheel| wheel.role == WheelRole::Powered);
        let of_ways = WindowSettings {
            dropout: settings.dropout.max(WAYS_DROPOUT_S),
            ..settings
        };
        let steering =
            (file.steering.as_ref()).map(|steering| WheelSteering::new(steering, &file.robot));
        Ok(Self {
            ways_means: Box::new(WindowMeans::new(&robot, of_ways)?),
            slips,
            doctor: Doctor::new(file, &settings),
            ground: GroundWatch::new(&robot, settings.low_speed),
            corrections: file.corrections,
            steering,
            reckoning: Reckoning::new(
                settings.window,
                goes_by_places.then(|| PlaceWay::new(&settings, latency_ns(&file.filter))),
            ),
            odometry: None,
            span: (
                options.from_s.unwrap_or(f64::NEG_INFINITY),
                options.to_s.unwrap_or(f64::INFINITY),
            ),
            start_ns: None,
            longest_gap_s: 0.0,
            group_ns: None,
            is_open: false,
            read: 0,
            tallies: vec![Tally::new(); robot.wheels().len()],
            ways: Ways::new(settings.low_speed, settings.window),
            clock_offset_s: None,
            reference_delay: None,
            moment: Moment::default(),
            rims: Vec::new(),
            headings: robot
                .wheels()
                .iter()
                .map(|wheel| (wheel.heading.cos(), wheel.heading.sin()))
                .collect(),
            robot,
            inputs,
            settings,
        })
    }

    /// How the clocks of the sensors differ, for the summary: how much later the gyro's clock stamps the same moment than the
    /// encoders', s, and the delay of the reference.
    pub(crate) const fn set_clocks(
        &mut self,
        gyro_offset_s: Option<f64>,
        reference_delay: Option<ReferenceDelay>,
    ) {
        self.clock_offset_s = gyro_offset_s;
        self.reference_delay = reference_delay;
    }

    /// Takes a sample, not earlier than those before; its wheel is an index in the robot's order. Rows of the time
    /// before go to `sink`.
    ///
    /// # Errors
    /// [`Error::Sink`], and [`Error::Settings`] where smoothing cannot go on.
    pub fn push(&mut self, mut sample: Sample, sink: &mut impl Sink) -> Result<()> {
        if self.group_ns.is_some_and(|group| group != sample.time_ns) {
            self.close_group(sink)?;
        }
        if let Some(last) = self.group_ns.replace(sample.time_ns) {
            let gap_s = sample.time_ns.saturating_sub(last) as f64 * 1e-9;
            self.longest_gap_s = self.longest_gap_s.max(gap_s);
        }
        self.is_open = true;
        self.start_ns.get_or_insert(sample.time_ns);
        match &mut sample.measurement {
            Measurement::Pose { yaw, .. } => *yaw -= self.corrections.pose_yaw_offset,
            Measurement::YawRate { rate } => *rate *= self.corrections.yaw_rate_scale,
            Measurement::Acceleration { left, .. } if self.inputs.is_acceleration_forward_only => {
                *left = self.slips.turn_acceleration();
            }
            _ => {}
        }
        if self.inputs.wheel_sensor.uses(&sample.measurement) {
            self.doctor.take(&sample);
            self.ground.take(&sample);
            if let Measurement::Position { x, y } = sample.measurement {
                self.reckoning.take_place(sample.time_ns, [x, y]);
            }
            if let Some(steering) = &self.steering {
                for steered in steering.angles(&sample) {
                    let _refused = self.ways_means.update(steered);
                    self.slips.update(steered);
                }
            }
            let _refused = self.ways_means.update(sample);
            self.slips.update(sample);
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

    /// What the filter has learnt of sensors, soil and wheels, for the next start; `None` of means over windows.
    #[must_use]
    pub fn learnt(&self) -> Option<Learnt> {
        match &self.slips {
            Slips::Filter(fusion, _) => Some(fusion.learnt()),
            Slips::Window(_) => None,
        }
    }

    /// Takes back what was learnt before a restart; means over windows learn nothing.
    ///
    /// # Errors
    /// [`Error::Settings`] for a number outside its limits; nothing changes then.
    pub fn restore(&mut self, learnt: &Learnt) -> Result<()> {
        match &mut self.slips {
            Slips::Filter(fusion, _) => Ok(fusion.restore(learnt)?),
            Slips::Window(_) => Ok(()),
        }
    }

    /// Ends the run: the last rows go to `sink`.
    ///
    /// # Errors
    /// As [`Engine::push`].
    pub fn finish(mut self, sink: &mut impl Sink) -> Result<Summary> {
        self.close_group(sink)?;
        if let Slips::Filter(fusion, _) = &mut self.slips {
            for mut moment in fusion.finish()? {
                self.deliver(&mut moment, sink)?;
            }
        }
        Ok(self.summary())
    }

    /// Seconds from the log's start, and whether they lie in the span.
    fn when(&self, time_ns: i64) -> (f64, bool) {
        let start_ns = self.start_ns.unwrap_or(time_ns);
        let time_s = time_ns.saturating_sub(start_ns) as f64 * 1e-9;
        (time_s, time_s >= self.span.0 && time_s <= self.span.1)
    }

    /// All samples of one time have come.
    fn close_group(&mut self, sink: &mut impl Sink) -> Result<()> {
        let Some(now) = self.group_ns.filter(|_| self.is_open) else {
            return Ok(());
        };
        self.is_open = false;
        let read = std::mem::take(&mut self.read);
        let Some(mut body) = self.slips.body() else {
            return Ok(());
        };
        if self.reckoning.is_by_places() {
            body.along = self.slips.common_slip();
        }
        let of_ways = self.ways_means.latest();
        let travel = of_ways.map_or((0.0, 0.0), |body| {
            (body.travel_wheels, body.travel_reference)
        });
        let (time_s, is_wanted) = self.when(now);
        if is_wanted {
            let all = 0..self.robot.wheels().len();
            self.rims.clear();
            (self.rims).extend(all.map(|wheel| self.slips.rim_speed(wheel)));
            let rims = &self.rims;
            self.doctor.step(&Window {
                now_ns: now,
                time_s,
                body: &body,
                wheel_speeds: rims,
            });
            let wheels = self.robot.wheels().iter().enumerate();
            let powered = wheels.filter(|(_, wheel)| wheel.role == WheelRole::Powered);
            let rims = powered.filter_map(|(index, _)| rims[index]);
            let count = rims.clone().count();
            if count > 0 {
                let size: f64 = rims.clone().map(f64::abs).sum();
                self.ground.step(now, time_s, size / count as f64);
            }
            self.ways.count(&body, rims);
            self.ways.travel(travel);
        } else if time_s < self.span.0 {
            self.ways.wait(travel);
        }
        let mut moment = std::mem::take(&mut self.moment);
        match &mut self.slips {
            Slips::Filter(fusion, means) => {
                fusion.close((now, read), &body, &mut moment);
                let left_out = inconsistent(&moment.wheels, &self.robot);
                means.leave_out(left_out);
                self.ways_means.leave_out(left_out);
                moment.travel = self.ways_means.latest().and_then(Travel::of);
                for change in fusion.new_events() {
                    sink.event(change)?;
                }
                if let Some(smoother) = fusion.smoother() {
                    for mut done in smoother.push(moment)? {
                        self.deliver(&mut done, sink)?;
                    }
                    return Ok(());
                }
            }
            Slips::Window(estimator) => {
                let wheels = estimator.latest().map_or(&[][..], |output| output.wheels);
                moment.enter_window((now, read), wheels, &body);
            }
        }
        self.deliver(&mut moment, sink)?;
        self.moment = moment;
        Ok(())
    }

    /// Counts a moment and hands it to the sink.
    fn deliver(&mut self, moment: &mut Moment, sink: &mut impl Sink) -> Result<()> {
        let now = moment.time_ns;
        let (time_s, is_wanted) = self.when(now);
        let robot = self.robot.wheels();
        let is_unused = self.slips.is_reference_unused();
        for (wheel, described) in moment.wheels.iter_mut().zip(robot) {
            if is_unused && wheel.slip.is_some() {
                (wheel.slip, wheel.sigma) = (None, None);
                wheel.health = Health::Invalid(Invalid::NoReference);
            }
            let factor = self.corrections.interval_factor;
            wheel.sigma = wheel.sigma.map(|sigma| factor * sigma);
            // against itself a reference does not slip
            if described.role == WheelRole::Free && self.inputs.reference == Reference::FreeWheel {
                (wheel.slip, wheel.sigma) = (None, None);
                if wheel.motion == Some(Motion::Braking) {
                    wheel.motion = Some(Motion::Driving);
                }
            }
        }
        let motion = moment.motion.as_ref().filter(|_| !is_unused);
        let low_speed = self.settings.low_speed;
        for (index, tally) in self.tallies.iter_mut().enumerate() {
            if moment.read >> index & 1 == 0 {
                continue;
            }
            let since = tally.read(now);
            if !is_wanted {
                continue;
            }
            let wheel = &moment.wheels[index];
            let row = Row {
                time_s,
                wheel: index,
                name: &robot[index].name,
                slip: wheel.slip.map(Slip::value),
                slip_sigma: wheel.sigma,
                motion: wheel.motion,
                health: wheel.health,
                side_slip_angle: side_slip_angle(
                    &robot[index],
                    self.headings[index],
                    motion,
                    low_speed,
                ),
            };
            // A gap in the log is no time in a state.
            tally.add(&row, since.min(self.settings.window));
            sink.row(&row)?;
        }
        if moment.read != 0 && is_wanted {
            let odometry = self.reckoning.step(moment);
            self.odometry = odometry.or(self.odometry);
            sink.step(&Step {
                time_ns: now,
                time_s,
                wheels: &moment.wheels,
                odometry,
                soil: self.slips.soil(),
            })?;
        }
        Ok(())
    }

    fn summary(self) -> Summary {
        let reference = self.inputs.reference;
        let by_places = self.reckoning.ways_by_places();
        let (method, fused, rejected, soil) = match &self.slips {
            Slips::Filter(fusion, _) => {
                let summary = fusion.summary(self.reckoning.ways());
                let rejected = summary.rejected;
                (Method::Filter, Some(summary), rejected, fusion.soil())
            }
            Slips::Window(estimator) => (Method::Window, None, estimator.rejected(), None),
        };
        let wheels = self.robot.wheels().iter().zip(&self.tallies);
        // Where nothing of an absolute reference was used, there is no way.
        let is_unused = self.slips.is_reference_unused();
        Summary {
            status: if self.tallies.iter().any(Tally::has_slip) {
                Status::Done
            } else {
                Status::NoSlip
            },
            method,
            window_s: self.settings.window,
            reference,
            wheel_sensor: self.inputs.wheel_sensor.name(),
            duration_s: match (self.start_ns, self.group_ns) {
                (Some(start), Some(end)) => end.saturating_sub(start) as f64 * 1e-9,
                _ => 0.0,
            },
            longest_gap_s: self.longest_gap_s,
            wheels: wheels
                .map(|(wheel, tally)| {
                    let is_free = wheel.role == WheelRole::Free;
                    tally.summary(wheel, is_free && reference == Reference::FreeWheel)
                })
                .collect(),
            along: (self.ways).along(
                reference != Reference::Grip && !is_unused,
                by_places.as_ref(),
            ),
            yaw: self.ways.yaw(),
            findings: self.doctor.findings(Uses {
                reference,
                has_heading: by_places.is_none(),
                has_acceleration: method == Method::Filter,
            }),
            ground_changes_s: self.ground.called_s().to_vec(),
            clock_offset_s: self.clock_offset_s,
            reference_delay: self.reference_delay,
            held_reference: None,
            odometry: self.odometry.filter(|_| !is_unused),
            fused,
            soil,
            rejected,
        }
    }
}
