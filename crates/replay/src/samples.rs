//! From the log's records to the estimator's samples.

use grouser_files::robot::WheelSensor;
use grouser_log::{Reading, Record};
use grouser_slip::{Measurement, Sample};

/// What a record says to the estimator, if it is used: wheels by the chosen sensor only.
pub(crate) fn sample(record: &Record, wheels: &[usize], sensor: WheelSensor) -> Option<Sample> {
    let measurement = match record.reading {
        Reading::WheelCount { wheel, raw } if sensor == WheelSensor::Count => {
            Measurement::WheelCount {
                wheel: wheels[wheel],
                raw,
            }
        }
        Reading::WheelAngle { wheel, angle } if sensor == WheelSensor::Angle => {
            Measurement::WheelAngle {
                wheel: wheels[wheel],
                angle,
            }
        }
        Reading::WheelRate { wheel, rate } if sensor == WheelSensor::Rate => {
            Measurement::WheelRate {
                wheel: wheels[wheel],
                rate,
            }
        }
        Reading::WheelTorque { wheel, torque } => Measurement::WheelTorque {
            wheel: wheels[wheel],
            torque,
        },
        Reading::Acceleration { forward, left } => Measurement::Acceleration { forward, left },
        Reading::YawRate { rate } => Measurement::YawRate { rate },
        Reading::Displacement {
            forward,
            left,
            turn,
        } => Measurement::Displacement {
            forward,
            left,
            turn,
        },
        Reading::Pose { x, y, yaw } => Measurement::Pose { x, y, yaw },
        Reading::Speed { forward, left } => Measurement::Speed { forward, left },
        Reading::Command { forward, left } => Measurement::Command { forward, left },
        _ => return None,
    };
    Some(Sample {
        time_ns: record.time_ns,
        measurement,
    })
}

/// The wheel that a measurement is of.
pub(crate) const fn wheel_of(measurement: &Measurement) -> Option<usize> {
    match *measurement {
        Measurement::WheelCount { wheel, .. }
        | Measurement::WheelEdge { wheel, .. }
        | Measurement::WheelAngle { wheel, .. }
        | Measurement::WheelRate { wheel, .. } => Some(wheel),
        _ => None,
    }
}
