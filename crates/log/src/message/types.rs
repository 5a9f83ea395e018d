//! Which types of messages have a view, and where their fields are: a further type is a row.

use super::known;

/// Where a type has what its view shows. An empty path is the message itself.
#[derive(Clone, Copy, Debug)]
pub(super) enum Layout {
    /// Arrays by joint: their names; position, velocity and effort, of which the last may be missing.
    Joints(&'static str, [&'static str; 3]),
    /// Arrays of joints' names and counters.
    Counters(&'static str, &'static str),
    /// A counter in a field for each joint: the joints, and their fields.
    CounterFields(&'static [&'static str], &'static [&'static str]),
    /// Joints' names, and their state interfaces, of which some are sinkages and entry angles.
    Contacts(&'static str, &'static str),
    /// Position and orientation, and what holds their `covariance`, if anything does.
    Pose([&'static str; 2], &'static str),
    /// A place.
    Point(&'static str),
    /// A twist, and what holds its `covariance`, if anything does.
    Twist(&'static str, &'static str),
    /// Forwards, to the left, turn: since the message before.
    Displacement([&'static str; 3]),
    /// Transforms of frames.
    Transforms(&'static str),
    Odometry,
    Imu,
    NavSatFix,
}

use Layout::{
    Contacts, CounterFields, Counters, Displacement, Imu, Joints, NavSatFix, Odometry, Point, Pose,
    Transforms, Twist,
};

const JOINTS: [&str; 3] = ["position", "velocity", "effort"];
const POSE: [&str; 2] = ["pose.position", "pose.orientation"];
const COVARIANT: [&str; 2] = ["pose.pose.position", "pose.pose.orientation"];
const TRANSFORM: [&str; 2] = ["transform.translation", "transform.rotation"];
const CREATE: [&str; 2] = ["ticks_left", "ticks_right"];

/// Every type that has a view.
pub(super) const TYPES: &[(&str, Layout)] = &[
    ("sensor_msgs/JointState", Joints("name", JOINTS)),
    (known::WHEEL_TICKS, Counters("name", "ticks")),
    (
        "irobot_create_msgs/WheelTicks",
        CounterFields(&["left", "right"], &CREATE),
    ),
    (
        known::JOINT_INTERFACES,
        Contacts("joint_names", "interface_values"),
    ),
    ("sensor_msgs/Imu", Imu),
    ("sensor_msgs/NavSatFix", NavSatFix),
    ("nav_msgs/Odometry", Odometry),
    ("geometry_msgs/PoseStamped", Pose(POSE, "")),
    (
        "geometry_msgs/PoseWithCovarianceStamped",
        Pose(COVARIANT, "pose"),
    ),
    ("geometry_msgs/TransformStamped", Pose(TRANSFORM, "")),
    ("geometry_msgs/PointStamped", Point("point")),
    ("geometry_msgs/Twist", Twist("", "")),
    ("geometry_msgs/TwistStamped", Twist("twist", "")),
    (
        "geometry_msgs/TwistWithCovarianceStamped",
        Twist("twist.twist", "twist"),
    ),
    (
        known::DISPLACEMENT,
        Displacement(["forward", "left", "turn"]),
    ),
    ("tf2_msgs/TFMessage", Transforms("transforms")),
    ("tf/tfMessage", Transforms("transforms")),
];

/// The layout of a type that has a view.
pub(super) fn layout(type_name: &str) -> Option<Layout> {
    let own = TYPES.iter().find(|(name, _)| *name == type_name);
    own.map(|(_, layout)| *layout)
}
