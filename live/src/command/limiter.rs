//! A requested motion in, a motion out at which no wheel slips more than it may.
//!
//! The controller of `grouser-slip` limits each rim to v̂/(1 − s*). A base takes one motion, not a speed for each wheel: the
//! requested motion is scaled by the least of the wheels' shares, so that the robot keeps its arc.

use std::time::{Duration, Instant};

use grouser_slip::control::{
    ControlInput, ControlSettings, Controller, Decides, Mode, Request, WheelCommand,
    WheelObservation,
};
use grouser_slip::{Health, Invalid, Robot, Slip, WheelEstimate, WheelRole};

use super::motion::MotionRequest;
use crate::error::Result;

/// An estimate older than this counts as silence: two periods of a sensor at 20 Hz.
const ESTIMATE_AGE: Duration = Duration::from_millis(100);
/// Zeros are published for this long after the last command, so that one that is lost does not matter; then nothing, so that
/// another source of commands gets its turn.
const ZERO_TIME: Duration = Duration::from_millis(500);
/// A wheel whose speed in a bend is below this share of the fastest one's does not limit the motion: its share is noise.
const MIN_SPEED_SHARE: f64 = 0.2;

/// What the commands are limited to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CommandLimits {
    /// m/s.
    pub(crate) max_speed: f64,
    /// rad/s.
    pub(crate) max_yaw_rate: f64,
    /// Of a rim, m/s².
    pub(crate) max_acceleration: f64,
    /// The slip setpoint.
    pub(crate) slip: f64,
    /// Commands and sensors that are silent for so long stop the robot.
    pub(crate) timeout: Duration,
}

/// Why the motion is zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hold {
    /// No wheel's speed over ground has been estimated yet.
    NoEstimate,
    /// The sensors fell silent. It ends once they are back, and a command has been zero or silent.
    SensorsLost,
}

impl Hold {
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::NoEstimate => {
                "commands are held at zero: the robot's speed over ground is not known"
            }
            Self::SensorsLost => {
                "commands are held at zero: the sensors were silent; send a zero command to drive on"
            }
        }
    }
}

/// What is known of the wheels at a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known<'a> {
    /// In the robot's order.
    pub(crate) wheels: &'a [WheelEstimate],
    /// Since the estimate.
    pub(crate) age: Option<Duration>,
    /// Forward speed of the robot, m/s.
    pub(crate) speed: Option<f64>,
}

/// Limits a stream of requested motions.
pub(crate) struct CommandLimiter {
    robot: Robot,
    limits: CommandLimits,
    controller: Controller,
    at_rest: Controller,
    observations: Vec<WheelObservation>,
    began: Instant,
    last: Option<(Instant, MotionRequest)>,
    hold: Option<Hold>,
    /// The share of the requested motion at the last tick.
    share: f64,
}

impl CommandLimiter {
    /// # Errors
    /// [`Error::Slip`](crate::Error::Slip) for limits outside those of the controller.
    pub(crate) fn new(
        robot: &Robot,
        limits: CommandLimits,
        (has_steering, now): (bool, Instant),
    ) -> Result<Self> {
        let mut settings = ControlSettings::default();
        settings.optimum = limits.slip;
        settings.max_acceleration = limits.max_acceleration;
        settings.max_turn = limits.max_yaw_rate;
        // rims run no faster than requested
        settings.max_feedforward = 0.0;
        settings.decides = Decides::Stops;
        let waited = limits.timeout.saturating_sub(ESTIMATE_AGE);
        settings.blind_time = waited.as_secs_f64().max(1e-3);
        let mut controller = Controller::new(robot, settings)?;
        if has_steering {
            // each wheel points along its own way
            controller =
                controller.with_steering(&vec![std::f64::consts::FRAC_PI_2; robot.wheels().len()]);
        }
        let observations = robot.wheels().iter();
        Ok(Self {
            observations: observations
                .map(|wheel| WheelObservation::unknown(wheel.load.unwrap_or(1.0)))
                .collect(),
            robot: robot.clone(),
            limits,
            at_rest: controller.clone(),
            controller,
            began: now,
            last: None,
            hold: Some(Hold::NoEstimate),
            share: 1.0,
        })
    }

    /// A command that arrived.
    pub(crate) fn request(&mut self, now: Instant, request: MotionRequest) {
        self.last = Some((now, request));
    }

    /// Why the motion is zero; `None` while commands pass.
    pub(crate) const fn hold(&self) -> Option<Hold> {
        self.hold
    }

    /// The share of the requested motion that passed at the last tick.
    pub(crate) const fn share(&self) -> f64 {
        self.share
    }

