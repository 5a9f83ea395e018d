//! Who drives: open loop or the controller, with or without the chassis' actuators.

use grouser_slip::control::{ControlSettings, Decides};

/// Who drives.
///
/// ```
/// use grouser_rover::drive::Pilot;
///
/// let names = ["open-loop", "controller", "fixed-chassis"];
/// assert_eq!(Pilot::ALL.map(Pilot::name), names);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Pilot {
    /// Every rim runs at the requested speed, whatever the ground does; only the heading is held.
    OpenLoop,
    /// The whole controller; it learns the soil where the scenario has it learnt.
    Controller,
    /// The controller, with a chassis that stays in the pose of its description.
    FixedChassis,
}

impl Pilot {
    /// Every pilot.
    pub const ALL: [Self; 3] = [Self::OpenLoop, Self::Controller, Self::FixedChassis];

    /// Its name in tables, files and flags.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::OpenLoop => "open-loop",
            Self::Controller => "controller",
            Self::FixedChassis => "fixed-chassis",
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
            Self::Controller | Self::FixedChassis => settings.optimum = optimum,
        }
        settings
    }
}
