//! Which of a log's samples are used.

use grouser_files::robot::WheelSensor;
use grouser_slip::{Measurement, Sample};

/// A sample of the log as one of the robot, whose wheel `i` of the log is `wheels[i]`.
pub(crate) fn of_robot(sample: Sample, wheels: &[usize]) -> Sample {
    match sample.measurement.wheel() {
        Some(wheel) => Sample {
            measurement: sample.measurement.with_wheel(wheels[wheel]),
            ..sample
        },
        None => sample,
    }
}

/// Is the sample used where wheels are measured by `sensor`? One sensor of the wheels is, and everything else.
pub(crate) const fn is_used(measurement: &Measurement, sensor: WheelSensor) -> bool {
    match measurement {
        Measurement::WheelCount { .. } => matches!(sensor, WheelSensor::Count),
        Measurement::WheelAngle { .. } => matches!(sensor, WheelSensor::Angle),
        Measurement::WheelRate { .. } => matches!(sensor, WheelSensor::Rate),
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
