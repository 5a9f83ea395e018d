//! Constants and structs of the header, field by field. `tests/header.rs` compares both.

use core::ffi::c_char;

/// A struct of the interface.
///
/// # Safety
/// It is `repr(C)`, its first field is `size: u32`, and every bit pattern is a value of it.
pub(crate) unsafe trait CStruct: Copy {}

/// The version of this interface. It grows with every change of a struct, a constant or a function.
pub const GROUSER_ABI: u32 = 2;

/// Done.
pub const GROUSER_OK: i32 = 0;
/// A pointer is NULL or not aligned for its type.
pub const GROUSER_ERROR_POINTER: i32 = 1;
/// A struct's `size` is not that of this version of the library, or an array has a wrong number of elements.
pub const GROUSER_ERROR_SIZE: i32 = 2;
/// A number is NaN, infinite or no value of its enumeration.
pub const GROUSER_ERROR_VALUE: i32 = 3;
/// The robot or a setting cannot be used; the message names field, value, limit and unit.
pub const GROUSER_ERROR_DESCRIPTION: i32 = 4;
/// The filter refused the sample, or one that waited to be put in order before it; the body's counters have the reason.
pub const GROUSER_SAMPLE_REFUSED: i32 = 5;
/// The robot has no such wheel.
pub const GROUSER_ERROR_WHEEL: i32 = 6;
/// An error of the library. The object cannot be used any more, but for `grouser_free`.
pub const GROUSER_ERROR_INTERNAL: i32 = 7;

/// A motor turns the wheel.
pub const GROUSER_POWERED: u32 = 0;
/// The wheel rolls freely.
pub const GROUSER_FREE: u32 = 1;

/// The encoder sits on the motor's shaft.
pub const GROUSER_ENCODER_ON_MOTOR: u32 = 1;
/// The encoder counts down when the wheel drives forwards.
pub const GROUSER_ENCODER_REVERSED: u32 = 2;

/// A contradiction between sensors and description at the start is reported.
pub const GROUSER_START_REPORT: u32 = 0;
/// The sensors are not checked at the start.
pub const GROUSER_START_OFF: u32 = 1;
/// The robot does not drive before the check, nor after a contradiction.
pub const GROUSER_START_REFUSE: u32 = 2;

/// A tick counter: `wheel`, `raw`.
pub const GROUSER_WHEEL_COUNT: u32 = 1;
/// An edge of an encoder: `wheel`, `raw` 1 forwards, 0 backwards.
pub const GROUSER_WHEEL_EDGE: u32 = 2;
/// Angle of the sensor's shaft, unwrapped: `wheel`, rad.
pub const GROUSER_WHEEL_ANGLE: u32 = 3;
/// Rate of the sensor's shaft: `wheel`, rad/s.
pub const GROUSER_WHEEL_RATE: u32 = 4;
/// Yaw rate, rad/s, left positive.
pub const GROUSER_YAW_RATE: u32 = 5;
/// Displacement since the last sample of this kind: forwards m, left m, turn rad if `GROUSER_HAS_TURN`.
pub const GROUSER_DISPLACEMENT: u32 = 6;
/// Pose in a fixed frame: x m, y m, yaw rad.
pub const GROUSER_POSE: u32 = 7;
/// Speed over ground: forwards m/s, left m/s if `GROUSER_HAS_LEFT`.
pub const GROUSER_SPEED: u32 = 8;
/// Specific force, m/s², and angular rate, rad/s; both forwards, left, up.
pub const GROUSER_INERTIAL: u32 = 9;
/// Angle of a joint of the suspension: `wheel` is the joint's index; rad, nose down positive.
pub const GROUSER_JOINT_ANGLE: u32 = 10;
/// A motor's current over its greatest: `wheel`, 1.
pub const GROUSER_MOTOR_CURRENT: u32 = 11;
/// Torque on a wheel: `wheel`, N m, positive when it drives forwards.
pub const GROUSER_WHEEL_TORQUE: u32 = 12;
/// Specific force on the level: forwards, left, m/s².
pub const GROUSER_ACCELERATION: u32 = 13;
/// Place in a fixed frame without a heading, such as a fix or a tag: x m, y m.
pub const GROUSER_POSITION: u32 = 14;
/// Angle by which a wheel is steered beside its heading: `wheel`, rad, left positive.
pub const GROUSER_STEERING_ANGLE: u32 = 15;
/// Depth of a wheel's lowest point below the ground in front of it: `wheel`, m.
pub const GROUSER_SINKAGE: u32 = 16;
/// Angle from a wheel's lowest point to where the ground in front meets its rim: `wheel`, rad.
pub const GROUSER_ENTRY_ANGLE: u32 = 17;

