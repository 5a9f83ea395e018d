//! The ROS 2 messages that are written or received by a node, and the project's own types.
//!
//! Types of its own stand only where ROS has none: counters by wheel, a way since the last message, slip by
//! wheel. Every file carries their definitions, so that any reader of MCAP can decode them.

use std::collections::{BTreeMap, BTreeSet};

use crate::container::{Channel, Encoding};

/// Counters by joint.
pub const WHEEL_TICKS: &str = "grouser_msgs/WheelTicks";
/// Sinkages and entry angles, among other state interfaces by joint.
pub const JOINT_INTERFACES: &str = "control_msgs/DynamicJointState";
/// State interfaces of a wheel's joint, by kind: sinkage (m), entry angle (rad), and an edge of its encoder at the time of the
/// message (1 forwards, -1 backwards).
pub const CONTACT_INTERFACES: [&str; 3] = ["sinkage", "entry_angle", "edge"];
/// Way since the message before.
pub const DISPLACEMENT: &str = "grouser_msgs/Displacement";
/// Slip by wheel.
pub const WHEEL_SLIP: &str = "grouser_msgs/WheelSlip";
/// What is learnt of the soil.
pub const SOIL: &str = "grouser_msgs/Soil";
/// An event of a wheel or of the robot.
pub const SLIP_EVENT: &str = "grouser_msgs/SlipEvent";

/// Under this name a simulation writes what it knows and no robot measures: no topic there is ever chosen by type and
/// name.
pub const TRUTH: &str = "/simulation/truth/";

/// Topics with this in their names are what the estimator itself publishes: none is ever chosen by type and name.
pub const OUTPUT: &str = "/grouser/";

/// The messages of `std_msgs` that hold one number.
const NUMBERS: [&str; 8] = [
    "Float32", "Float64", "Int16", "Int32", "Int64", "UInt16", "UInt32", "UInt64",
];

