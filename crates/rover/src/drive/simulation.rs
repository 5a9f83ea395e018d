//! The loop: ground, robot, sensors, on-board computer, motors.

use grouser_real::Real;
use grouser_slip::control::{Action, Ending, Request, WheelCommand};
use grouser_slip::filter::SlipFilter;
use grouser_slip::onboard::{OnBoard, SoilLearnSettings, SoilLearner, SoilTables};
use grouser_slip::{Measurement, Sample};

use grouser_terra::{Accuracy, OutOfRange, Soil};

use super::frame::{Frame, WheelFrame};
use super::motor_driver::{GAIN_S_PER_RAD, MotorDriver};
use super::on_board::{filter_settings, on_board, soil_tables};
use super::outcome::{DriveResult, NamedDecision, Outcome};
use super::pilot::Pilot;
use super::referee::Referee;
use super::scenario::Scenario;
use super::score::{Scoring, TrueSlip};
use crate::dynamics::{STEP_LIMITS_S, Vehicle, fastest_rate};
use crate::error::{Error, Result};
use crate::ground::Ground;
use crate::sensors::{FaultKind, Sensors, to_ns};
use crate::statics::{PostureControl, wheel_loads};
use crate::vector::Vector;

/// Period of the control loop and of the frames, s: the rate of the shipped robots' sensors.
const CONTROL_PERIOD_S: f64 = 0.01;
/// Period of the posture control, s: within it an actuator turns a link by a degree or two, and a robot moves by a part of its
/// wheels' radius.
const POSTURE_PERIOD_S: f64 = 0.2;
/// The robot settles on the ground for this long before motion is requested, s: the wheels sink to rest within half of it,
/// and the on-board computer is warm.
const SETTLING_TIME_S: f64 = 1.0;
/// Decisions that are kept; they are counted beyond it.
const MAX_DECISIONS: usize = 1000;
/// The greatest slip is that of the load-weighted mean smoothed over this time, s.
const WORST_SLIP_TIME_S: f64 = 1.0;

/// The step is at most this long, s: up to here the errors of a drive are those of RESULTS.md.
const MAX_STEP_S: f64 = 2.5e-3;
/// The balance of energy is compared with at least the energy that lifts the robot by this, m.
const LEAST_LIFT_M: f64 = 0.01;
/// Where the scenario gives no step, it is this share of the time in which the robot's fastest part settles.
const STEP_RATE: f64 = 0.7;
/// The greatest share that a scenario may give. Stepping is stable up to 1, or 0.9 with the spring of the soil.
const MAX_STEP_RATE: f64 = 0.9;

/// A sensor of sinkage (m) or entry angle (rad) is never described as better than this: variances must not vanish.
const MIN_CONTACT_SIGMA: f64 = 1e-6;

/// A simulated drive under way.
///
/// ```
/// use grouser_rover::drive::{Pilot, Simulation, read_scenario};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios/sandbox.toml");
/// let scenario = read_scenario(file.as_ref())?;
/// let mut drive = Simulation::new(&scenario, Pilot::Controller, 0.3, scenario.seed)?;
/// let mut times = Vec::new();
/// for _ in 0..5 {
///     drive.period(&mut |frame| {
///         times.push(frame.time);
///         true
///     });
/// }
/// assert!(times.windows(2).all(|pair| pair[0] < pair[1]) && drive.vehicle().time() > 0.0);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Simulation {
    ground: Ground,
    vehicle: Vehicle,
    sensors: Sensors,
    on_board: OnBoard,
    /// Chooses the posture of a chassis with actuators, where the driver moves them.
    posture: Option<PostureControl>,
    /// The tip-over margin (rad) of a chassis with actuators, and the least so far.
    margins: Option<[f64; 2]>,
    posture_due: f64,
    /// The slip setpoint before soil is learnt.
    optimum: f64,
    drivers: Vec<MotorDriver>,
    commands: Vec<WheelCommand>,
    truths: Vec<TrueSlip>,
    scoring: Scoring,
    frames: Vec<WheelFrame>,
    samples: Vec<Sample>,
    arrived: Vec<Sample>,
    referee: Referee,
    decisions: Vec<NamedDecision>,
    decision_count: u64,
    loads: Vec<f64>,
    /// Longest duration, s.
    duration: f64,
    /// Power of the electronics, W.
    hotel: f64,
    energy_at_start: f64,
    /// Load-weighted slip over a second, and the greatest so far.
    mean_slip: f64,
    worst_slip: f64,
    /// Length of the way that was requested, m.
    requested_way: f64,
    /// For how many periods each wheel was loaded, and sunk too deep for the laws.
    deep: Vec<[u64; 2]>,
    steps_per_period: u32,
    ended: Option<Outcome>,
    /// What a navigator requests in place of the legs.
    navigated: Option<Request>,
}

