//! The loop: ground, robot, sensors, estimator, controller, motors.

use grouser_slip::Health;
use grouser_slip::control::{
    Action, ControlInput, Controller, Ending, Mode, WheelOrder, WheelSeen,
};

use super::motor_driver::MotorDriver;
use super::outcome::{DriveResult, NamedDecision, Outcome};
use super::pilot::Pilot;
use super::referee::Referee;
use super::scenario::Scenario;
use super::truth::{Scoring, TrueSlip};
use super::watch::Watch;
use crate::dynamics::{Vehicle, WheelCommand};
use crate::error::Result;
use crate::ground::Ground;
use crate::sensors::{FaultKind, Reading, Sensors, to_ns};
use crate::statics::wheel_loads;

/// The controller runs every this many seconds, and frames are given at the same moments.
const CONTROL_PERIOD: f64 = 0.01;
/// The robot settles on the ground for this long before it is asked for anything, s.
const SETTLING: f64 = 1.0;
/// Its estimator is switched on after this long, s.
const SWITCHED_ON: f64 = 0.5;
/// Decisions that are kept.
const MOST_DECISIONS: usize = 1000;

/// A wheel in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelFrame {
    /// True slip over the estimator's window.
    pub slip: Option<f64>,
    /// True slip at this moment.
    pub slip_now: Option<f64>,
    /// What is estimated.
    pub seen: WheelSeen,
    /// Torque of the motor, N m.
    pub torque: f64,
    /// Load, N.
    pub load: f64,
    /// Sinkage, m.
    pub sinkage: f64,
    /// Speed of the rim and of the centre along its heading, m/s.
    pub speeds: [f64; 2],
}

/// What is true and what is known at one moment.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// s since the start.
    pub time: f64,
    /// m.
    pub place: [f64; 3],
    /// Roll, pitch, yaw, rad.
    pub angles: [f64; 3],
    /// True forward speed, m/s.
    pub speed: f64,
    /// Estimated forward speed, m/s.
    pub speed_seen: Option<f64>,
    /// What the robot does.
    pub mode: Mode,
    /// Asked speed, m/s.
    pub asked_speed: f64,
    /// Electrical energy so far, J.
    pub energy: f64,
    /// Progress along the legs, m.
    pub distance: f64,
    /// The wheels.
    pub wheels: &'a [WheelFrame],
    /// What the sensors gave in this period.
    pub readings: &'a [Reading],
}

/// A drive under way.
#[derive(Clone, Debug)]
pub struct Drive {
    ground: Ground,
    vehicle: Vehicle,
    sensors: Sensors,
    watch: Watch,
    controller: Controller,
    drivers: Vec<MotorDriver>,
    orders: Vec<WheelOrder>,
    commands: Vec<WheelCommand>,
    seen: Vec<WheelSeen>,
    truths: Vec<TrueSlip>,
    scoring: Scoring,
    frames: Vec<WheelFrame>,
    readings: Vec<Reading>,
    read: Vec<Reading>,
    referee: Referee,
    decisions: Vec<NamedDecision>,
    decision_count: u64,
    loads: Vec<f64>,
    mode: Mode,
    duration: f64,
    hotel: f64,
    energy_at_start: f64,
    worst: (f64, f64),
    every: u64,
    ended: Option<Outcome>,
}

