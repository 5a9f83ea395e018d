//! What of the log the filter is shown.

use grouser_slip::{Measurement, Reference, Robot, WheelRole};

/// Does the filter use a measurement, where `reference` measures the robot's speed? With `grip` free wheels are not used: they would
/// measure it.
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