impl Simulation {
    /// A drive of `scenario` by `pilot`, with everything random from `seed`; `optimum` is the slip setpoint.
    ///
    /// # Errors
    /// What is wrong with ground, robot or settings.
    pub fn new(scenario: &Scenario, pilot: Pilot, optimum: f64, seed: u64) -> Result<Self> {
        Self::with_tables(
            scenario,
            pilot,
            optimum,
            seed,
            &Self::soil_tables(scenario)?,
        )
    }

    /// What the robot's computer knows of the soil on which the scenario starts: the same for every seed and pilot.
    ///
    /// # Errors
    /// What is wrong with robot or soil.
    pub fn soil_tables(scenario: &Scenario) -> Result<SoilTables> {
        let loads = wheel_loads(&scenario.robot, 0.0, 0.0).loads;
        let soil = &scenario.ground.soils[0].soil;
        soil_tables(&scenario.robot, &loads, soil, scenario.learns_on_board())
    }

    /// [`Simulation::new`] with the [`Simulation::soil_tables`] of the same scenario, for many drives of it: the same bits.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn with_tables(
        scenario: &Scenario,
        pilot: Pilot,
        optimum: f64,
        seed: u64,
        tables: &SoilTables,
    ) -> Result<Self> {
        let ground = scenario.ground.build(seed)?;
        let steps_per_period = steps_per_period(scenario, ground.soils())?;
        let vehicle = Vehicle::new(
            scenario.robot.clone(),
            &ground,
            scenario.start,
            CONTROL_PERIOD_S / f64::from(steps_per_period),
        )?;
        let model = vehicle.model();
        let loads = wheel_loads(model, 0.0, 0.0).loads;
        let known = (loads.as_slice(), tables, scenario.start.2);
        let control = pilot.settings(scenario.control, optimum);
        let spec = scenario.learn.filter(|_| scenario.learns_on_board());
        let learn = spec.filter(|_| pilot != Pilot::OpenLoop).map(|spec| {
            let mut settings = SoilLearnSettings::default();
            settings.hysteresis = spec.hysteresis;
            // noise and lasting error, as the sensors' data sheets say
            let sensors = &scenario.sensors;
            let sigma = |noise: f64, bias: f64| Real::hypot(noise, bias).max(MIN_CONTACT_SIGMA);
            settings.sinkage_sigma = sigma(sensors.sinkage_sigma, sensors.sinkage_bias);
            settings.entry_angle_sigma = sigma(sensors.entry_angle_sigma, sensors.entry_angle_bias);
            settings
        });
        let on_board = on_board(model, known, &scenario.sensors, (&control, learn))?;
        let count = model.wheels.len();
        // the filter's speeds are means over its steps, as old as its horizon
        let filter = filter_settings(model, &scenario.sensors);
        let [window, lag] =
            [SlipFilter::STEP_S, filter.horizon].map(|time| periods(time, CONTROL_PERIOD_S));
        let (kinetic, potential) = vehicle.energy();
        Ok(Self {
            sensors: Sensors::new(&vehicle, scenario.sensors, scenario.faults.clone(), seed),
            ground,
            on_board,
            posture: (pilot == Pilot::Controller && !model.actuators.is_empty())
                .then(|| PostureControl::new(model)),
            margins: None,
            posture_due: SETTLING_TIME_S,
            optimum: control.optimum,
            drivers: vec![MotorDriver::default(); count],
            commands: vec![WheelCommand::default(); count],
            truths: vec![TrueSlip::new(window as usize, lag as usize); count],
            scoring: Scoring::new(count),
            frames: Vec::with_capacity(count),
            samples: Vec::new(),
            arrived: Vec::new(),
            referee: Referee::new(scenario.legs.clone(), vehicle.state().position),
            decisions: Vec::new(),
            decision_count: 0,
            loads,
            duration: scenario.duration,
            hotel: scenario.hotel,
            energy_at_start: kinetic + potential,
            mean_slip: 0.0,
            worst_slip: 0.0,
            requested_way: 0.0,
            deep: vec![[0; 2]; scenario.robot.wheels.len()],
            steps_per_period,
            ended: None,
            navigated: None,
            vehicle,
        })
    }

    /// The robot.
    #[must_use]
    pub const fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// Computes the wheels' forces with another accuracy, for comparisons ([`Vehicle::set_accuracy`]).
    pub fn set_accuracy(&mut self, accuracy: Accuracy) {
        self.vehicle.set_accuracy(accuracy);
    }

    /// The ground.
    #[must_use]
    pub const fn ground(&self) -> &Ground {
        &self.ground
    }

    /// The robot's computer.
    #[must_use]
    pub const fn on_board(&self) -> &OnBoard {
        &self.on_board
    }

    /// Drives to the end and gives `sink` a frame every hundredth of a second; it ends the drive by returning false.
    pub fn run(&mut self, mut sink: impl FnMut(&Frame<'_>) -> bool) -> DriveResult {
        while self.ended.is_none() {
            if !self.period(&mut sink) {
                break;
            }
        }
        self.result()
    }

    /// What the way requests of the robot now: at rest while it settles and after the last leg.
    #[must_use]
    pub fn request(&self) -> Request {
        let is_settled = self.vehicle.time() >= SETTLING_TIME_S;
        if let Some(request) = self.navigated.filter(|_| is_settled) {
            return request;
        }
        let leg = self.referee.leg().filter(|_| is_settled);
        leg.map_or_else(Request::default, |leg| Request {
            speed: leg.speed,
            heading: leg.heading,
            yaw_rate: None,
        })
    }

    /// Requests something else than the legs from now on: the door for a navigator.
    ///
    /// # Errors
    /// [`grouser_slip::Error::OutOfRange`] for a speed, heading or yaw rate that is not finite or absurd; nothing changes then.
    pub fn set_request(&mut self, request: Request) -> Result<()> {
        const LIMITS: (f64, f64) = (-1e3, 1e3);
        for (field, value, unit) in [
            ("speed", request.speed, "m/s"),
            ("heading", request.heading, "rad"),
            ("yaw rate", request.yaw_rate.unwrap_or(0.0), "rad/s"),
        ] {
            OutOfRange::check(field, value, LIMITS, unit).map_err(|range| {
                grouser_slip::Error::OutOfRange {
                    of: "request".to_owned(),
                    range,
                }
            })?;
        }
        self.navigated = Some(request);
        Ok(())
    }

    /// Ends the drive as a navigator declares it.
    pub fn end(&mut self, outcome: Outcome) {
        self.ended.get_or_insert(outcome);
    }

    /// Replaces the on-board computer's commands for the next period: the door for a controller of another kind. Call it
    /// between two periods of a [`Pilot::OpenLoop`] drive, whose computer estimates and takes no decisions.
    ///
    /// # Errors
    /// [`grouser_slip::Error::UnknownWheel`] unless there is one command a wheel,
    /// [`grouser_slip::Error::OutOfRange`] for a speed, a traction or an angle that is not finite or absurd; nothing
    /// changes then.
    pub fn set_commands(&mut self, commands: &[WheelCommand]) -> Result<()> {
        /// Faster than any rim, m/s.
        const MAX_RIM_SPEED: f64 = 1e3;
        /// More than any soil transmits.
        const MAX_TRACTION: f64 = 1e3;
        if commands.len() != self.commands.len() {
            let (index, wheels) = (commands.len(), self.commands.len());
            return Err(grouser_slip::Error::UnknownWheel { index, wheels }.into());
        }
        for (index, command) in commands.iter().enumerate() {
            let pi = std::f64::consts::PI;
            for (field, value, limits, unit) in [
                (
                    "rim_speed",
                    command.rim_speed,
                    (-MAX_RIM_SPEED, MAX_RIM_SPEED),
                    "m/s",
                ),
                ("traction", command.traction, (0.0, MAX_TRACTION), "1"),
                ("steering_angle", command.steering_angle, (-pi, pi), "rad"),
            ] {
                OutOfRange::check(field, value, limits, unit).map_err(|range| {
                    grouser_slip::Error::OutOfRange {
                        of: format!("command of wheel {index}"),
                        range,
                    }
                })?;
            }
        }
        self.commands.copy_from_slice(commands);
        Ok(())
    }

    /// One period of the control loop; false once the drive has ended.
    pub fn period(&mut self, sink: &mut impl FnMut(&Frame<'_>) -> bool) -> bool {
        self.samples.clear();
        for _ in 0..self.steps_per_period {
            self.step();
        }
        let angles = self.vehicle.state().attitude.angles();
        self.hold_posture();
        let goes_on = self.control(angles.2);
        let frame = self.frame(angles);
        sink(&frame) && goes_on
    }

    /// The posture control, and the margin, of a chassis with actuators.
    fn hold_posture(&mut self) {
        let time = self.vehicle.time();
        if let Some(control) = &mut self.posture {
            for sample in &self.samples {
                if let Measurement::JointAngle { joint, angle } = sample.measurement {
                    control.set_joint(joint, angle);
                }
            }
        }
        if time < self.posture_due || self.vehicle.model().actuators.is_empty() {
            return;
        }
        self.posture_due += POSTURE_PERIOD_S;
        let margin = self.vehicle.tip_over_margin();
        let least = self.margins.map_or(margin, |[_, least]| least.min(margin));
        self.margins = Some([margin, least]);
        if let Some(control) = &mut self.posture {
            let attitude = self.on_board.attitude();
            let actuators = self.vehicle.model().actuators.iter();
            let positions: Vec<f64> = actuators.map(|own| own.position).collect();
            let setpoints = control.update((attitude.roll(), attitude.pitch()), &positions);
            for (index, setpoint) in setpoints.iter().enumerate() {
                self.vehicle.set_actuator(index, *setpoint);
            }
        }
    }

    fn step(&mut self) {
        let time = self.vehicle.time();
        let step = CONTROL_PERIOD_S / f64::from(self.steps_per_period);
        self.sensors.read(&self.vehicle, &mut self.arrived);
        for sample in &self.arrived {
            self.on_board.update_at(to_ns(time), *sample);
        }
        self.samples.extend_from_slice(&self.arrived);
        self.drive_motors(time, step);
        self.vehicle.advance(&mut self.ground);
        for index in 0..self.truths.len() {
            let blocked = FaultKind::WheelBlocked;
            let schedule = self.sensors.schedule();
            if schedule.active(blocked, Some(index), time).is_some() {
                self.vehicle.set_spin(index, 0.0);
            }
            let wheel = &self.vehicle.wheels()[index];
            self.truths[index].add(wheel.rim * step, wheel.velocity[0] * step);
        }
    }

    /// The motor drivers turn commands into torques.
    fn drive_motors(&mut self, time: f64, step: f64) {
        for (index, command) in self.commands.iter().enumerate() {
            let mount = &self.vehicle.model().wheels[index];
            let Some(motor) = &mount.motor else { continue };
            let radius = mount.wheel.radius();
            let rate = self.vehicle.wheels()[index].encoder_rate;
            let rate = self.sensors.driver_rate(index, rate, time);
            let limit = command.traction * self.loads[index] * radius;
            let torque = self.drivers[index].torque(
                command.rim_speed / radius,
                rate,
                (limit, motor.max_torque()),
                step,
            );
            let schedule = self.sensors.schedule();
            let is_off = schedule.active(FaultKind::MotorOff, Some(index), time);
            let torque = if is_off.is_some() { 0.0 } else { torque };
            self.vehicle
                .set_input(index, torque, command.steering_angle);
        }
    }

    /// Referee and on-board computer; false at the end.
    fn control(&mut self, yaw: f64) -> bool {
        let time = self.vehicle.time();
        let state = self.vehicle.state();
        let place = state.position;
        let up = state.attitude.to_world(Vector::AXES[2]);
        let is_settled = time >= SETTLING_TIME_S;
        let ended = if is_settled {
            let tilt = Real::acos(up.z.clamp(-1.0, 1.0));
            self.referee.look(time, place, tilt)
        } else {
            None
        };
        let on_map = self.ground.at(place.x, place.y).known;
        let ended = ended
            .or_else(|| (!on_map).then_some(Outcome::OffMap))
            .or_else(|| (time >= self.duration).then_some(Outcome::TimeOut));
        for (index, wheel) in self.vehicle.wheels().iter().enumerate() {
            // the wheels are the robot's own, and their angles finite
            let _ = self.on_board.set_steering_angle(index, wheel.steer);
        }
        let request = self.request();
        self.requested_way += CONTROL_PERIOD_S * request.speed.abs();
        let commands = self.on_board.tick(to_ns(time), request);
        self.commands.copy_from_slice(commands);
        self.compare(yaw);
        let mut stopped = None;
        if let Some(decision) = self.on_board.decision() {
            self.decision_count += 1;
            if self.decisions.len() < MAX_DECISIONS {
                self.decisions.push(NamedDecision {
                    time,
                    decision,
                    place: (place.x, place.y),
                });
            }
            if let Action::End(ending) = decision.action {
                stopped = Some(outcome_of(ending));
            }
        }
        self.ended = ended.or(stopped);
        self.ended.is_none()
    }

    /// True against estimated slip.
    fn compare(&mut self, yaw: f64) {
        self.frames.clear();
        let (mut sum, mut weight) = (0.0, 0.0);
        for index in 0..self.truths.len() {
            let truth = self.truths[index].tick(CONTROL_PERIOD_S);
            let wheel = &self.vehicle.wheels()[index];
            let observation = self.on_board.observations()[index];
            let mount = &self.vehicle.model().wheels[index];
            if wheel.load.normal > 0.0 {
                let is_deep = grouser_terra::is_deep(wheel.load.pressed, mount.wheel.radius());
                let [loaded, deep] = &mut self.deep[index];
                *loaded += 1;
                *deep += u64::from(is_deep);
            }
            let powered = mount.motor.is_some();
            if powered {
                self.scoring
                    .add(index, &observation, truth, CONTROL_PERIOD_S);
                if let Some((slip, _)) = truth {
                    sum += slip * wheel.load.normal;
                    weight += wheel.load.normal;
                }
            }
            self.frames.push(WheelFrame {
                slip: truth.map(|(slip, _)| slip),
                slip_now: grouser_terra::Slip::from_speeds(wheel.velocity[0], wheel.rim)
                    .ok()
                    .map(grouser_slip::Slip::value),
                observation,
                torque: wheel.motor.torque,
                load: wheel.load.normal,
                sinkage: wheel.load.pressed,
                speeds: [wheel.rim, wheel.velocity[0]],
                forces: [wheel.load.along, wheel.load.across],
                place: [wheel.place.x, wheel.place.y, wheel.place.z],
                heading: yaw + self.vehicle.model().wheels[index].heading + wheel.steer,
            });
        }
        if weight > 0.0 {
            let share = CONTROL_PERIOD_S / (WORST_SLIP_TIME_S + CONTROL_PERIOD_S);
            self.mean_slip += share * (sum / weight - self.mean_slip);
            self.worst_slip = self.worst_slip.max(self.mean_slip);
        }
    }

    fn frame(&self, (roll, pitch, yaw): (f64, f64, f64)) -> Frame<'_> {
        let state = self.vehicle.state();
        let place = state.position;
        Frame {
            time: self.vehicle.time(),
            place: [place.x, place.y, place.z],
            angles: [roll, pitch, yaw],
            speed: state.velocity().x,
            estimated_speed: self.on_board.speed(),
            mode: self.on_board.mode(),
            requested_speed: self.referee.leg().map_or(0.0, |leg| leg.speed),
            energy: self.electric(),
            distance: self.referee.distance(),
            tip_over_margin: self.margins.map(|[now, _]| now),
            actuators: &self.vehicle.model().actuators,
            wheels: &self.frames,
            optimum: (self.on_board.soil())
                .and_then(SoilLearner::running_slip)
                .unwrap_or(self.optimum),
            soil: self.on_board.soil().map(SoilLearner::estimate),
            samples: &self.samples,
        }
    }

    fn electric(&self) -> f64 {
        self.vehicle.ledger().electric + self.hotel * self.vehicle.time()
    }

    /// What came of the drive so far; it ends `time-out` where it has not ended.
    #[must_use]
    pub fn result(&self) -> DriveResult {
        let ledger = *self.vehicle.ledger();
        let (kinetic, potential) = self.vehicle.energy();
        let stored = kinetic + potential - self.energy_at_start;
        let spent = ledger.motor_heat + ledger.soil + ledger.bearings + ledger.dampers + stored;
        // a drive that ends at once has turned over next to nothing
        let least = LEAST_LIFT_M * self.vehicle.model().weight();
        let turned = ledger.electric.abs().max(ledger.soil.abs()).max(least);
        let place = self.vehicle.state().position;
        DriveResult {
            outcome: self.ended.unwrap_or(Outcome::TimeOut),
            duration: self.vehicle.time(),
            distance: self.referee.distance(),
            way: self.referee.way(),
            requested_way: self.requested_way,
            energy: self.electric(),
            ledger,
            energy_error: (ledger.electric - spent) / turned,
            slip: self.scoring.score(),
            worst_slip: self.worst_slip,
            min_tip_over_margin: self.margins.map(|[_, least]| least),
            deep_share: {
                let shares = self.deep.iter().filter(|[loaded, _]| *loaded > 0);
                shares.fold(0.0, |most, [loaded, deep]| {
                    f64::max(most, *deep as f64 / *loaded as f64)
                })
            },
            undeclared: self.ground.map().undeclared(),
            decisions: self.decisions.clone(),
            decision_count: self.decision_count,
            refused: self.on_board.refused(),
            end: (place.x, place.y),
            soil: self.on_board.soil().map(SoilLearner::estimate),
        }
    }
}