    /// What to publish now; `None`: nothing. Call it at 20 to 200 Hz.
    pub(crate) fn tick(&mut self, now: Instant, known: &Known<'_>) -> Option<MotionRequest> {
        let since = self.last.map(|(at, _)| now.saturating_duration_since(at));
        let request = match (self.last, since) {
            (Some((_, request)), Some(since)) if since < self.limits.timeout => Some(request),
            _ => None,
        };
        let is_resting = request.is_none_or(MotionRequest::is_zero);
        let is_measured = self.observe(known);
        match self.hold {
            Some(Hold::NoEstimate) if is_measured => self.release(),
            Some(Hold::SensorsLost) if is_measured && is_resting => self.release(),
            _ => {}
        }
        let motion = match self.hold {
            None => self.step(now, (known.speed, is_measured), request.unwrap_or_default()),
            Some(_) => MotionRequest::default(),
        };
        let is_wanted = since.is_some_and(|since| since < self.limits.timeout + ZERO_TIME);
        is_wanted.then_some(if request.is_some() {
            motion
        } else {
            MotionRequest::default()
        })
    }

    fn release(&mut self) {
        self.hold = None;
        self.controller.clone_from(&self.at_rest);
    }

    /// Takes over what is known; is the speed of any powered wheel's centre known?
    fn observe(&mut self, known: &Known<'_>) -> bool {
        let is_current = known.age.is_some_and(|age| age <= ESTIMATE_AGE);
        let mut is_measured = false;
        for ((observation, wheel), described) in self
            .observations
            .iter_mut()
            .zip(known.wheels)
            .zip(self.robot.wheels())
        {
            let health = if is_current {
                wheel.health
            } else {
                Health::Invalid(Invalid::Dropout)
            };
            *observation = WheelObservation {
                slip: wheel.slip.map(Slip::value),
                sigma: wheel.sigma,
                health,
                motion: wheel.motion,
                forward_speed: wheel.forward_speed.map(|speed| speed.value),
                rim_speed: wheel.rim_speed.map(|speed| speed.value),
                ..*observation
            };
            is_measured |= described.role == WheelRole::Powered
                && !matches!(health, Health::Invalid(_) | Health::Uninitialised)
                && wheel.forward_speed.is_some();
        }
        is_measured && known.speed.is_some()
    }

    fn step(
        &mut self,
        now: Instant,
        (speed, is_measured): (Option<f64>, bool),
        request: MotionRequest,
    ) -> MotionRequest {
        let request = request.within(self.limits.max_speed, self.limits.max_yaw_rate);
        let passed = now.saturating_duration_since(self.began).as_nanos();
        let output = self.controller.step(&ControlInput {
            time_ns: i64::try_from(passed).unwrap_or(i64::MAX),
            wheels: &self.observations,
            speed,
            heading: None,
            pitch: None,
            roll: None,
            slip_demand: None,
            request: Request {
                speed: request.speed,
                heading: 0.0,
                yaw_rate: Some(request.yaw_rate),
            },
        });
        if output.mode == Mode::Stopped {
            self.hold = Some(Hold::SensorsLost);
            self.share = 0.0;
            return MotionRequest::default();
        }
        let max_traction = self.controller.settings().max_traction;
        let commands = self.controller.commands();
        let share = share(&self.robot, commands, max_traction, request);
        // without an estimate the controller has no limit: the last one holds until the sensors count as lost
        self.share = if is_measured {
            share
        } else {
            share.min(self.share)
        };
        request.scaled(self.share)
    }
}

/// The share of a requested motion at which no powered rim runs faster than its command, and none gets more torque than its
/// share: a base cannot limit the torque of one wheel, but it can slow down.
fn share(
    robot: &Robot,
    commands: &[WheelCommand],
    max_traction: f64,
    request: MotionRequest,
) -> f64 {
    let powered = || {
        let wheels = robot.wheels().iter().zip(commands);
        wheels
            .filter(|(wheel, _)| wheel.role == WheelRole::Powered)
            .map(|(wheel, command)| {
                let (sin, cos) = (wheel.heading.rad() + command.steering_angle).sin_cos();
                let forward = request.speed - request.yaw_rate * wheel.y;
                let rim = cos * forward + sin * request.yaw_rate * wheel.x;
                (rim, command)
            })
    };
    let fastest = powered().map(|(rim, _)| rim.abs()).fold(0.0, f64::max);
    if fastest == 0.0 {
        return 1.0;
    }
    let shares = powered()
        .filter(|(rim, _)| rim.abs() >= MIN_SPEED_SHARE * fastest)
        .map(|(rim, command)| (command.rim_speed / rim) * (command.traction / max_traction));
    shares.fold(1.0, f64::min).max(0.0)
}
