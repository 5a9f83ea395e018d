//! Who drives: open loop or the controller.

use grouser_slip::control::{ControlSettings, Decides};

/// Who drives.
///
/// ```
/// use grouser_rover::drive::Pilot;
///
/// assert_eq!(Pilot::ALL.map(Pilot::name), ["open-loop", "controller"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Pilot {
    /// Every rim runs at the requested speed, whatever the ground does; only the heading is held.
    OpenLoop,
    /// The whole controller; it learns the soil where the scenario has it learnt.
    Controller,
}

impl Pilot {
    /// Every pilot.
    pub const ALL: [Self; 2] = [Self::OpenLoop, Self::Controller];

    /// Its name in tables, files and flags.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::OpenLoop => "open-loop",
            Self::Controller => "controller",
        }
    }

    /// The controller's settings for it.
    pub(super) fn settings(self, mut settings: ControlSettings, optimum: f64) -> ControlSettings {
        match self {
            // heading is held, so that all drive the same way
            Self::OpenLoop => {
                settings.limits_slip = false;
                settings.decides = Decides::Nothing;
                settings.max_feedforward = 0.0;
            }
            Self::Controller => settings.optimum = optimum,
        }
        settings
    }
}
