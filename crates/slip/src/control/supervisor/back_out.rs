//! Driving back the way the robot came.

use super::super::decision::{Action, Ending, Reason};
use super::super::observation::RobotObservation;
use super::super::settings::{ControlSettings, Decides};
use super::recovery::Recovery;
use super::slip_monitor::MAX_ACCEPTED_SLIP;
use super::soft_ground::STANDSTILL_SPEED_M_PER_S;
use super::transition::{Next, Transition, View};

/// A robot that does not move back for this long is stuck, s: long enough for the slip to be raised to its limit.
const MAX_IDLE_TIME_S: f64 = 10.0;
/// While the robot moves back slowly more slip is allowed, at this rate, 1/s.
const SLIP_RATE_PER_S: f64 = 0.1;
/// Backing out fails after this multiple of its length over its speed.
const MAX_TIME_FACTOR: f64 = 8.0;
/// ... and not before this multiple of the time in which its rims reverse: the robot follows later.
const REVERSAL_TIME_FACTOR: f64 = 2.0;
/// Backing out slower than this share of the standstill speed is no movement; tuned on `soft-patch.toml`.
const IDLE_SPEED_SHARE: f64 = 0.25;
/// Backing out slower than this share of its setpoint is slow.
const SLOW_SPEED_SHARE: f64 = 0.5;
/// A traverse after backing out has at first this share of its angle, and with each further attempt another quarter.
const FIRST_ANGLE_SHARE: f64 = 0.75;
const FURTHER_ANGLE_SHARE: f64 = 0.25;

/// Backing out, before a detour or a traverse.
#[derive(Clone, Copy, Debug)]
pub(super) struct BackOut {
    /// The heading that it holds, rad.
    heading: f64,
    /// How far it backs out before a detour round soft ground, m; `None` before a traverse.
    detour_length: Option<f64>,
    /// How long it has not moved back, s.
    idle_time: f64,
    /// How much more slip is allowed.
    pushed_slip: f64,
}

/// Speed at which the robot is to back out, m/s.
fn setpoint_speed(settings: &ControlSettings, robot: &RobotObservation) -> f64 {
    (settings.back_speed * robot.request.speed.abs()).min(settings.max_rim_speed)
}

impl BackOut {
    pub(super) const fn new(heading: f64, detour_length: Option<f64>) -> Self {
        Self {
            heading,
            detour_length,
            idle_time: 0.0,
            pushed_slip: 0.0,
        }
    }

    pub(super) const fn heading(&self) -> f64 {
        self.heading
    }

    pub(super) const fn pushed_slip(&self) -> f64 {
        self.pushed_slip
    }

    pub(super) fn monitor(
        &mut self,
        settings: &ControlSettings,
        robot: &RobotObservation,
        step: f64,
    ) {
        let backward = -robot.speed_ahead().unwrap_or(0.0);
        let setpoint = setpoint_speed(settings, robot);
        self.idle_time = if backward < IDLE_SPEED_SHARE * STANDSTILL_SPEED_M_PER_S {
            self.idle_time + step
        } else {
            0.0
        };
        if backward < SLOW_SPEED_SHARE * setpoint {
            let max_slip = MAX_ACCEPTED_SLIP - settings.optimum;
            self.pushed_slip = (self.pushed_slip + step * SLIP_RATE_PER_S).min(max_slip);
        }
    }

    pub(super) fn decide(&self, view: &View<'_>, recovery: &mut Recovery) -> Option<Transition> {
        let settings = view.settings;
        let length = self.detour_length.unwrap_or(settings.back_length);
        if view.travel >= length {
            return Some(if settings.decides == Decides::BacksOut {
                let values = (view.travel, length);
                Transition::to(Next::Forward, Action::Resume, Reason::BackedOut, values)
            } else if self.detour_length.is_some() {
                let width = recovery.detour_width(settings);
                let values = (recovery.detour_angle(), width);
                Transition::to(Next::Detour, Action::Detour, Reason::BackedOut, values)
            } else {
                // another way: the other side, wider with every attempt
                let side = recovery.choose_traverse_side(true);
                let further = f64::from(recovery.attempts().max(1) - 1);
                let share = FIRST_ANGLE_SHARE + FURTHER_ANGLE_SHARE * further;
                let angle = settings.traverse_angle * share;
                let values = (view.travel, length);
                let next = Next::Traverse { side, angle };
                Transition::to(next, Action::Traverse, Reason::BackedOut, values)
            });
        }
        let speed = setpoint_speed(settings, view.robot);
        // rims that ran at the requested speed first stop, and then run back
        let forward = view.robot.request.speed.abs().min(settings.max_rim_speed);
        let reversal = (forward + speed) / settings.max_acceleration;
        let max_time =
            (MAX_TIME_FACTOR * length / speed.max(1e-3)).max(REVERSAL_TIME_FACTOR * reversal);
        let values = if self.idle_time > MAX_IDLE_TIME_S {
            (self.idle_time, MAX_IDLE_TIME_S)
        } else if view.time > max_time {
            (view.time, max_time)
        } else {
            return None;
        };
        Some(Transition::end(
            Ending::Immobilised,
            Reason::NoProgress,
            values,
        ))
    }
}