/// Each type's own text, with the types that it holds.
const TEXTS: &[(&str, &str, &[&str])] = &[
    (
        "builtin_interfaces/Time",
        "int32 sec\nuint32 nanosec\n",
        &[],
    ),
    (
        "std_msgs/Header",
        "builtin_interfaces/Time stamp\nstring frame_id\n",
        &["builtin_interfaces/Time"],
    ),
    (
        "geometry_msgs/Vector3",
        "float64 x\nfloat64 y\nfloat64 z\n",
        &[],
    ),
    (
        "geometry_msgs/Point",
        "float64 x\nfloat64 y\nfloat64 z\n",
        &[],
    ),
    (
        "geometry_msgs/Quaternion",
        "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
        &[],
    ),
    (
        "geometry_msgs/Pose",
        "Point position\nQuaternion orientation\n",
        &["geometry_msgs/Point", "geometry_msgs/Quaternion"],
    ),
    (
        "geometry_msgs/PoseStamped",
        "std_msgs/Header header\nPose pose\n",
        &["std_msgs/Header", "geometry_msgs/Pose"],
    ),
    (
        "geometry_msgs/PoseWithCovariance",
        "Pose pose\nfloat64[36] covariance\n",
        &["geometry_msgs/Pose"],
    ),
    (
        "geometry_msgs/PoseWithCovarianceStamped",
        "std_msgs/Header header\nPoseWithCovariance pose\n",
        &["std_msgs/Header", "geometry_msgs/PoseWithCovariance"],
    ),
    (
        "geometry_msgs/PointStamped",
        "std_msgs/Header header\nPoint point\n",
        &["std_msgs/Header", "geometry_msgs/Point"],
    ),
    (
        "geometry_msgs/Twist",
        "Vector3 linear\nVector3 angular\n",
        &["geometry_msgs/Vector3"],
    ),
    (
        "geometry_msgs/TwistStamped",
        "std_msgs/Header header\nTwist twist\n",
        &["std_msgs/Header", "geometry_msgs/Twist"],
    ),
    (
        "geometry_msgs/TwistWithCovariance",
        "Twist twist\nfloat64[36] covariance\n",
        &["geometry_msgs/Twist"],
    ),
    (
        "geometry_msgs/TwistWithCovarianceStamped",
        "std_msgs/Header header\nTwistWithCovariance twist\n",
        &["std_msgs/Header", "geometry_msgs/TwistWithCovariance"],
    ),
    (
        "geometry_msgs/Transform",
        "Vector3 translation\nQuaternion rotation\n",
        &["geometry_msgs/Vector3", "geometry_msgs/Quaternion"],
    ),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\nTransform transform\n",
        &["std_msgs/Header", "geometry_msgs/Transform"],
    ),
    (
        "tf2_msgs/TFMessage",
        "geometry_msgs/TransformStamped[] transforms\n",
        &["geometry_msgs/TransformStamped"],
    ),
    (
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
        &["std_msgs/Header"],
    ),
    (
        "irobot_create_msgs/WheelTicks",
        "std_msgs/Header header\nint32 ticks_left\nint32 ticks_right\n",
        &["std_msgs/Header"],
    ),
    (
        "control_msgs/InterfaceValue",
        "string[] interface_names\nfloat64[] values\n",
        &[],
    ),
    (
        "control_msgs/DynamicJointState",
        "std_msgs/Header header\nstring[] joint_names\nInterfaceValue[] interface_values\n",
        &["std_msgs/Header", "control_msgs/InterfaceValue"],
    ),
    (
        "sensor_msgs/Imu",
        "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
         geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
         geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
        &[
            "std_msgs/Header",
            "geometry_msgs/Quaternion",
            "geometry_msgs/Vector3",
        ],
    ),
    (
        "sensor_msgs/NavSatStatus",
        "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\nint8 status\n\
         uint16 service\n",
        &[],
    ),
    (
        "sensor_msgs/NavSatFix",
        "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n\
         float64[9] position_covariance\nuint8 position_covariance_type\n",
        &["std_msgs/Header", "sensor_msgs/NavSatStatus"],
    ),
    (
        "nav_msgs/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist\n",
        &[
            "std_msgs/Header",
            "geometry_msgs/PoseWithCovariance",
            "geometry_msgs/TwistWithCovariance",
        ],
    ),
    (
        "diagnostic_msgs/KeyValue",
        "string key\nstring value\n",
        &[],
    ),
    (
        "diagnostic_msgs/DiagnosticStatus",
        "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\n\
         string hardware_id\nKeyValue[] values\n",
        &["diagnostic_msgs/KeyValue"],
    ),
    (
        "diagnostic_msgs/DiagnosticArray",
        "std_msgs/Header header\nDiagnosticStatus[] status\n",
        &["std_msgs/Header", "diagnostic_msgs/DiagnosticStatus"],
    ),
    (
        "builtin_interfaces/Duration",
        "int32 sec\nuint32 nanosec\n",
        &[],
    ),
    (
        "std_msgs/ColorRGBA",
        "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n",
        &[],
    ),
    (
        "sensor_msgs/CompressedImage",
        "std_msgs/Header header\nstring format\nuint8[] data\n",
        &["std_msgs/Header"],
    ),
    (
        "sensor_msgs/PointField",
        "uint8 UINT32=6\nuint8 FLOAT32=7\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n",
        &[],
    ),
    (
        "sensor_msgs/PointCloud2",
        "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\n\
         uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
        &["std_msgs/Header", "sensor_msgs/PointField"],
    ),
    (
        "visualization_msgs/UVCoordinate",
        "float32 u\nfloat32 v\n",
        &[],
    ),
    (
        "visualization_msgs/MeshFile",
        "string filename\nuint8[] data\n",
        &[],
    ),
    (
        "visualization_msgs/Marker",
        "int32 CUBE=1\nint32 CYLINDER=3\nint32 LINE_STRIP=4\nint32 ADD=0\nstd_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n\
         geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n\
         builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n\
         std_msgs/ColorRGBA[] colors\nstring texture_resource\nsensor_msgs/CompressedImage texture\n\
         UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\nMeshFile mesh_file\n\
         bool mesh_use_embedded_materials\n",
        &[
            "std_msgs/Header",
            "geometry_msgs/Pose",
            "geometry_msgs/Vector3",
            "std_msgs/ColorRGBA",
            "builtin_interfaces/Duration",
            "geometry_msgs/Point",
            "sensor_msgs/CompressedImage",
            "visualization_msgs/UVCoordinate",
            "visualization_msgs/MeshFile",
        ],
    ),
    (
        "std_msgs/MultiArrayDimension",
        "string label\nuint32 size\nuint32 stride\n",
        &[],
    ),
    (
        "std_msgs/MultiArrayLayout",
        "MultiArrayDimension[] dim\nuint32 data_offset\n",
        &["std_msgs/MultiArrayDimension"],
    ),
    (
        "std_msgs/Float32MultiArray",
        "MultiArrayLayout layout\nfloat32[] data\n",
        &["std_msgs/MultiArrayLayout"],
    ),
    (
        "grid_map_msgs/GridMapInfo",
        "float64 resolution\nfloat64 length_x\nfloat64 length_y\ngeometry_msgs/Pose pose\n",
        &["geometry_msgs/Pose"],
    ),
    (
        "grid_map_msgs/GridMap",
        "std_msgs/Header header\nGridMapInfo info\nstring[] layers\nstring[] basic_layers\n\
         std_msgs/Float32MultiArray[] data\nuint16 outer_start_index\nuint16 inner_start_index\n",
        &[
            "std_msgs/Header",
            "grid_map_msgs/GridMapInfo",
            "std_msgs/Float32MultiArray",
        ],
    ),
    (
        "visualization_msgs/MarkerArray",
        "visualization_msgs/Marker[] markers\n",
        &["visualization_msgs/Marker"],
    ),
    (
        WHEEL_TICKS,
        "# Tick counters of wheels, as the hardware shows them.\nstd_msgs/Header header\nstring[] name\n\
         uint64[] ticks\n",
        &["std_msgs/Header"],
    ),
    (
        DISPLACEMENT,
        "# Displacement since the message before, in the robot's frame halfway: m, m, rad (NaN: not measured).\n\
         std_msgs/Header header\nfloat64 forward\nfloat64 left\nfloat64 turn\n",
        &["std_msgs/Header"],
    ),
    (
        WHEEL_SLIP,
        "# Slip of wheels: 0 rolls freely, 1 spins on the spot, negative brakes; NaN: none worth a number.\n\
         # slip_sigma is the standard deviation of its error.\nstd_msgs/Header header\nstring[] name\n\
         float64[] slip\nfloat64[] slip_sigma\nstring[] motion\nstring[] health\n",
        &["std_msgs/Header"],
    ),
    (
        SOIL,
        "# Strength (cohesion, tan phi) and stiffness (pressure-sinkage moduli) as multiples of the known soil's, friction\n\
         # angle in rad: each as mean, lower and upper end of its 90 % interval. Readings, and changes of the belief in use.\n\
         std_msgs/Header header\nfloat64[3] strength\nfloat64[3] stiffness\nfloat64[3] friction_angle\n\
         uint32 readings\nuint32 changes\n",
        &["std_msgs/Header"],
    ),
    (
        SLIP_EVENT,
        "# HighSlip, Stall or LiftOff of a wheel; DigIn or Immobilised of the robot, whose wheel is empty.\n\
         # since: when the condition began to hold.\n\
         std_msgs/Header header\nstring event\nstring wheel\nbool begins\nbuiltin_interfaces/Time since\n",
        &["std_msgs/Header", "builtin_interfaces/Time"],
    ),
];

