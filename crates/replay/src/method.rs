//! Which engine finds the slips, and what of the log it is shown.

use grouser_slip::filter::MAX_FILTER_WHEELS;
use grouser_slip::{Measurement, Reference, Robot, WheelRole};

/// Which engine finds the slips of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The slip filter: all sensors together, a slip at every reading ([`grouser_slip::filter::SlipFilter`]).
    Filter,
    /// Means over windows of the wheels and one reference, each window for itself
    /// ([`grouser_slip::window::WindowEstimator`]).
    Window,
}

impl Method {
    /// Every method with its name in flags and files.
    pub const NAMES: [(&'static str, Self); 2] =
        [("filter", Self::Filter), ("window", Self::Window)];

    /// Its name in flags and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Filter => "filter",
            Self::Window => "window",
        }
    }

    /// The filter where something tells how fast the robot travels, up to the number of wheels that it takes. Where
    /// nothing does, its slip would be what was believed before, and means over windows at least compare the wheels.
    #[must_use]
    pub fn of(robot: &Robot, reference: Reference) -> Self {
        if reference != Reference::Grip && robot.wheels().len() <= MAX_FILTER_WHEELS {
            Self::Filter
        } else {
            Self::Window
        }
    }
}

/// Is the filter to hear this, where `reference` tells how fast the robot travels? Free wheels are heard beside a
/// measured motion; where the wheels alone are to tell, neither.
pub(crate) fn is_heard(measurement: &Measurement, reference: Reference, robot: &Robot) -> bool {
    match *measurement {
        Measurement::WheelCount { wheel, .. }
        | Measurement::WheelEdge { wheel, .. }
        | Measurement::WheelAngle { wheel, .. }
        | Measurement::WheelRate { wheel, .. } => {
            reference != Reference::Grip
                || robot
                    .wheels()
                    .get(wheel)
                    .is_none_or(|wheel| wheel.role == WheelRole::Powered)
        }
        Measurement::Displacement { .. } => reference == Reference::Displacement,
        Measurement::Pose { .. } => reference == Reference::Pose,
        Measurement::Speed { .. } => reference == Reference::Speed,
        _ => true,
    }
}