impl Drive {
    /// A drive of `scenario` by `pilot`, with everything random from `seed`; `optimum` is the slip to run at.
    ///
    /// # Errors
    /// What is wrong with ground, robot or settings.
    pub fn new(scenario: &Scenario, pilot: Pilot, optimum: f64, seed: u64) -> Result<Self> {
        let ground = scenario.ground.build(seed)?;
        let vehicle = Vehicle::new(
            scenario.robot.clone(),
            &ground,
            scenario.start,
            scenario.step,
        )?;
        let model = vehicle.model();
        let loads = wheel_loads(model, 0.0, 0.0).loads;
        let soil = ground.soils()[0];
        let watch = Watch::new(model, &loads, &soil, scenario.start.2, &scenario.sensors)?;
        let settings = pilot.settings(scenario.control, optimum, scenario.fixed_slip);
        let ranges: Vec<f64> = model.wheels.iter().map(|wheel| wheel.steer_range).collect();
        let controller = Controller::new(&model.robot, settings)?.steered(&ranges);
        let count = model.wheels.len();
        let (window, lag) = watch.window_and_lag();
        let [window, lag] = [window, lag].map(|time| ticks(time, CONTROL_PERIOD));
        let seen = loads.iter().map(|load| nothing_seen(*load)).collect();
        let every = ticks_u64(CONTROL_PERIOD, scenario.step);
        let referee = Referee::new(scenario.legs.clone(), vehicle.state().position);
        let (kinetic, potential) = vehicle.energy();
        Ok(Self {
            sensors: Sensors::new(&vehicle, scenario.sensors, scenario.faults.clone(), seed),
            ground,
            watch,
            controller,
            drivers: vec![MotorDriver::default(); count],
            orders: vec![WheelOrder::default(); count],
            commands: vec![WheelCommand::default(); count],
            seen,
            truths: vec![TrueSlip::new(window, lag); count],
            scoring: Scoring::new(count),
            frames: Vec::with_capacity(count),
            readings: Vec::new(),
            read: Vec::new(),
            referee,
            decisions: Vec::new(),
            decision_count: 0,
            loads,
            mode: Mode::Forward,
            duration: scenario.duration,
            hotel: scenario.hotel,
            energy_at_start: kinetic + potential,
            worst: (0.0, 0.0),
            every,
            ended: None,
            vehicle,
        })
    }

    /// The robot.
    #[must_use]
    pub const fn vehicle(&self) -> &Vehicle {
        &self.vehicle
    }

    /// The ground.
    #[must_use]
    pub const fn ground(&self) -> &Ground {
        &self.ground
    }