/// The definition of a type that is written or received, in the language `ros2msg`, with all types that it holds.
///
/// ```
/// use grouser_log::message::known;
///
/// assert!(known::definition("geometry_msgs/Twist").unwrap().contains("MSG: geometry_msgs/Vector3"));
/// assert_eq!(known::definition("geometry_msgs/Wrench"), None);
/// ```
#[must_use]
pub fn definition(type_name: &str) -> Option<String> {
    if let Some(number) = type_name.strip_prefix("std_msgs/")
        && NUMBERS.contains(&number)
    {
        return Some(format!("{} data\n", number.to_lowercase()));
    }
    let entry = |name: &str| TEXTS.iter().find(|(own, _, _)| *own == name);
    let (_, own, needs) = entry(type_name)?;
    let mut text = (*own).to_owned();
    let mut open: Vec<&str> = needs.to_vec();
    let mut done = BTreeSet::new();
    while !open.is_empty() {
        let name = open.remove(0);
        if !done.insert(name) {
            continue;
        }
        let (_, body, needs) = entry(name)?;
        text.push_str(&"=".repeat(80));
        text.push_str("\nMSG: ");
        text.push_str(name);
        text.push('\n');
        text.push_str(body);
        open.extend(needs.iter());
    }
    Some(text)
}

/// A topic of a type that is known here, as ROS 2 sends it.
///
/// ```
/// use grouser_log::message::known;
///
/// assert_eq!(known::channel("/imu", "sensor_msgs/Imu").unwrap().type_name, "sensor_msgs/msg/Imu");
/// assert!(known::channel("/camera", "sensor_msgs/Image").is_none());
/// ```
#[must_use]
pub fn channel(topic: &str, type_name: &str) -> Option<Channel> {
    Some(Channel {
        topic: topic.to_owned(),
        type_name: ros2_name(type_name),
        encoding: Encoding::Cdr,
        encoding_name: "cdr".to_owned(),
        definition_language: "ros2msg".to_owned(),
        definition: definition(type_name)?.into_bytes().into(),
        metadata: BTreeMap::new(),
    })
}

/// `package/msg/Type` of `package/Type`, as ROS 2 names types.
///
/// ```
/// assert_eq!(grouser_log::message::known::ros2_name("sensor_msgs/Imu"), "sensor_msgs/msg/Imu");
/// ```
#[must_use]
pub fn ros2_name(type_name: &str) -> String {
    type_name.replacen('/', "/msg/", 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::Definition;

    #[test]
    fn every_definition_is_whole() {
        for (name, _, _) in TEXTS {
            let text = definition(name).unwrap();
            Definition::parse(&ros2_name(name), &text).unwrap();
        }
    }
}
