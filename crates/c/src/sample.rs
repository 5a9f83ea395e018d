//! A sample of C as one of the filter.

use grouser_slip::{Measurement, MeasurementKind, MeasurementParts, Sample};

use crate::abi::{self, GROUSER_ERROR_VALUE, GROUSER_HAS_LEFT, GROUSER_HAS_TURN, GrouserSample};
use crate::border::Code;

/// A kind's number in C; `None` for what the computer makes itself.
const fn number(kind: MeasurementKind) -> Option<u32> {
    Some(match kind {
        MeasurementKind::WheelCount => abi::GROUSER_WHEEL_COUNT,
        MeasurementKind::WheelEdge => abi::GROUSER_WHEEL_EDGE,
        MeasurementKind::WheelAngle => abi::GROUSER_WHEEL_ANGLE,
        MeasurementKind::WheelRate => abi::GROUSER_WHEEL_RATE,
        MeasurementKind::YawRate => abi::GROUSER_YAW_RATE,
        MeasurementKind::Displacement => abi::GROUSER_DISPLACEMENT,
        MeasurementKind::Pose => abi::GROUSER_POSE,
        MeasurementKind::Position => abi::GROUSER_POSITION,
        MeasurementKind::Speed => abi::GROUSER_SPEED,
        MeasurementKind::Acceleration => abi::GROUSER_ACCELERATION,
        MeasurementKind::Inertial => abi::GROUSER_INERTIAL,
        MeasurementKind::JointAngle => abi::GROUSER_JOINT_ANGLE,
        MeasurementKind::SteeringAngle => abi::GROUSER_STEERING_ANGLE,
        MeasurementKind::MotorCurrent => abi::GROUSER_MOTOR_CURRENT,
        MeasurementKind::Sinkage => abi::GROUSER_SINKAGE,
        MeasurementKind::EntryAngle => abi::GROUSER_ENTRY_ANGLE,
        MeasurementKind::WheelTorque => abi::GROUSER_WHEEL_TORQUE,
        // `grouser_tick` has the command, joints move the carriers, and no description in C knows a robot's steering as a whole
        MeasurementKind::Steering | MeasurementKind::Carrier | MeasurementKind::Command => {
            return None;
        }
    })
}

/// The sample, or the code of what is wrong with it. Numbers are judged by the filter.
pub(crate) fn parse(sample: &GrouserSample) -> Result<Sample, Code> {
    let mut kinds = MeasurementKind::ALL.iter();
    let kind = kinds.find(|kind| number(**kind) == Some(sample.kind));
    let kind = *kind.ok_or(GROUSER_ERROR_VALUE)?;
    let mut numbers = sample.values.map(Some);
    if sample.flags & !(GROUSER_HAS_TURN | GROUSER_HAS_LEFT) != 0 {
        return Err(GROUSER_ERROR_VALUE);
    }
    match kind {
        MeasurementKind::WheelEdge if sample.raw > 1 => return Err(GROUSER_ERROR_VALUE),
        MeasurementKind::WheelEdge => numbers[0] = Some(if sample.raw == 1 { 1.0 } else { -1.0 }),
        MeasurementKind::Displacement if sample.flags & GROUSER_HAS_TURN == 0 => numbers[2] = None,
        MeasurementKind::Speed if sample.flags & GROUSER_HAS_LEFT == 0 => numbers[1] = None,
        _ => {}
    }
    let parts = MeasurementParts {
        index: sample.wheel as usize,
        count: sample.raw,
        numbers,
    };
    let measurement = Measurement::from_parts(kind, parts).ok_or(GROUSER_ERROR_VALUE)?;
    Ok(Sample {
        time_ns: sample.time_ns,
        measurement,
    })
}
