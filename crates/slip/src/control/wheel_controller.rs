//! One wheel's slip loop: the speed of its rim and its share of the torque.

use super::command::{MotionCommand, WheelCommand};
use super::decision::{Action, Decision, Reason};
use super::decision_queue::DecisionQueue;
use super::finite;
use super::geometry::WheelGeometry;
use super::motor_guard::MotorGuard;
use super::observation::WheelObservation;
use super::settings::ControlSettings;
use crate::robot::{Wheel, WheelRole};
use crate::state::{Health, Motion};

/// The integral of the slip error moves the setpoint by at most this slip: a quarter of the range, so that a wrong
/// estimate cannot wind it up to where the wheel digs.
const MAX_INTEGRAL_SLIP: f64 = 0.25;
/// Limits of the slip setpoint: v̂/(1 − s*) has a pole at 1, and below 0 the wheel would brake.
const SLIP_SETPOINT_LIMITS: (f64, f64) = (0.02, 0.95);
/// Saturation is reported once it has lasted this long, s, and its end likewise: shorter ones are noise of the slip.
const REPORT_TIME_S: f64 = 0.5;
/// A rim that is limited while its slip has been unknown for this long, s, runs no slower than it creeps until it is known: so
/// slow that both speeds are below their noise, it would never be.
const UNKNOWN_SLIP_TIME_S: f64 = 1.0;
/// A stop brakes the rims with this multiple of the greatest acceleration.
const STOP_ACCELERATION_FACTOR: f64 = 2.0;

/// A wheel: where it stands and its loop's state.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelController {
    geometry: WheelGeometry,
    powered: bool,
    /// Setpoint of the rim's speed after the limit of acceleration, m/s.
    rim_speed: f64,
    /// Integral of the slip error, 1.
    integral: f64,
    guard: MotorGuard,
    /// How long slip has limited it (positive) or not (negative), s.
    limited_time: f64,
    /// For how long its slip has been unknown while the travel limited it, s.
    unknown_time: f64,
    is_reported: bool,
}

impl WheelController {
    pub(super) fn new(wheel: &Wheel) -> Self {
        Self {
            geometry: WheelGeometry {
                x: wheel.x,
                y: wheel.y,
                heading: wheel.heading.rad(),
                max_steering_angle: 0.0,
            },
            powered: wheel.role == WheelRole::Powered,
            rim_speed: 0.0,
            integral: 0.0,
            guard: MotorGuard::default(),
            limited_time: 0.0,
            unknown_time: 0.0,
            is_reported: false,
        }
    }

    pub(super) const fn geometry(&self) -> &WheelGeometry {
        &self.geometry
    }

    pub(super) const fn set_max_steering_angle(&mut self, angle: f64) {
        self.geometry.max_steering_angle = angle;
    }

    pub(super) const fn is_powered(&self) -> bool {
        self.powered
    }

    /// Is a part of its torque cut off?
    pub(super) fn is_shed(&self) -> bool {
        self.guard.torque_share() < 1.0
    }

    /// The command of a wheel of which nothing is known; once something is, its rim starts from rest.
    pub(super) fn rest(&mut self) -> WheelCommand {
        (self.rim_speed, self.integral) = (0.0, 0.0);
        WheelCommand::default()
    }

    /// The wheel's command for the robot's motion. `feedforward` is the share by which rims run faster than the robot is
    /// to travel.
    pub(super) fn command(
        &mut self,
        settings: &ControlSettings,
        observation: &WheelObservation,
        (motion, feedforward): (&MotionCommand, f64),
        step: f64,
        (index, decisions): (usize, &mut DecisionQueue),
    ) -> WheelCommand {
        let (steering_angle, speed) = self.geometry.setpoint(motion.speed, motion.yaw_rate);
        if !self.powered {
            return WheelCommand {
                steering_angle,
                ..WheelCommand::default()
            };
        }
        let unlimited = speed * (1.0 + feedforward);
        let limit = if settings.limits_slip && motion.limits_slip && !motion.stopped {
            self.slip_limit(settings, observation, motion, (speed, unlimited), step)
        } else {
            None
        };
        let setpoint = if motion.stopped {
            0.0
        } else {
            let most = settings.max_rim_speed;
            limit.unwrap_or(unlimited).clamp(-most, most)
        };
        let max_change = settings.max_acceleration * step;
        let max_change = if motion.stopped {
            STOP_ACCELERATION_FACTOR * max_change
        } else {
            max_change
        };
        let (least, most) = (self.rim_speed - max_change, self.rim_speed + max_change);
        self.rim_speed = setpoint.clamp(least, most);
        self.report(
            limit.map(|limit| (unlimited, limit)),
            observation,
            motion.slip,
            step,
            (index, decisions),
        );
        self.guard
            .update(self.rim_speed, observation, step, (index, decisions));
        WheelCommand {
            rim_speed: self.rim_speed,
            traction: settings.max_traction * self.guard.torque_share(),
            steering_angle,
        }
    }

