//! What a mode decides by, and what it decides.

use super::super::decision::{Action, Decision, Ending, Reason};
use super::super::observation::RobotObservation;
use super::super::settings::ControlSettings;

/// The mode that follows.
#[derive(Clone, Copy, Debug)]
pub(super) enum Next {
    Forward,
    /// Towards `side` (+1 left, −1 right), at `angle` (rad) to the requested heading.
    Traverse {
        side: f64,
        angle: f64,
    },
    /// By `detour_length` (m) and then round soft ground; without it by the settings' length and then across the slope.
    BackOut {
        detour_length: Option<f64>,
    },
    Detour,
    Stopped,
}

/// A decision of a mode, with the mode that follows; `None`: the same one goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transition {
    pub(super) next: Option<Next>,
    pub(super) decision: Decision,
}

impl Transition {
    pub(super) const fn to(next: Next, action: Action, reason: Reason, values: (f64, f64)) -> Self {
        Self {
            next: Some(next),
            decision: Decision::of_robot(action, reason, values),
        }
    }

    pub(super) const fn end(ending: Ending, reason: Reason, values: (f64, f64)) -> Self {
        Self::to(Next::Stopped, Action::End(ending), reason, values)
    }
}

/// The robot at one moment.
pub(super) struct View<'a> {
    pub(super) settings: &'a ControlSettings,
    pub(super) robot: &'a RobotObservation,
    /// Smoothed tilt, rad.
    pub(super) tilt: f64,
    /// How long the mode has lasted, s.
    pub(super) time: f64,
    /// How far the robot has travelled in it, m; in `BackOut` backwards.
    pub(super) travel: f64,
    /// Since the last moment, s.
    pub(super) step: f64,
}
