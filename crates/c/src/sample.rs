//! A sample of C as one of the filter.

use grouser_slip::{Measurement, Sample};

use crate::abi::{
    GROUSER_ACCELERATION, GROUSER_DISPLACEMENT, GROUSER_ERROR_VALUE, GROUSER_HAS_LEFT,
    GROUSER_HAS_TURN, GROUSER_INERTIAL, GROUSER_JOINT_ANGLE, GROUSER_MOTOR_CURRENT, GROUSER_POSE,
    GROUSER_POSITION, GROUSER_SPEED, GROUSER_WHEEL_ANGLE, GROUSER_WHEEL_COUNT, GROUSER_WHEEL_EDGE,
    GROUSER_WHEEL_RATE, GROUSER_WHEEL_TORQUE, GROUSER_YAW_RATE, GrouserSample,
};
use crate::border::Code;

/// The sample, or the code of what is wrong with it. Numbers are judged by the filter.
pub(crate) fn parse(sample: &GrouserSample) -> Result<Sample, Code> {
    let GrouserSample {
        kind,
        time_ns,
        flags,
        raw,
        values: [a, b, c, d, e, f],
        ..
    } = *sample;
    let wheel = sample.wheel as usize;
    if flags & !(GROUSER_HAS_TURN | GROUSER_HAS_LEFT) != 0 {
        return Err(GROUSER_ERROR_VALUE);
    }
    let measurement = match kind {
        GROUSER_WHEEL_COUNT => Measurement::WheelCount { wheel, raw },
        GROUSER_WHEEL_EDGE if raw <= 1 => Measurement::WheelEdge {
            wheel,
            forward: raw == 1,
        },
        GROUSER_WHEEL_ANGLE => Measurement::WheelAngle { wheel, angle: a },
        GROUSER_WHEEL_RATE => Measurement::WheelRate { wheel, rate: a },
        GROUSER_YAW_RATE => Measurement::YawRate { rate: a },
        GROUSER_DISPLACEMENT => Measurement::Displacement {
            forward: a,
            left: b,
            turn: (flags & GROUSER_HAS_TURN != 0).then_some(c),
        },
        GROUSER_POSE => Measurement::Pose { x: a, y: b, yaw: c },
        GROUSER_SPEED => Measurement::Speed {
            forward: a,
            left: (flags & GROUSER_HAS_LEFT != 0).then_some(b),
        },
        GROUSER_INERTIAL => Measurement::Inertial {
            force: [a, b, c],
            rate: [d, e, f],
        },
        GROUSER_JOINT_ANGLE => Measurement::JointAngle {
            joint: wheel,
            angle: a,
        },
        GROUSER_MOTOR_CURRENT => Measurement::MotorCurrent { wheel, share: a },
        GROUSER_WHEEL_TORQUE => Measurement::WheelTorque { wheel, torque: a },
        GROUSER_ACCELERATION => Measurement::Acceleration {
            forward: a,
            left: b,
        },
        GROUSER_POSITION => Measurement::Position { x: a, y: b },
        _ => return Err(GROUSER_ERROR_VALUE),
    };
    Ok(Sample {
        time_ns,
        measurement,
    })
}
