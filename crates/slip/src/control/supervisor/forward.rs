//! Driving as requested.

use super::super::decision::{Action, Reason};
use super::recovery::Recovery;
use super::slip_monitor::SlipMonitor;
use super::transition::{Next, Transition, View};

/// On a slope the robot turns aside at the first sign of digging, as long as it still advances.
pub(super) fn turn_aside(
    view: &View<'_>,
    slip: &SlipMonitor,
    recovery: &mut Recovery,
) -> Option<Transition> {
    let settings = view.settings;
    let fails = slip.dig_time() >= settings.dig_time || slip.stuck_time() >= settings.dig_time;
    let is_high = slip.slip() > settings.high_slip;
    if !(fails && is_high && view.tilt > settings.steep && recovery.attempts() == 0) {
        return None;
    }
    recovery.begin_attempt();
    let side = recovery.choose_traverse_side(false);
    Some(Transition::to(
        Next::Traverse {
            side,
            angle: settings.traverse_angle,
        },
        Action::Traverse,
        Reason::DiggingIn,
        (slip.slip(), settings.dig_slip),
    ))
}
