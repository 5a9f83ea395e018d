//! What the names of topics and joints say.

use grouser_files::columns::Meaning;

use crate::message::short;

/// Words in a topic's name that say that it measures the ground, not the wheels.
const OVER_GROUND: &[&str] = &[
    "vio",
    "vo",
    "visual",
    "vision",
    "camera",
    "zed",
    "t265",
    "rtabmap",
    "slam",
    "lidar",
    "laser",
    "icp",
    "gps",
    "gnss",
    "rtk",
    "truth",
    "groundtruth",
    "mocap",
    "vicon",
    "optitrack",
    "qualisys",
    "aruco",
    "apriltag",
    "flow",
    "ground",
    "fix",
    "navsat",
    "amcl",
    "uwb",
    "leica",
    "prism",
    "totalstation",
    // a total station
    "total",
];
/// Words in the name of a pose or a point at which nothing is yet: it is a wish, or a first guess.
const UNMEASURED: &[&str] = &[
    "goal",
    "initialpose",
    "initial",
    "clicked",
    "setpoint",
    "target",
    "waypoint",
];
/// Words in the name of a pose that a filter made of the wheels, among others.
const OF_WHEELS: &[&str] = &["odom", "odometry", "ekf", "ukf"];

/// The words of a name: `/vicon/robot_1` is `vicon`, `robot`, `1`.
fn words(name: &str) -> Vec<String> {
    let words = name.split(|letter: char| !letter.is_alphanumeric());
    let words = words.filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect()
}

/// Is one of these words in a name?
pub(in crate::recording) fn has_word(name: &str, wanted: &[&str]) -> bool {
    let words = words(name);
    words.iter().any(|word| wanted.contains(&word.as_str()))
}

/// The words of a name without these.
pub(super) fn other_words(name: &str, without: &[&str]) -> Vec<String> {
    let mut words = words(name);
    words.retain(|word| !without.contains(&word.as_str()));
    words
}

pub(crate) fn is_over_ground(topic: &str) -> bool {
    has_word(topic, OVER_GROUND)
}

/// Does a topic's name say that nobody measured it: that the robot is to go there, or is guessed to be?
pub(crate) fn is_unmeasured(topic: &str) -> bool {
    has_word(topic, UNMEASURED)
}

/// Does a topic's name say that wheels have a part in it?
pub(crate) fn is_of_wheels(topic: &str) -> bool {
    !is_over_ground(topic) && has_word(topic, OF_WHEELS)
}

/// Does a topic's name say that it is a commanded speed?
pub(crate) fn is_command(topic: &str) -> bool {
    !is_over_ground(topic) && has_word(topic, &["cmd", "command"])
}

/// The meaning of a topic of one number whose name says that it is the robot's speed.
pub(crate) fn speed_of_number(topic: &str, type_name: &str) -> Option<Meaning> {
    const AROUND: &[&str] = &[
        "ground", "over", "forward", "robot", "vehicle", "linear", "measured", "data",
    ];
    const ON_EARTH: &[&str] = &["gps", "gnss", "sog"];
    let is_number = ["std_msgs/Float32", "std_msgs/Float64"].contains(&&*short(type_name));
    let rest = other_words(topic, &[AROUND, ON_EARTH].concat());
    let is_speed = match rest.as_slice() {
        [] => has_word(topic, &["sog"]),
        [word] => ["speed", "velocity", "vel"].contains(&word.as_str()),
        _ => false,
    };
    (is_number && is_speed).then_some(if has_word(topic, ON_EARTH) {
        Meaning::SpeedSize
    } else {
        Meaning::SpeedForward
    })
}

/// The joint whose name is the wheel's, the words `joint`, `wheel` and `link` aside: `front_left` is
/// `front_left_wheel_joint`. Two such joints are none.
pub(super) fn joint_by_name(wheel: &str, joints: &[&String]) -> Option<String> {
    let core = |name: &str| other_words(name, &["joint", "wheel", "link"]);
    let own = core(wheel);
    let mut alike = Vec::new();
    for joint in joints {
        if *joint == wheel {
            return Some((*joint).clone());
        }
        if !own.is_empty() && core(joint) == own {
            alike.push(joint);
        }
    }
    match alike.as_slice() {
        [one] => Some((**one).clone()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_found_by_the_wheels_names() {
        let joints = ["front_left_wheel_joint", "front_right_wheel_joint", "arm"].map(String::from);
        let found = |wheel| joint_by_name(wheel, &joints.iter().collect::<Vec<_>>());
        assert_eq!(found("front_left").unwrap(), "front_left_wheel_joint");
        assert_eq!(found("arm").unwrap(), "arm");
        assert_eq!(found("left"), None);
        assert_eq!(found("wheel"), None);
        let twice = ["left_joint", "left_wheel"].map(String::from);
        assert_eq!(
            joint_by_name("left", &twice.iter().collect::<Vec<_>>()),
            None
        );
    }

    #[test]
    fn numbers_are_speeds_by_their_names() {
        let of = |topic| speed_of_number(topic, "std_msgs/msg/Float32");
        for topic in [
            "/ground_speed",
            "/speed",
            "/robot/vel",
            "/speed_over_ground/data",
        ] {
            assert_eq!(of(topic), Some(Meaning::SpeedForward), "{topic}");
        }
        for topic in ["/gps/speed", "/sog"] {
            assert_eq!(of(topic), Some(Meaning::SpeedSize), "{topic}");
        }
        for topic in [
            "/cmd_vel",
            "/left/speed",
            "/fan_speed",
            "/ground",
            "/gps",
            "/target_speed",
            "/odom/vel",
        ] {
            assert_eq!(of(topic), None, "{topic}");
        }
        assert_eq!(speed_of_number("/speed", "std_msgs/msg/Int32"), None);
    }

    #[test]
    fn only_names_that_say_so_are_of_the_ground() {
        assert!(is_over_ground("/camera/odom/sample"));
        assert!(is_over_ground("/vicon/jackal"));
        for wheels in [
            "/odom",
            "/jackal_velocity_controller/odom",
            "/odometry/filtered",
        ] {
            assert!(!is_over_ground(wheels), "{wheels}");
        }
    }
}
