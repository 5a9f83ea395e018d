//! All comparisons over one log.

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_slip::window::{WindowBody, WindowSettings};
use grouser_slip::{Reference, Robot, Sample, WheelRole};

use crate::axes::{AxisCheck, AxisWatch};
use crate::distance::DistanceCheck;
use crate::encoder_signs::EncoderSigns;
use crate::exchange::ExchangeWatch;
use crate::findings::{Findings, Uses};
use crate::frozen::FrozenWatch;
use crate::pose::{PoseFault, PoseWatch};
use crate::reference_delay::Tracks;
use crate::speed_sign::SignWatch;
use crate::turns::TurnWatch;
use crate::wiring::{SameSensor, SecondDrive};

/// A reference whose distance is this multiple of the wheels' in the median has another unit. A choice: feet are 3.3.
const MAX_SCALE: f64 = 3.0;

/// Compares the sensors of a log with each other.
///
/// It takes every sample in the order of time ([`Doctor::take`]), the means over windows after all samples of one time
/// ([`Doctor::step`]), and answers at the end ([`Doctor::findings`]).
#[derive(Clone, Debug)]
pub struct Doctor {
    robot: Robot,
    tracks: Tracks,
    low_speed: f64,
    axes: AxisWatch,
    pose: PoseWatch,
    speed_sign: SignWatch,
    same_sensor: SameSensor,
    second_drive: SecondDrive,
    frozen: FrozenWatch,
    /// `None` of a robot that steers by one angle: it turns otherwise than by the speeds of its sides.
    turns: Option<TurnWatch>,
    exchange: Option<ExchangeWatch>,
    signs: Option<EncoderSigns>,
}

/// What is known when all samples of one time have come.
#[derive(Clone, Copy, Debug)]
pub struct Window<'a> {
    /// The time, ns.
    pub now_ns: i64,
    /// The same from the log's start, s.
    pub time_s: f64,
    /// Means over the window that ended last.
    pub body: &'a WindowBody,
    /// The speed of each wheel over it in the robot's order, m/s.
    pub wheel_speeds: &'a [Option<f64>],
}

impl Doctor {
    /// For a robot whose means are taken by `settings`.
    #[must_use]
    pub fn new(file: &RobotFile, settings: &WindowSettings, sensor: WheelSensor) -> Self {
        let (robot, low_speed) = (&file.robot, settings.low_speed);
        let steering = file.steering.as_ref();
        let by_sides = steering.is_none();
        Self {
            tracks: Tracks::new(file, settings.reference, sensor).with_room(),
            axes: AxisWatch::new(robot, low_speed),
            pose: PoseWatch::new(robot, steering, low_speed, settings.position_sigma),
            speed_sign: SignWatch::default(),
            same_sensor: SameSensor::new(robot),
            second_drive: SecondDrive::default(),
            frozen: FrozenWatch::default(),
            turns: (by_sides.then(|| TurnWatch::new(robot, low_speed, settings.window))).flatten(),
            exchange: ExchangeWatch::new(robot, settings.window),
            signs: by_sides.then(|| EncoderSigns::new(robot, low_speed)),
            robot: robot.clone(),
            low_speed,
        }
    }

    /// Takes a sample, not earlier than those before.
    pub fn take(&mut self, sample: &Sample) {
        self.tracks.take(sample);
        self.second_drive.take(&self.robot, sample);
        self.frozen.take(sample);
        self.axes.take(sample);
        self.pose.take(sample);
        self.speed_sign.take(sample);
    }

    /// Takes the angle of a wheel as the robot's steering sets it.
    pub fn take_steering(&mut self, sample: &Sample) {
        self.tracks.take(sample);
    }

    /// Takes the means over a window.
    pub fn step(&mut self, window: &Window<'_>) {
        let body = window.body;
        let speed = |wheel: usize| window.wheel_speeds.get(wheel).copied().flatten();
        if let Some(turns) = &mut self.turns {
            turns.take(window.time_s, body, |wheel| speed(wheel).unwrap_or(0.0));
        }
        if let Some(exchange) = &mut self.exchange {
            exchange.step(body, speed);
        }
        if let Some(signs) = &mut self.signs {
            signs.step(body, window.wheel_speeds);
        }
        let wheels = self.robot.wheels().iter().zip(window.wheel_speeds);
        let powered = wheels.filter(|(wheel, _)| wheel.role == WheelRole::Powered);
        let speeds = powered.filter_map(|(_, speed)| *speed);
        let (sum, count) =
            speeds.fold((0.0, 0.0), |(sum, count), speed| (sum + speed, count + 1.0));
        if count > 0.0 {
            self.axes.step(window.now_ns, sum / count);
            self.frozen.step(window.now_ns, sum / count);
            self.pose.step(window.now_ns, sum / count, body);
        }
        self.speed_sign
            .step(body, window.wheel_speeds, self.low_speed);
        self.same_sensor
            .step(window.wheel_speeds, self.pose.take_turned());
    }

    /// What was found, for an estimate that uses these sensors.
    #[must_use]
    pub fn findings(&self, uses: Uses) -> Findings {
        let exchange =
            (self.exchange.as_ref()).and_then(|of| of.found(self.pose.is_turn_certain()));
        let mut turns = self.turns.as_ref().map(TurnWatch::summary);
        if let Some(turns) = turns.as_mut().filter(|_| exchange.is_some()) {
            // The difference is wiring: no wheel slips by it.
            turns.wheel = None;
        }
        let mut pose = self.pose.summary();
        let (mut steering, gyro_scale) = self.pose.steering();
        pose.gyro_scale = pose.gyro_scale.or(gyro_scale);
        // without a gyro the same turns by the wheels are compared with those of the yaw
        match pose.fault {
            Some(PoseFault::PlaceMirrored | PoseFault::Unit(_)) => steering = None,
            Some(_) if steering.is_some() => pose.fault = None,
            _ => {}
        }
        let distance = DistanceCheck::of(&self.tracks);
        let scale = distance.map_or(1.0, |of| of.scales[1]);
        if scale > MAX_SCALE && steering.is_none() {
            pose.fault = pose.fault.or(Some(PoseFault::Unit(scale)));
        }
        let (has_fault, second_drive) = (pose.fault.is_some(), self.second_drive.found_s());
        let wheels_without_sign = self.speed_sign.wheels_without_sign();
        let axes = self.axes.summary();
        Findings {
            turns,
            exchange: exchange.clone(),
            axes: AxisCheck {
                reference: axes.reference.filter(|_| uses.has_heading),
                ..axes
            },
            has_other_acceleration: self.axes.has_other_scale(),
            pose,
            speed_without_sign_m: (self.speed_sign.backwards())
                .filter(|_| uses.reference == Reference::Speed),
            wheels_without_sign_m: wheels_without_sign.filter(|_| uses.has_heading && !has_fault),
            reversed: self.signs.as_ref().and_then(EncoderSigns::reversed),
            steering,
            distance,
            same_sensor: self.same_sensor.found(),
            second_drive_s: second_drive,
            frozen_s: self.frozen.found_s().filter(|_| second_drive.is_none()),
            is_gyro_constant: self.pose.is_gyro_constant(),
            wheels_turn: self.pose.wheels_turn().filter(|_| exchange.is_none()),
            uses,
        }
    }
}
