//! Which engine finds the slips, and what of the log it is shown.

use grouser_slip::{Measurement, Reference, Robot, WheelRole};

/// Which engine finds the slips of the rows.
///
/// ```
/// use grouser_replay::Method;
///
/// assert_eq!(Method::NAMES.map(|(_, method)| method.name()), ["filter", "window"]);
/// ```
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

    /// The filter where the robot's speed is measured. Without a measured speed its slip would be its prior, while means over windows
    /// at least compare the wheels.
    ///
    /// ```
    /// use grouser_replay::Method;
    /// use grouser_slip::Reference;
    ///
    /// assert_eq!(Method::of(Reference::Pose), Method::Filter);
    /// assert_eq!(Method::of(Reference::Grip), Method::Window);
    /// ```
    #[must_use]
    pub fn of(reference: Reference) -> Self {
        if reference == Reference::Grip {
            Self::Window
        } else {
            Self::Filter
        }
    }
}

/// Does the filter use a measurement, where `reference` measures the robot's speed? Free wheels are used beside a
/// measured motion, and not where the powered wheels are the only source.
pub(crate) fn reaches_filter(
    measurement: &Measurement,
    reference: Reference,
    robot: &Robot,
) -> bool {
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
        Measurement::Displacement { .. } | Measurement::Position { .. } => {
            reference == Reference::Displacement
        }
        Measurement::Pose { .. } => reference == Reference::Pose,
        Measurement::Speed { .. } => reference == Reference::Speed,
        _ => true,
    }
}

/// The wheel whose rotation is measured.
pub(crate) const fn rotating_wheel(measurement: &Measurement) -> Option<usize> {
    if measurement.is_rotation() {
        measurement.wheel()
    } else {
        None
    }
}