const fn outcome_of(ending: Ending) -> Outcome {
    match ending {
        Ending::Tipping => Outcome::Tipped,
        Ending::SensorsLost => Outcome::SensorsLost,
        Ending::NoWay => Outcome::NoWay,
        _ => Outcome::Immobilised,
    }
}

/// How often `period` goes into `length`, at least once.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "both were checked, and their ratio is at most 1e5"
)]
fn periods(length: f64, period: f64) -> u32 {
    (length / period).round().clamp(1.0, 1e5) as u32
}

/// Steps in a control period: as the scenario gives them, else few that keep the robot stable on these soils.
fn steps_per_period(scenario: &Scenario, soils: &[Soil]) -> Result<u32> {
    let strength = scenario.ground.packing.greatest_strength();
    let rate = fastest_rate(&scenario.robot, soils, strength, GAIN_S_PER_RAD)?;
    if let Some(step) = scenario.step {
        // the limit that is named has whole hundredths of a millisecond
        let stable = (MAX_STEP_RATE / rate * 1e5).floor().max(1.0) / 1e5;
        let of = format!("scenario \"{}\"", scenario.name);
        Error::check(&of, "step_s", step, (STEP_LIMITS_S.0, stable), "s")?;
        return Ok(periods(CONTROL_PERIOD_S, step));
    }
    let longest = (STEP_RATE / rate).clamp(STEP_LIMITS_S.0, MAX_STEP_S);
    Ok(periods((CONTROL_PERIOD_S / longest).ceil(), 1.0))
}
