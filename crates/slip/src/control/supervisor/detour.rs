//! Driving round soft ground.

use grouser_real::Real;

use super::super::decision::{Action, Reason};
use super::recovery::Recovery;
use super::transition::{Next, Transition, View};

/// A way round soft ground.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Detour {
    /// How far the robot has moved aside, m.
    aside: f64,
}

impl Detour {
    /// Across until the soft ground is passed.
    pub(super) fn decide(&mut self, view: &View<'_>, recovery: &Recovery) -> Option<Transition> {
        let robot = view.robot;
        let across = robot.heading.map_or(0.0, |now| {
            Real::sin(now - robot.request.heading) * robot.speed_ahead().unwrap_or(0.0)
        });
        self.aside += recovery.detour_side() * across * view.step;
        let width = recovery.detour_width(view.settings);
        (self.aside >= width).then(|| {
            Transition::to(
                Next::Forward,
                Action::Resume,
                Reason::ClearedSoftGround,
                (self.aside, width),
            )
        })
    }
}
