//! Which types of messages have a view, and where their fields are: a further type is a row.

use super::known;

/// Where a type has what its view shows. An empty path is the message itself.
#[derive(Clone, Copy, Debug)]
pub(super) enum Layout {
    /// Arrays by joint; the last may be missing.
    Joints {
        names: &'static str,
        position: &'static str,
        velocity: &'static str,
        effort: &'static str,
    },
    /// Counters of joints in an array.
    Counters {
        names: &'static str,
        counts: &'static str,
    },
    /// Counters of joints in a field for each: the joints, and their fields.
    CounterFields(&'static [&'static str], &'static [&'static str]),
    /// State interfaces of joints, of which some are sinkages and entry angles.
    Contacts {
        names: &'static str,
        interfaces: &'static str,
    },
    /// A pose, and what holds its `covariance`, if anything does.
    Pose {
        position: &'static str,
        orientation: &'static str,
        around: &'static str,
    },
    /// A place.
    Point(&'static str),
    /// A twist, and what holds its `covariance`, if anything does.
    Twist {
        twist: &'static str,
        around: &'static str,
    },
    /// A displacement since the message before.
    Displacement {
        forward: &'static str,
        left: &'static str,
        turn: &'static str,
    },
    /// Transforms of frames.
    Transforms(&'static str),
    Odometry,
    Imu,
    NavSatFix,
}

/// Every type that has a view.
pub(super) const TYPES: &[(&str, Layout)] = &[
    (
        "sensor_msgs/JointState",
        Layout::Joints {
            names: "name",
            position: "position",
            velocity: "velocity",
            effort: "effort",
        },
    ),
    (
        known::WHEEL_TICKS,
        Layout::Counters {
            names: "name",
            counts: "ticks",
        },
    ),
    (
        "irobot_create_msgs/WheelTicks",
        Layout::CounterFields(&["left", "right"], &["ticks_left", "ticks_right"]),
    ),
    (
        known::JOINT_INTERFACES,
        Layout::Contacts {
            names: "joint_names",
            interfaces: "interface_values",
        },
    ),
    ("sensor_msgs/Imu", Layout::Imu),
    ("sensor_msgs/NavSatFix", Layout::NavSatFix),
    ("nav_msgs/Odometry", Layout::Odometry),
    (
        "geometry_msgs/PoseStamped",
        Layout::Pose {
            position: "pose.position",
            orientation: "pose.orientation",
            around: "",
        },
    ),
    (
        "geometry_msgs/PoseWithCovarianceStamped",
        Layout::Pose {
            position: "pose.pose.position",
            orientation: "pose.pose.orientation",
            around: "pose",
        },
    ),
    (
        "geometry_msgs/TransformStamped",
        Layout::Pose {
            position: "transform.translation",
            orientation: "transform.rotation",
            around: "",
        },
    ),
    ("geometry_msgs/PointStamped", Layout::Point("point")),
    (
        "geometry_msgs/Twist",
        Layout::Twist {
            twist: "",
            around: "",
        },
    ),
    (
        "geometry_msgs/TwistStamped",
        Layout::Twist {
            twist: "twist",
            around: "",
        },
    ),
    (
        "geometry_msgs/TwistWithCovarianceStamped",
        Layout::Twist {
            twist: "twist.twist",
            around: "twist",
        },
    ),
    (
        known::DISPLACEMENT,
        Layout::Displacement {
            forward: "forward",
            left: "left",
            turn: "turn",
        },
    ),
    ("tf2_msgs/TFMessage", Layout::Transforms("transforms")),
    ("tf/tfMessage", Layout::Transforms("transforms")),
];

/// The layout of a type that has a view.
pub(super) fn layout(type_name: &str) -> Option<Layout> {
    let own = TYPES.iter().find(|(name, _)| *name == type_name);
    own.map(|(_, layout)| *layout)
}
