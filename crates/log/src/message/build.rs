//! Messages to be written, as fields.

use super::Value;

/// A message of these fields.
#[must_use]
pub fn message<const N: usize>(fields: [(&str, Value); N]) -> Value {
    let fields = fields.into_iter();
    Value::Struct(fields.map(|(name, value)| (name.into(), value)).collect())
}

/// An array of numbers.
#[must_use]
pub fn numbers(values: &[f64]) -> Value {
    Value::Array(values.iter().copied().map(Value::Float).collect())
}

/// An array of texts.
#[must_use]
pub fn texts<T: AsRef<str>>(values: &[T]) -> Value {
    let texts = values.iter().map(|text| Value::Text(text.as_ref().into()));
    Value::Array(texts.collect())
}

/// `std_msgs/Header`.
#[must_use]
pub fn header(time_ns: i64, frame: &str) -> Value {
    let (seconds, rest) = (
        time_ns.div_euclid(1_000_000_000),
        time_ns.rem_euclid(1_000_000_000),
    );
    message([
        (
            "stamp",
            message([("sec", Value::Int(seconds)), ("nanosec", Value::Int(rest))]),
        ),
        ("frame_id", Value::Text(frame.into())),
    ])
}

/// `geometry_msgs/Vector3` or `Point`.
#[must_use]
pub fn vector([x, y, z]: [f64; 3]) -> Value {
    message([
        ("x", Value::Float(x)),
        ("y", Value::Float(y)),
        ("z", Value::Float(z)),
    ])
}

/// `geometry_msgs/Quaternion` of a turn about z, rad.
#[must_use]
pub fn turn(yaw: f64) -> Value {
    let (sin, cos) = (0.5 * yaw).sin_cos();
    message([
        ("x", Value::Float(0.0)),
        ("y", Value::Float(0.0)),
        ("z", Value::Float(sin)),
        ("w", Value::Float(cos)),
    ])
}

/// `geometry_msgs/Twist`.
#[must_use]
pub fn twist(linear: [f64; 3], angular: [f64; 3]) -> Value {
    message([("linear", vector(linear)), ("angular", vector(angular))])
}

/// `geometry_msgs/TwistStamped`.
#[must_use]
pub fn twist_stamped(header: Value, linear: [f64; 3], angular: [f64; 3]) -> Value {
    message([("header", header), ("twist", twist(linear, angular))])
}

/// `geometry_msgs/Pose` on the ground.
#[must_use]
pub fn pose(x: f64, y: f64, yaw: f64) -> Value {
    message([
        ("position", vector([x, y, 0.0])),
        ("orientation", turn(yaw)),
    ])
}

/// `sensor_msgs/JointState`; what is not measured is empty.
#[must_use]
pub fn joint_state(
    header: Value,
    names: &[&str],
    [position, velocity, effort]: [&[f64]; 3],
) -> Value {
    message([
        ("header", header),
        ("name", texts(names)),
        ("position", numbers(position)),
        ("velocity", numbers(velocity)),
        ("effort", numbers(effort)),
    ])
}

/// `sensor_msgs/Imu` of what a robot on the ground measures in its own frame: yaw rate (rad/s), and acceleration
/// forwards and to the left (m/s²). By their covariances the orientation and what is `None` are absent, and the
/// parts beside these are not to be used.
#[must_use]
pub fn planar_imu(header: Value, yaw_rate: Option<f64>, acceleration: Option<[f64; 2]>) -> Value {
    let diagonal = |[x, y, z]: [f64; 3]| numbers(&[x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z]);
    let absent = [-1.0, 0.0, 0.0];
    let rate = yaw_rate.map(|_| [f64::MAX, f64::MAX, 0.0]);
    let force = acceleration.map(|_| [0.0, 0.0, f64::MAX]);
    let [forward, left] = acceleration.unwrap_or_default();
    message([
        ("header", header),
        ("orientation", turn(0.0)),
        ("orientation_covariance", diagonal(absent)),
        (
            "angular_velocity",
            vector([0.0, 0.0, yaw_rate.unwrap_or(0.0)]),
        ),
        (
            "angular_velocity_covariance",
            diagonal(rate.unwrap_or(absent)),
        ),
        ("linear_acceleration", vector([forward, left, 0.0])),
        (
            "linear_acceleration_covariance",
            diagonal(force.unwrap_or(absent)),
        ),
    ])
}

/// `grouser_msgs/WheelTicks`.
#[must_use]
pub fn wheel_ticks(header: Value, names: &[&str], ticks: &[u64]) -> Value {
    let ticks = ticks.iter().copied().map(Value::UInt);
    message([
        ("header", header),
        ("name", texts(names)),
        ("ticks", Value::Array(ticks.collect())),
    ])
}

/// `grouser_msgs/Displacement`.
#[must_use]
pub fn displacement(header: Value, forward: f64, left: f64, turn: Option<f64>) -> Value {
    message([
        ("header", header),
        ("forward", Value::Float(forward)),
        ("left", Value::Float(left)),
        ("turn", Value::Float(turn.unwrap_or(f64::NAN))),
    ])
}