    /// v̂/(1 − s*), where that is less than the speed without a limit.
    fn slip_limit(
        &mut self,
        settings: &ControlSettings,
        observation: &WheelObservation,
        motion: &MotionCommand,
        (speed, unlimited): (f64, f64),
        step: f64,
    ) -> Option<f64> {
        if matches!(
            observation.health,
            Health::Invalid(_) | Health::Uninitialised
        ) || observation.motion == Some(Motion::LiftOff)
        {
            return None;
        }
        let forward = finite(observation.forward_speed)?;
        // along the requested direction
        let sense = if unlimited < 0.0 { -1.0 } else { 1.0 };
        let travel = (sense * forward).max(0.0);
        let slip = match observation.motion {
            Some(Motion::RollBack) => Some(1.0),
            _ => finite(observation.slip),
        };
        let limit_at = |setpoint: f64| {
            travel / (1.0 - setpoint.clamp(SLIP_SETPOINT_LIMITS.0, SLIP_SETPOINT_LIMITS.1))
        };
        let mut setpoint = motion.slip + self.integral;
        if let Some(slip) = slip {
            let sigma = finite(observation.sigma).unwrap_or(settings.sigma_half);
            let ratio = sigma / settings.sigma_half;
            let trust = 1.0 / (1.0 + ratio * ratio);
            let error = (motion.slip - slip.clamp(-1.0, 1.0)) * trust;
            setpoint += settings.gain * error;
            // Anti-windup: the integral moves only while slip is what limits the wheel.
            if limit_at(setpoint) < sense * unlimited {
                self.integral = (self.integral + step * settings.integral_gain * error)
                    .clamp(-MAX_INTEGRAL_SLIP, MAX_INTEGRAL_SLIP);
            } else {
                self.integral -= self.integral * step.min(1.0);
            }
        }
        let limit = limit_at(setpoint);
        let is_unknown = slip.is_none() && limit < sense * unlimited;
        self.unknown_time = if is_unknown {
            self.unknown_time + step
        } else {
            0.0
        };
        let least_share = if self.unknown_time > UNKNOWN_SLIP_TIME_S {
            motion.min_speed_share.max(settings.creep)
        } else {
            motion.min_speed_share
        };
        let floor = least_share * (sense * speed).max(0.0);
        let limit = limit.max(floor);
        (limit < sense * unlimited).then_some(sense * limit)
    }

    /// Reports a limitation that lasts, of the rim's speed `unlimited` to `limited`, and its end.
    fn report(
        &mut self,
        limitation: Option<(f64, f64)>,
        observation: &WheelObservation,
        setpoint: f64,
        step: f64,
        (index, decisions): (usize, &mut DecisionQueue),
    ) {
        let known = finite(observation.slip);
        // an unknown slip may be any
        let slip = known.unwrap_or(1.0);
        self.limited_time = if limitation.is_some() && slip > setpoint {
            self.limited_time.max(0.0) + step
        } else {
            self.limited_time.min(0.0) - step
        };
        let (action, reason, values) = if !self.is_reported && self.limited_time > REPORT_TIME_S {
            match limitation {
                Some(speeds) if known.is_none() => {
                    (Action::ReduceTorque, Reason::SlipUnknown, speeds)
                }
                _ => (Action::ReduceTorque, Reason::SlipHigh, (slip, setpoint)),
            }
        } else if self.is_reported && self.limited_time < -REPORT_TIME_S && slip <= setpoint {
            (Action::RaiseTorque, Reason::SlipRegained, (slip, setpoint))
        } else {
            return;
        };
        self.is_reported = !self.is_reported;
        decisions.push(Decision::of_wheel(index, action, reason, values));
    }
}
