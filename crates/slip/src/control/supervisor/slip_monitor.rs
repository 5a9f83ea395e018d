//! The robot's slip over time: high, digging, stuck, or steady because the ground demands it.

use super::super::decision::{Action, Decision, Reason};
use super::super::observation::RobotObservation;
use super::super::settings::ControlSettings;

/// Decisions look at the slip smoothed over this time, s: a wheel turns by a quarter to a half in it.
pub(super) const SLIP_TIME_CONSTANT_S: f64 = 1.0;
/// And over this time, s, to see whether it rises.
pub(super) const SLOW_TIME_CONSTANT_S: f64 = 4.0;
/// A slip within this band of its slow mean is steady; the estimate's own noise on the shipped scenarios is below it.
const STEADY_BAND: f64 = 0.03;
/// A slip that is steady for this long is what the ground demands, s. Tuned on `slope.toml`.
const STEADY_TIME_S: f64 = 2.5;
/// An accepted or demanded slip leaves this much room for more: twice the band in which a slip counts as steady.
pub(super) const SLIP_ROOM: f64 = 0.06;
/// Slip above its setpoint by less than this is at its setpoint.
const SETPOINT_BAND: f64 = 0.02;
/// No slip above this is accepted: the shear stress is mobilised long before, and more only digs.
pub(super) const MAX_ACCEPTED_SLIP: f64 = 0.92;

/// Slip of the powered wheels, and how long it has been what.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SlipMonitor {
    slip: f64,
    slow: f64,
    /// The slip that the ground demands and that was accepted; 0: none.
    accepted: f64,
    /// How long slip has been steadily above its setpoint, or below it (negative), s.
    steady_time: f64,
    high_time: f64,
    dig_time: f64,
    stuck_time: f64,
}

impl SlipMonitor {
    pub(super) const fn slip(&self) -> f64 {
        self.slip
    }

    pub(super) const fn accepted(&self) -> f64 {
        self.accepted
    }

    /// How long the slip has been high, s.
    pub(super) const fn high_time(&self) -> f64 {
        self.high_time
    }

    /// How long the wheels have dug, s.
    pub(super) const fn dig_time(&self) -> f64 {
        self.dig_time
    }

    /// How long the robot has not advanced, s.
    pub(super) const fn stuck_time(&self) -> f64 {
        self.stuck_time
    }

    pub(super) fn filter(&mut self, slip: Option<f64>, step: f64) {
        if let Some(slip) = slip {
            self.slip += step / (SLIP_TIME_CONSTANT_S + step) * (slip - self.slip);
            self.slow += step / (SLOW_TIME_CONSTANT_S + step) * (slip - self.slow);
        }
    }

    pub(super) const fn reset_timers(&mut self) {
        self.high_time = 0.0;
        self.dig_time = 0.0;
        self.stuck_time = 0.0;
    }

    pub(super) const fn reset_high_time(&mut self) {
        self.high_time = 0.0;
    }

    pub(super) const fn reset_steady(&mut self) {
        self.steady_time = 0.0;
    }

    pub(super) const fn forget_accepted(&mut self) {
        self.accepted = 0.0;
    }

    /// One step of a robot that drives; `is_level` is false on a slope, where the slip rises without digging.
    pub(super) fn update_timers(
        &mut self,
        settings: &ControlSettings,
        robot: &RobotObservation,
        is_level: bool,
        step: f64,
    ) {
        let count = |past: f64, now: bool| if now { past + step } else { 0.0 };
        let speed = robot.speed_ahead().unwrap_or(0.0);
        self.high_time = count(self.high_time, self.slip > settings.high_slip);
        let rises = self.slip > self.slow + STEADY_BAND && is_level;
        let spins = self.slip > 1.0 - settings.stuck_share;
        let digs = self.slip > settings.dig_slip && (rises || spins);
        self.dig_time = count(self.dig_time, digs);
        let is_above = self.slip > settings.optimum.max(self.accepted) + SETPOINT_BAND;
        let is_still = (self.slip - self.slow).abs() < STEADY_BAND;
        self.steady_time = if is_above && is_still && speed > 0.0 {
            self.steady_time.max(0.0) + step
        } else if self.slip < settings.optimum {
            self.steady_time.min(0.0) - step
        } else {
            0.0
        };
        let rim_speed = robot
            .rim_speed
            .max(settings.creep * robot.request.speed.abs());
        let stands = speed.abs() < settings.stuck_share * rim_speed;
        self.stuck_time = count(self.stuck_time, stands && robot.speed.is_some());
    }

    /// A slip that stays above its optimum however slowly the rims run is what slope and soil demand. As long as it
    /// is steady the wheels do not dig, and creeping only costs time: it is accepted until it is no longer needed.
    pub(super) fn accept(&mut self, settings: &ControlSettings) -> Option<Decision> {
        if self.steady_time > STEADY_TIME_S && self.slip < MAX_ACCEPTED_SLIP {
            let values = (self.slip, settings.optimum.max(self.accepted));
            self.accepted = (self.slip + SLIP_ROOM).min(MAX_ACCEPTED_SLIP + SLIP_ROOM);
            self.steady_time = 0.0;
            Some(Decision::of_robot(
                Action::AcceptSlip,
                Reason::Demanded,
                values,
            ))
        } else if self.accepted > 0.0 && self.steady_time < -STEADY_TIME_S {
            self.accepted = 0.0;
            let values = (self.slip, settings.optimum);
            Some(Decision::of_robot(
                Action::Resume,
                Reason::SlipRegained,
                values,
            ))
        } else {
            None
        }
    }
}
