//! Messages to be written, as fields.

use grouser_real::Real;

use super::Value;
use super::known::CONTACT_INTERFACES;

/// A message of these fields.
///
/// ```
/// use grouser_log::message::{Value, build};
///
/// let point = build::message([("x", Value::Float(1.5)), ("name", Value::Text("left".into()))]);
/// assert_eq!(point.number_at("x"), Some(1.5));
/// assert_eq!(point.at("name").and_then(Value::text), Some("left"));
/// ```
#[must_use]
pub fn message<const N: usize>(fields: [(&str, Value); N]) -> Value {
    let fields = fields.into_iter();
    Value::Struct(fields.map(|(name, value)| (name.into(), value)).collect())
}

/// An array of numbers.
///
/// ```
/// use grouser_log::message::build;
///
/// assert_eq!(build::numbers(&[1.0, 2.0]).elements().unwrap().len(), 2);
/// ```
#[must_use]
pub fn numbers(values: &[f64]) -> Value {
    Value::Array(values.iter().copied().map(Value::Float).collect())
}

/// An array of texts.
///
/// ```
/// use grouser_log::message::build;
///
/// assert_eq!(build::texts(&["left", "right"]).elements().unwrap().len(), 2);
/// ```
#[must_use]
pub fn texts<T: AsRef<str>>(values: &[T]) -> Value {
    let texts = values.iter().map(|text| Value::Text(text.as_ref().into()));
    Value::Array(texts.collect())
}

/// `std_msgs/Header`.
///
/// ```
/// use grouser_log::message::build;
///
/// let header = build::header(1_500_000_000, "base");
/// assert_eq!(header.at("stamp").unwrap().time_ns(), Some(1_500_000_000));
/// ```
#[must_use]
pub fn header(time_ns: i64, frame: &str) -> Value {
    message([
        ("stamp", stamp(time_ns)),
        ("frame_id", Value::Text(frame.into())),
    ])
}

/// `builtin_interfaces/Time`.
///
/// ```
/// use grouser_log::message::build;
///
/// assert_eq!(build::stamp(1_500_000_000).number_at("nanosec"), Some(5e8));
/// ```
#[must_use]
pub fn stamp(time_ns: i64) -> Value {
    message([
        ("sec", Value::Int(time_ns.div_euclid(1_000_000_000))),
        ("nanosec", Value::Int(time_ns.rem_euclid(1_000_000_000))),
    ])
}

/// `geometry_msgs/Vector3` or `Point`.
///
/// ```
/// use grouser_log::message::build;
///
/// assert_eq!(build::vector([1.0, 2.0, 3.0]).number_at("z"), Some(3.0));
/// ```
#[must_use]
pub fn vector([x, y, z]: [f64; 3]) -> Value {
    message([
        ("x", Value::Float(x)),
        ("y", Value::Float(y)),
        ("z", Value::Float(z)),
    ])
}

/// `geometry_msgs/Quaternion` of a turn about z, rad.
///
/// ```
/// use grouser_log::message::build;
///
/// let half = build::turn(std::f64::consts::PI); // half a turn: z = 1, w = 0
/// assert!((half.number_at("z").unwrap() - 1.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn turn(yaw: f64) -> Value {
    let (sin, cos) = Real::sin_cos(0.5 * yaw);
    message([
        ("x", Value::Float(0.0)),
        ("y", Value::Float(0.0)),
        ("z", Value::Float(sin)),
        ("w", Value::Float(cos)),
    ])
}

/// `geometry_msgs/Quaternion` of a yaw, then a pitch, then a roll, rad.
///
/// ```
/// use grouser_log::message::build;
///
/// let half_turn = build::orientation([0.0, 0.0, std::f64::consts::PI]);
/// assert_eq!(half_turn.number_at("z"), Some(1.0));
/// ```
#[must_use]
pub fn orientation([roll, pitch, yaw]: [f64; 3]) -> Value {
    let ((s_r, c_r), (s_p, c_p), (s_y, c_y)) = (
        Real::sin_cos(0.5 * roll),
        Real::sin_cos(0.5 * pitch),
        Real::sin_cos(0.5 * yaw),
    );
    message([
        ("x", Value::Float(s_r * c_p * c_y - c_r * s_p * s_y)),
        ("y", Value::Float(c_r * s_p * c_y + s_r * c_p * s_y)),
        ("z", Value::Float(c_r * c_p * s_y - s_r * s_p * c_y)),
        ("w", Value::Float(c_r * c_p * c_y + s_r * s_p * s_y)),
    ])
}

/// `geometry_msgs/Twist`.
///
/// ```
/// use grouser_log::message::build;
///
/// let twist = build::twist([0.2, 0.0, 0.0], [0.0, 0.0, 0.5]);
/// assert_eq!(twist.number_at("angular.z"), Some(0.5));
/// ```
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
///
/// ```
/// use grouser_log::message::build;
///
/// assert_eq!(build::pose(1.0, 2.0, 0.0).number_at("position.y"), Some(2.0));
/// ```
#[must_use]
pub fn pose(x: f64, y: f64, yaw: f64) -> Value {
    message([
        ("position", vector([x, y, 0.0])),
        ("orientation", turn(yaw)),
    ])
}

/// `sensor_msgs/JointState`; what is not measured is empty.
///
/// ```
/// use grouser_log::message::{View, build};
///
/// let header = build::header(0, "base");
/// let message = build::joint_state(header, &["left"], [&[1.5], &[0.2], &[]]);
/// let Some(View::JointState(joints)) = View::new("sensor_msgs/msg/JointState", &message) else {
///     unreachable!("it has all fields of its type");
/// };
/// assert_eq!((joints.position.get(0), joints.velocity.get(0)), (Some(1.5), Some(0.2)));
/// ```
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
///
/// ```
/// use grouser_log::message::build;
///
/// let message = build::wheel_ticks(build::header(0, "base"), &["left"], &[4_000]);
/// assert_eq!(message.count_at("ticks[0]"), Some(4_000));
/// ```
#[must_use]
pub fn wheel_ticks(header: Value, names: &[&str], ticks: &[u64]) -> Value {
    let ticks = ticks.iter().copied().map(Value::UInt);
    message([
        ("header", header),
        ("name", texts(names)),
        ("ticks", Value::Array(ticks.collect())),
    ])
}

/// `control_msgs/DynamicJointState` with sinkage (m), entry angle (rad) and edge (1 or -1) of each joint, where they are
/// measured; the last ones may be left out.
#[must_use]
pub fn wheel_contacts<const N: usize>(
    header: Value,
    names: &[&str],
    contacts: &[[Option<f64>; N]],
) -> Value {
    let interfaces = contacts.iter().map(|contact| {
        let known = CONTACT_INTERFACES.iter().zip(contact);
        let measured = known.filter_map(|(name, value)| Some((*name, (*value)?)));
        let (names, values): (Vec<&str>, Vec<f64>) = measured.unzip();
        message([
            ("interface_names", texts(&names)),
            ("values", numbers(&values)),
        ])
    });
    message([
        ("header", header),
        ("joint_names", texts(names)),
        ("interface_values", Value::Array(interfaces.collect())),
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
