//! The definitions and hashes of message types against those of others.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(dead_code, reason = "the peers are shared by several tests")]

mod peers;

use std::path::Path;

use grouser_live::type_hash;
use grouser_log::message::known;
use peers::{Peer, Place, python, read};
use serde_json::json;

#[test]
fn hashes_are_those_of_rosbags() {
    let Some(python) = python() else { return };
    let types = [
        "std_msgs/Header",
        "sensor_msgs/JointState",
        "sensor_msgs/Imu",
        "sensor_msgs/NavSatFix",
        "nav_msgs/Odometry",
        "geometry_msgs/Twist",
        "geometry_msgs/TwistStamped",
        "geometry_msgs/TwistWithCovarianceStamped",
        "geometry_msgs/PoseStamped",
        "geometry_msgs/PoseWithCovarianceStamped",
        "geometry_msgs/PointStamped",
        "geometry_msgs/TransformStamped",
        "diagnostic_msgs/DiagnosticArray",
        "tf2_msgs/TFMessage",
        known::WHEEL_TICKS,
        known::WHEEL_SLIP,
        known::SLIP_EVENT,
    ];
    let mut peer = Peer::start(&python, &Place::new("zenoh", "hashes"));
    let mut command = vec![json!("hashes")];
    command.extend(types.map(|name| json!(known::ros2_name(name))));
    let others = peer.call(&json!(command));
    for (index, name) in types.iter().enumerate() {
        let own = type_hash::of_known(name).unwrap();
        assert_eq!(others[index].as_str(), Some(own.as_str()), "{name}");
    }
}

#[test]
fn the_ros_package_has_the_definitions_of_the_codec() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("grouser_msgs");
    let build = read(&folder.join("CMakeLists.txt"));
    for name in [
        known::DISPLACEMENT,
        known::SLIP_EVENT,
        known::WHEEL_SLIP,
        known::WHEEL_TICKS,
    ] {
        let file = format!("msg/{}.msg", name.rsplit('/').next().unwrap());
        let text = known::definition(name).unwrap();
        let own = text.split("====").next().unwrap();
        assert_eq!(read(&folder.join(&file)), own, "{file}");
        assert!(build.contains(&file), "{file}");
    }
}