/// The sample's turn is measured.
pub const GROUSER_HAS_TURN: u32 = 1;
/// The sample's speed to the left is measured.
pub const GROUSER_HAS_LEFT: u32 = 2;

/// Not enough has been measured yet.
pub const GROUSER_HEALTH_UNINITIALISED: u32 = 0;
/// The slip and its sigma hold.
pub const GROUSER_HEALTH_OK: u32 = 1;
/// There is an estimate, with the reservation in `reason`.
pub const GROUSER_HEALTH_DEGRADED: u32 = 2;
/// There is no estimate, for the reason in `reason`.
pub const GROUSER_HEALTH_INVALID: u32 = 3;

/// No reason.
pub const GROUSER_REASON_NONE: u32 = 0;
/// The wheel is too slow for its slip to mean anything.
pub const GROUSER_REASON_LOW_SPEED: u32 = 1;
/// The sensors' resolution alone makes sigma exceed its limit.
pub const GROUSER_REASON_QUANTISED: u32 = 2;
/// The reference has fallen silent.
pub const GROUSER_REASON_REFERENCE_LOST: u32 = 3;
/// Only differences between the wheels are known.
pub const GROUSER_REASON_RELATIVE: u32 = 5;
/// The wheel's sensor may be wrong.
pub const GROUSER_REASON_SUSPECT: u32 = 7;
/// The wheel's sensor has fallen silent.
pub const GROUSER_REASON_DROPOUT: u32 = 101;
/// Nothing measures the robot's speed.
pub const GROUSER_REASON_NO_REFERENCE: u32 = 102;
/// The wheel's sensor contradicts the others.
pub const GROUSER_REASON_INCONSISTENT: u32 = 103;
/// A reason that this interface has no number for.
pub const GROUSER_REASON_OTHER: u32 = 255;

/// How the wheel moves is not known yet.
pub const GROUSER_MOTION_UNKNOWN: u32 = 0;
/// Slip in [0, 1].
pub const GROUSER_MOTION_DRIVING: u32 = 1;
/// Slip in [−1, 0).
pub const GROUSER_MOTION_BRAKING: u32 = 2;
/// Both speeds are below their noise.
pub const GROUSER_MOTION_STANDSTILL: u32 = 3;
/// The wheel travels against its own rotation.
pub const GROUSER_MOTION_ROLL_BACK: u32 = 4;
/// The wheel spins without load.
pub const GROUSER_MOTION_LIFT_OFF: u32 = 5;
/// The motor pushes and nothing turns.
pub const GROUSER_MOTION_STALL: u32 = 6;

/// The robot drives as requested.
pub const GROUSER_MODE_FORWARD: u32 = 0;
/// It crosses a slope at an angle.
pub const GROUSER_MODE_TRAVERSE: u32 = 1;
/// It drives back the way it came.
pub const GROUSER_MODE_BACK_OUT: u32 = 2;
/// It drives round soft ground.
pub const GROUSER_MODE_DETOUR: u32 = 3;
/// The drive has ended: the safe stop.
pub const GROUSER_MODE_STOPPED: u32 = 4;

