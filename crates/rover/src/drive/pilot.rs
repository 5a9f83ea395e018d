//! Who drives: open loop, a fixed slip, or the controller.

use grouser_slip::control::{ControlSettings, Mode};

/// Who drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Pilot {
    /// Every rim runs at the asked speed, whatever the ground does.
    OpenLoop,
    /// The slip loop at a fixed slip, without decisions.
    FixedSlip,
    /// The whole controller at the optimiser's slip.
    Controller,
}

impl Pilot {
    /// Every pilot.
    pub const ALL: [Self; 3] = [Self::OpenLoop, Self::FixedSlip, Self::Controller];

    /// Its name in tables, files and flags.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::OpenLoop => "open-loop",
            Self::FixedSlip => "fixed-slip",
            Self::Controller => "controller",
        }
    }

    /// The controller's settings for it; `None`: no controller at all.
    pub(super) fn settings(
        self,
        settings: ControlSettings,
        optimum: f64,
        fixed: f64,
    ) -> Option<ControlSettings> {
        match self {
            Self::OpenLoop => None,
            Self::FixedSlip => Some(ControlSettings {
                optimum: fixed,
                decides: false,
                ..settings
            }),
            Self::Controller => Some(ControlSettings {
                optimum,
                ..settings
            }),
        }
    }
}

/// A mode's number in tables.
pub(super) const fn mode_of(mode: Option<Mode>) -> Mode {
    match mode {
        Some(mode) => mode,
        None => Mode::Forward,
    }
}
