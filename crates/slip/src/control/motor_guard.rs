//! Protection of one motor: a stalled wheel, and a wheel whose encoder counts the wrong way.

use super::decision::{Action, Decision, Reason};
use super::decision_queue::DecisionQueue;
use super::finite;
use super::observation::WheelObservation;
use crate::state::Motion;

/// A motor with more than this share of its torque and a standing rim has stalled; normal driving on the shipped
/// scenarios stays below it.
const STALL_TORQUE_SHARE: f64 = 0.8;
/// A rim slower than this stands, m/s: two ticks of the shipped robots' encoders in a tenth of a second.
const STALL_RIM_SPEED_M_PER_S: f64 = 0.004;
/// A stall is called after this long, s, so that torque falls within 50 ms (test `a11_…` in `tests/control.rs`).
const STALL_TIME_S: f64 = 0.03;
/// Where no torque is measured, a rim that stands although it is to run at more than this counts as stalled, m/s: slower
/// ones stand for long between two ticks ...
const UNMEASURED_STALL_SETPOINT_M_PER_S: f64 = 0.03;
/// ... once it lasts this long, s: drivers start a motor within 0.2 s. Covers a stuck encoder too.
const UNMEASURED_STALL_TIME_S: f64 = 0.5;
/// A rim that runs against its command faster than this is measured by a reversed encoder, m/s ...
const REVERSED_RIM_SPEED_M_PER_S: f64 = 0.03;
/// ... once it lasts this long, s: a wheel that reverses needs less.
const REVERSED_TIME_S: f64 = 0.2;
/// Share of the torque that is left of a motor that is protected.
const SHED_TORQUE_SHARE: f64 = 0.1;
/// The torque returns within this time, s: slowly enough for a stall to show again first.
const RETURN_TIME_S: f64 = 2.0;

/// Protection of one motor.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotorGuard {
    stall_time: f64,
    standing_time: f64,
    reversed_time: f64,
    torque_share: f64,
}

impl Default for MotorGuard {
    fn default() -> Self {
        Self {
            stall_time: 0.0,
            standing_time: 0.0,
            reversed_time: 0.0,
            torque_share: 1.0,
        }
    }
}

impl MotorGuard {
    /// Share of the torque that the motor may give.
    pub(super) const fn torque_share(&self) -> f64 {
        self.torque_share
    }

    /// A stalled wheel loses its torque at once; one that turns against its command may not run away.
    pub(super) fn update(
        &mut self,
        rim_setpoint: f64,
        observation: &WheelObservation,
        step: f64,
        (index, decisions): (usize, &mut DecisionQueue),
    ) {
        let measured_torque = finite(observation.torque_share);
        let torque = measured_torque.unwrap_or(0.0);
        let rim = finite(observation.rim_speed);
        let stands = rim.is_some_and(|rim| rim.abs() < STALL_RIM_SPEED_M_PER_S);
        let stalls = observation.motion == Some(Motion::Stall)
            || (torque.abs() > STALL_TORQUE_SHARE
                && rim_setpoint.abs() > 2.0 * STALL_RIM_SPEED_M_PER_S
                && stands);
        self.stall_time = if stalls { self.stall_time + step } else { 0.0 };
        let stands_unmeasured = measured_torque.is_none()
            && stands
            && rim_setpoint.abs() > UNMEASURED_STALL_SETPOINT_M_PER_S;
        self.standing_time = if stands_unmeasured {
            self.standing_time + step
        } else {
            0.0
        };
        let is_reversed = rim.is_some_and(|rim| {
            // a wheel that rolls back with its robot is measured rightly
            let rolls_back = finite(observation.forward_speed).is_some_and(|v| v * rim > 0.0);
            rim.abs() > REVERSED_RIM_SPEED_M_PER_S
                && rim * rim_setpoint < 0.0
                && torque * rim < 0.0
                && !rolls_back
        });
        self.reversed_time = if is_reversed {
            self.reversed_time + step
        } else {
            0.0
        };
        let (reason, values) = if self.stall_time >= STALL_TIME_S {
            (Reason::Stall, (torque.abs(), STALL_TORQUE_SHARE))
        } else if self.standing_time >= UNMEASURED_STALL_TIME_S {
            let values = (self.standing_time, UNMEASURED_STALL_TIME_S);
            (Reason::Stall, values)
        } else if self.reversed_time >= REVERSED_TIME_S {
            let rim = rim.unwrap_or(0.0);
            (Reason::EncoderReversed, (rim, REVERSED_RIM_SPEED_M_PER_S))
        } else {
            self.torque_share = (self.torque_share + step / RETURN_TIME_S).min(1.0);
            return;
        };
        if self.torque_share > 0.5 {
            decisions.push(Decision::of_wheel(
                index,
                Action::ShedTorque,
                reason,
                values,
            ));
        }
        self.torque_share = SHED_TORQUE_SHARE;
    }
}