/// `slip` and `slip_sigma` are known.
pub const GROUSER_KNOWS_SLIP: u32 = 1;
/// `forward_speed_m_per_s` and its sigma are known.
pub const GROUSER_KNOWS_FORWARD_SPEED: u32 = 2;
/// `rim_speed_m_per_s` and its sigma are known.
pub const GROUSER_KNOWS_RIM_SPEED: u32 = 4;
/// `side_slip_angle_rad` and its sigma are known.
pub const GROUSER_KNOWS_SIDE_SLIP: u32 = 8;
/// `last_good_age_s` is known.
pub const GROUSER_KNOWS_LAST_GOOD_AGE: u32 = 16;
/// `reference_age_s` is known: a trusted reference has measured the robot's speed.
pub const GROUSER_KNOWS_REFERENCE_AGE: u32 = 32;

/// A wheel of the robot, x forwards and y to the left of the robot's origin.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct GrouserWheel {
    /// `sizeof(GrouserWheel)`.
    pub size: u32,
    /// `GROUSER_POWERED` or `GROUSER_FREE`.
    pub role: u32,
    /// Centre, forwards, m.
    pub x_m: f64,
    /// Centre, to the left, m.
    pub y_m: f64,
    /// Direction in which it drives, from x towards y, rad.
    pub heading_rad: f64,
    /// Effective rolling radius, m.
    pub radius_m: f64,
    /// Load on the level, N; 0: not known.
    pub load_n: f64,
    /// Turns of the motor per turn of the wheel; 0: 1.
    pub gear: f64,
    /// Ticks per turn of the encoder's shaft; 0: it has angles or rates without ticks.
    pub ticks_per_turn: f64,
    /// Step of its rate readings, rad/s of its shaft; 0: continuous.
    pub rate_step_rad_per_s: f64,
    /// Greatest torque of its motor on the wheel, N m; 0: not known.
    pub max_torque_n_m: f64,
    /// How far it steers either way, rad; 0: not at all.
    pub max_steering_angle_rad: f64,
    /// Width of its counter, 8 to 64 bits; 0: 64.
    pub counter_bits: u32,
    /// `GROUSER_ENCODER_…`, added.
    pub encoder_flags: u32,
}

/// One setting of the filter by name.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct GrouserFilterSetting {
    /// A key of `[filter]` in a robot file, in the file's unit, or a field of the filter's settings, in SI units.
    pub key: *const c_char,
    /// Its value.
    pub value: f64,
}

/// How the software works.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct GrouserSettings {
    /// `sizeof(GrouserSettings)`.
    pub size: u32,
    /// `GROUSER_START_…`.
    pub start_policy: u32,
    /// For this long after the first sample the filter waits while the attitude is found, s.
    pub warm_up_s: f64,
    /// Gravity, m/s²; 0: that of the robot file, without one the Earth's.
    pub gravity_m_per_s2: f64,
    /// Heading at the start, rad.
    pub heading_rad: f64,
    /// Settings of the filter; may be NULL where there are none.
    pub filter: *const GrouserFilterSetting,
    /// How many.
    pub filter_count: usize,
}

/// One reading of one sensor.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct GrouserSample {
    /// `sizeof(GrouserSample)`.
    pub size: u32,
    /// Which sensor: `GROUSER_WHEEL_COUNT` and so on.
    pub kind: u32,
    /// When it was taken, ns on the sensor's clock.
    pub time_ns: i64,
    /// Index of the wheel, where it belongs to one.
    pub wheel: u32,
    /// `GROUSER_HAS_…`, added.
    pub flags: u32,
    /// A counter's reading; bits above its width are ignored.
    pub raw: u64,
    /// The numbers, as `kind` has them.
    pub values: [f64; 6],
}

