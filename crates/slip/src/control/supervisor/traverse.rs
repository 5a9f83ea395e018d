//! Crossing a slope at an angle.

use super::super::decision::{Action, Decision, Ending, Reason};
use super::super::settings::ControlSettings;
use super::recovery::Recovery;
use super::slip_monitor::SlipMonitor;
use super::transition::{Next, Transition, View};
use super::turn::MAX_TURN_TIME_S;

/// A traverse turns away from the requested heading by at most this, rad (46°): beyond it the robot gains no height.
const MAX_ANGLE_RAD: f64 = 0.8;
/// A leg on a slope that has become gentle ends after this share of its length.
const MIN_LEG_SHARE: f64 = 0.3;
/// A traverse whose slip stays high widens by this share of its first angle.
const WIDEN_SHARE: f64 = 0.25;

/// A leg of a traverse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Traverse {
    /// +1 left, −1 right.
    side: f64,
    /// Angle to the requested heading, rad.
    angle: f64,
    /// How long it has been turning, s.
    turning_time: f64,
}

impl Traverse {
    pub(super) fn new(side: f64, angle: f64) -> Self {
        Self {
            side,
            angle: angle.min(MAX_ANGLE_RAD),
            turning_time: 0.0,
        }
    }

    /// Setpoint of the heading beside the requested one, rad.
    pub(super) const fn angle(&self) -> f64 {
        self.side * self.angle
    }

    pub(super) fn monitor(&mut self, on_course: bool, step: f64) {
        self.turning_time = if on_course {
            0.0
        } else {
            self.turning_time + step
        };
    }

    pub(super) fn decide(
        &mut self,
        view: &View<'_>,
        slip: &mut SlipMonitor,
        recovery: &mut Recovery,
    ) -> Option<Transition> {
        let settings = view.settings;
        if self.turning_time > MAX_TURN_TIME_S {
            return Some(self.give_up_turning(settings, recovery));
        }
        let is_gentle = view.tilt < settings.level;
        let values = (view.tilt, settings.level);
        let resume = || {
            let (action, reason) = (Action::Resume, Reason::SlopeGentle);
            Some(Transition::to(Next::Forward, action, reason, values))
        };
        if view.travel >= settings.traverse_length {
            if is_gentle || view.tilt < settings.steep {
                return resume();
            }
            let side = recovery.choose_traverse_side(true);
            return Some(Transition::to(
                Next::Traverse {
                    side,
                    angle: self.angle,
                },
                Action::SwitchSide,
                Reason::LegCompleted,
                (view.travel, settings.traverse_length),
            ));
        }
        if is_gentle && view.travel > MIN_LEG_SHARE * settings.traverse_length {
            return resume();
        }
        self.widen(settings, slip)
    }

    /// The robot cannot turn that far here: back, and then the other way.
    fn give_up_turning(&self, settings: &ControlSettings, recovery: &mut Recovery) -> Transition {
        let values = (self.turning_time, MAX_TURN_TIME_S);
        if recovery.attempts() >= settings.max_attempts {
            return Transition::end(Ending::Immobilised, Reason::AttemptsUsed, values);
        }
        recovery.begin_attempt();
        Transition::to(
            Next::BackOut {
                detour_length: None,
            },
            Action::BackOut,
            Reason::NoProgress,
            values,
        )
    }

    fn widen(&mut self, settings: &ControlSettings, slip: &mut SlipMonitor) -> Option<Transition> {
        let limit = 0.5 * (settings.high_slip + settings.dig_slip);
        if slip.high_time() < settings.high_slip_time
            || slip.slip() <= limit
            || self.angle >= MAX_ANGLE_RAD
        {
            return None;
        }
        self.angle = (self.angle + WIDEN_SHARE * settings.traverse_angle).min(MAX_ANGLE_RAD);
        slip.reset_high_time();
        let values = (slip.slip(), limit);
        Some(Transition {
            next: None,
            decision: Decision::of_robot(Action::Traverse, Reason::SlipHigh, values),
        })
    }
}