    /// Drives to the end and gives `watch` a frame every hundredth of a second; it may end the drive by
    /// returning false.
    pub fn run(&mut self, mut watch: impl FnMut(&Frame<'_>) -> bool) -> DriveResult {
        while self.ended.is_none() {
            if !self.period(&mut watch) {
                break;
            }
        }
        self.result()
    }

    /// One period of the control loop; false once the drive has ended.
    pub fn period(&mut self, watch: &mut impl FnMut(&Frame<'_>) -> bool) -> bool {
        self.readings.clear();
        for _ in 0..self.every {
            self.step();
        }
        let go_on = self.control();
        let frame = self.frame();
        watch(&frame) && go_on
    }

    fn step(&mut self) {
        let time = self.vehicle.time();
        let step = self.step_size();
        self.sensors.read(&self.vehicle, &mut self.read);
        for reading in &self.read {
            self.watch.take(reading, to_ns(time), time >= SWITCHED_ON);
            if let Reading::Current { wheel, share, .. } = reading {
                self.seen[*wheel].torque_share = Some(*share);
            }
        }
        self.readings.extend_from_slice(&self.read);
        let schedule = self.sensors.schedule();
        for (index, command) in self.commands.iter_mut().enumerate() {
            let mount = &self.vehicle.model().wheels[index];
            let Some(motor) = &mount.motor else { continue };
            let off = schedule.active(FaultKind::MotorOff, Some(index), time);
            let order = self.orders[index];
            let radius = mount.wheel.radius();
            let rate =
                self.sensors
                    .driver_rate(index, self.vehicle.wheels()[index].encoder_rate, time);
            let limit = order.traction * self.loads[index] * radius;
            let torque = self.drivers[index].torque(
                order.rim_speed / radius,
                rate,
                (limit, motor.most_torque()),
                step,
            );
            command.torque = if off.is_some() { 0.0 } else { torque };
            command.steer = order.steer;
        }
        self.vehicle.advance(&mut self.ground, &self.commands);
        for index in 0..self.truths.len() {
            if schedule
                .active(FaultKind::WheelBlocked, Some(index), time)
                .is_some()
            {
                self.vehicle.set_spin(index, 0.0);
            }
            let wheel = &self.vehicle.wheels()[index];
            self.truths[index].add(wheel.rim * step, wheel.velocity[0] * step);
        }
    }

    fn step_size(&self) -> f64 {
        CONTROL_PERIOD / self.every as f64
    }

    /// Referee, controller, orders; false at the end.
    fn control(&mut self) -> bool {
        let time = self.vehicle.time();
        let state = self.vehicle.state();
        let place = state.position;
        let up = state.attitude.to_world(crate::vector::Vector::AXES[2]);
        let ended = if time < SETTLING {
            None
        } else {
            self.referee.look(time, place, up.z.clamp(-1.0, 1.0).acos())
        };
        let on_map = self.ground.at(place.x, place.y).known;
        let ended = ended
            .or_else(|| (!on_map).then_some(Outcome::OffMap))
            .or_else(|| (time >= self.duration).then_some(Outcome::TimeOut));
        let steers = self.vehicle.wheels().iter().map(|wheel| wheel.steer);
        self.watch.look(time, steers, &mut self.seen);
        for (seen, load) in self.seen.iter_mut().zip(&self.loads) {
            seen.load = *load;
        }
        self.compare();
        let leg = self.referee.leg().copied().filter(|_| time >= SETTLING);
        let (asked_speed, asked_heading) = leg.map_or((0.0, 0.0), |leg| (leg.speed, leg.heading));
        let output = self.controller.step(&ControlInput {
            time_ns: to_ns(time),
            wheels: &self.seen,
            speed: self.watch.speed(),
            heading: self.watch.attitude().heading(),
            pitch: self.watch.attitude().pitch(),
            roll: self.watch.attitude().roll(),
            demanded: self.watch.demanded(),
            asked_speed,
            asked_heading,
        });
        self.orders.copy_from_slice(output.orders);
        self.mode = output.mode;
        let mut stopped = None;
        if let Some(decision) = output.decision {
            self.decision_count += 1;
            if self.decisions.len() < MOST_DECISIONS {
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
    fn compare(&mut self) {
        self.frames.clear();
        let (mut sum, mut weight) = (0.0, 0.0);
        for index in 0..self.truths.len() {
            let truth = self.truths[index].tick(CONTROL_PERIOD);
            let wheel = &self.vehicle.wheels()[index];
            let seen = self.seen[index];
            let powered = self.vehicle.model().wheels[index].motor.is_some();
            if powered {
                self.scoring.add(index, &seen, truth, CONTROL_PERIOD);
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
                seen,
                torque: wheel.motor.torque,
                load: wheel.load.normal,
                sinkage: wheel.load.pressed,
                speeds: [wheel.rim, wheel.velocity[0]],
            });
        }
        if weight > 0.0 {
            let mean = sum / weight;
            self.worst.0 += CONTROL_PERIOD / (1.0 + CONTROL_PERIOD) * (mean - self.worst.0);
            self.worst.1 = self.worst.1.max(self.worst.0);
        }
    }

    fn frame(&self) -> Frame<'_> {
        let state = self.vehicle.state();
        let (roll, pitch, yaw) = state.attitude.angles();
        let place = state.position;
        Frame {
            time: self.vehicle.time(),
            place: [place.x, place.y, place.z],
            angles: [roll, pitch, yaw],
            speed: state.velocity().x,
            speed_seen: self.watch.speed(),
            mode: self.mode,
            asked_speed: self.referee.leg().map_or(0.0, |leg| leg.speed),
            energy: self.electric(),
            distance: self.referee.distance(),
            wheels: &self.frames,
            readings: &self.readings,
        }
    }

    fn electric(&self) -> f64 {
        self.vehicle.ledger().electric + self.hotel * self.vehicle.time()
    }

    fn result(&self) -> DriveResult {
        let ledger = *self.vehicle.ledger();
        let (kinetic, potential) = self.vehicle.energy();
        let stored = kinetic + potential - self.energy_at_start;
        let spent = ledger.motor_heat + ledger.soil + ledger.bearings + ledger.dampers + stored;
        let turned = ledger.electric.abs().max(ledger.soil.abs()).max(1e-9);
        let place = self.vehicle.state().position;
        DriveResult {
            outcome: self.ended.unwrap_or(Outcome::TimeOut),
            duration: self.vehicle.time(),
            distance: self.referee.distance(),
            way: self.referee.way(),
            energy: self.electric(),
            ledger,
            energy_error: (ledger.electric - spent) / turned,
            slip: self.scoring.score(),
            worst_slip: self.worst.1,
            decisions: self.decisions.clone(),
            decision_count: self.decision_count,
            refused: self.watch.refused(),
            end: (place.x, place.y),
        }
    }
}

fn nothing_seen(load: f64) -> WheelSeen {
    WheelSeen {
        slip: None,
        sigma: None,
        health: Health::Uninitialised,
        motion: None,
        forward_speed: None,
        rim_speed: None,
        torque_share: None,
        firmness: None,
        load,
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

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "both were checked, and their ratio is at most 1e5"
)]
fn ticks(length: f64, period: f64) -> usize {
    (length / period).round().clamp(1.0, 1e5) as usize
}

fn ticks_u64(length: f64, period: f64) -> u64 {
    ticks(length, period) as u64
}