/// What is known of a wheel. What is not known is 0 and has no bit in `known`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct GrouserWheelEstimate {
    /// `sizeof(GrouserWheelEstimate)`.
    pub size: u32,
    /// `GROUSER_KNOWS_…`, added.
    pub known: u32,
    /// `GROUSER_HEALTH_…`.
    pub health: u32,
    /// `GROUSER_REASON_…`.
    pub reason: u32,
    /// `GROUSER_MOTION_…`.
    pub motion: u32,
    /// 0.
    pub reserved: u32,
    /// Slip, in [−1, 1].
    pub slip: f64,
    /// Standard deviation of its error.
    pub slip_sigma: f64,
    /// Speed of the centre along the wheel's heading, m/s.
    pub forward_speed_m_per_s: f64,
    /// Standard deviation, m/s.
    pub forward_speed_sigma_m_per_s: f64,
    /// Speed of the rim, m/s.
    pub rim_speed_m_per_s: f64,
    /// Standard deviation, m/s.
    pub rim_speed_sigma_m_per_s: f64,
    /// From its heading to the way of its centre, left positive, rad.
    pub side_slip_angle_rad: f64,
    /// Standard deviation, rad.
    pub side_slip_angle_sigma_rad: f64,
    /// Seconds since its health was last OK.
    pub last_good_age_s: f64,
}

/// What is known of the robot as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct GrouserBodyEstimate {
    /// `sizeof(GrouserBodyEstimate)`.
    pub size: u32,
    /// `GROUSER_KNOWS_REFERENCE_AGE` or 0.
    pub known: u32,
    /// `GROUSER_MODE_…`.
    pub mode: u32,
    /// 1 where the sensors contradict the robot's description, else 0.
    pub start_fault: u32,
    /// The time up to which samples have been used, ns.
    pub time_ns: i64,
    /// The delay of that behind the newest sample, s.
    pub time_slip_s: f64,
    /// Speed forwards, m/s.
    pub forward_m_per_s: f64,
    /// Standard deviation, m/s.
    pub forward_sigma_m_per_s: f64,
    /// Speed to the left, m/s.
    pub left_m_per_s: f64,
    /// Standard deviation, m/s.
    pub left_sigma_m_per_s: f64,
    /// Yaw rate, left positive, rad/s.
    pub yaw_rate_rad_per_s: f64,
    /// Standard deviation, rad/s.
    pub yaw_rate_sigma_rad_per_s: f64,
    /// Slip that the powered wheels have in common.
    pub common_slip: f64,
    /// Standard deviation.
    pub common_slip_sigma: f64,
    /// Place by odometry with slip compensated, x, m.
    pub x_m: f64,
    /// y, m.
    pub y_m: f64,
    /// Heading by odometry, not wrapped, rad.
    pub yaw_rad: f64,
    /// Covariance of x, y and yaw, row by row.
    pub place_covariance: [f64; 9],
    /// Travel forwards, m.
    pub distance_m: f64,
    /// The same by the wheels without compensation of slip, m.
    pub distance_of_wheels_m: f64,
    /// Roll, rad.
    pub roll_rad: f64,
    /// Pitch, nose up positive, rad.
    pub pitch_rad: f64,
    /// Seconds since a trusted reference last measured the robot's speed.
    pub reference_age_s: f64,
    /// Samples refused: NaN, infinite or implausible.
    pub rejected_bad_value: u64,
    /// Samples refused: not later than the last one.
    pub rejected_not_later: u64,
    /// Samples refused: faster than the robot can move.
    pub rejected_jump: u64,
    /// Samples refused: of a wheel or an encoder that the robot does not have.
    pub rejected_unknown: u64,
    /// Samples missing, by the usual period of each sensor.
    pub dropped: u64,
    /// Steps of the clock that the filter has followed.
    pub clock_steps: u64,
}

/// What a wheel's motor driver and steering are to do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct GrouserCommand {
    /// `sizeof(GrouserCommand)`.
    pub size: u32,
    /// 0.
    pub reserved: u32,
    /// Speed of the rim, m/s.
    pub rim_speed_m_per_s: f64,
    /// Greatest torque over load and radius of the wheel, 1.
    pub traction: f64,
    /// Steering angle beside the wheel's heading, rad.
    pub steering_angle_rad: f64,
}

macro_rules! c_structs {
    ($($name:ident)*) => {
        $(
            // SAFETY: `repr(C)`, begins with `size: u32`, and holds numbers and raw pointers alone, so that every bit
            // pattern is a value.
            unsafe impl CStruct for $name {}
        )*
    };
}
c_structs!(GrouserWheel GrouserSettings GrouserSample GrouserWheelEstimate GrouserBodyEstimate GrouserCommand);
