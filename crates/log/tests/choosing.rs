//! Which topics are chosen by type and name, what the robot file decides, and what is noted.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Cursor;
use std::time::Duration;

use grouser_files::columns::{self, ColumnMap, Meaning};
use grouser_files::topics::Topics;
use grouser_files::{Document, robot};
use grouser_log::container::{Channel, Encoding};
use grouser_log::message::{Definition, Value, build, known};
use grouser_log::write::McapWriter;
use grouser_log::{Error, Intake, Log, Measures, Preview};
use grouser_slip::{Measurement as M, Sample};

use crate::written::mcap;

type Message = (&'static str, &'static str, i64, Value);

const TWIST: &str = "geometry_msgs/Twist";
const IMU: &str = "sensor_msgs/Imu";
const JOINTS: &str = "sensor_msgs/JointState";
const ODOMETRY: &str = "nav_msgs/Odometry";

/// The topics of a robot file with two wheels.
pub(crate) fn topics(text: &str) -> Topics {
    let wheels = "[[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
                  [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";
    let text = format!("format = 1\nname = \"cart\"\n[topics]\n{text}\n{wheels}");
    robot::parse(&Document::from_text("robot.toml", text).unwrap())
        .unwrap()
        .topics
}

fn file(messages: &[Message]) -> Vec<u8> {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let mut known: Vec<(&str, _)> = Vec::new();
    for (name, kind, time_ns, value) in messages {
        let place = known
            .iter()
            .position(|(own, _)| own == name)
            .unwrap_or_else(|| {
                known.push((name, writer.topic(name, kind).unwrap()));
                known.len() - 1
            });
        writer.send(&mut known[place].1, *time_ns, value).unwrap();
    }
    writer.finish().unwrap()
}

fn over(bytes: Vec<u8>, wanted: &str) -> Result<Log, Error> {
    Log::over(
        "log.mcap".as_ref(),
        Cursor::new(bytes),
        None,
        &topics(wanted),
    )
}

fn log(messages: &[Message], wanted: &str) -> Log {
    over(file(messages), wanted).unwrap()
}

/// Each topic that is used, and what for.
fn used(log: &Log) -> Vec<String> {
    log.topics()
        .map(|topic| format!("{}: {}", topic.topic, topic.used_for))
        .collect()
}

fn chosen(messages: &[Message], wanted: &str) -> Vec<String> {
    used(&log(messages, wanted))
}

fn readings(log: &Log) -> Vec<M> {
    log.samples(&[])
        .unwrap()
        .map(|sample| sample.unwrap().measurement)
        .collect()
}

/// The places of a log, which have no heading, and the other readings.
fn positions_and_ways(log: &Log) -> (Vec<[f64; 2]>, Vec<M>) {
    let mut ways = readings(log);
    let mut positions = Vec::new();
    ways.retain(|one| match *one {
        M::Position { x, y } => {
            positions.push([x, y]);
            false
        }
        _ => true,
    });
    (positions, ways)
}

fn twist(name: &'static str) -> Message {
    (name, TWIST, 5, build::twist([0.3, 0.4, 0.0], [0.0; 3]))
}

fn odometry(name: &'static str, variance: f64) -> Message {
    let covariance = || build::numbers(&[variance; 36]);
    let pose = build::message([
        ("pose", build::pose(1.0, 2.0, 0.0)),
        ("covariance", covariance()),
    ]);
    let twist = build::twist([0.7, 0.1, 0.0], [0.0, 0.0, 0.2]);
    let twist = build::message([("twist", twist), ("covariance", covariance())]);
    let value = build::message([
        ("header", build::header(5, "odom")),
        ("child_frame_id", Value::Text("base_link".into())),
        ("pose", pose),
        ("twist", twist),
    ]);
    (name, ODOMETRY, 5, value)
}

fn pose(name: &'static str) -> Message {
    let value = build::message([
        ("header", build::header(5, "map")),
        ("pose", build::pose(1.0, 2.0, 0.0)),
    ]);
    (name, "geometry_msgs/PoseStamped", 5, value)
}

fn way(name: &'static str) -> Message {
    (
        name,
        known::DISPLACEMENT,
        5,
        build::displacement(build::header(5, ""), 0.1, 0.2, None),
    )
}

pub(crate) fn fix(name: &'static str, variance: f64) -> Message {
    let mut covariance = [0.0; 9];
    (covariance[0], covariance[4]) = (variance, variance);
    let status = build::message([("status", Value::Int(2)), ("service", Value::UInt(1))]);
    let value = build::message([
        ("header", build::header(5, "gps")),
        ("status", status),
        ("latitude", Value::Float(45.0)),
        ("longitude", Value::Float(9.0)),
        ("altitude", Value::Float(0.0)),
        ("position_covariance", build::numbers(&covariance)),
        ("position_covariance_type", Value::UInt(2)),
    ]);
    (name, "sensor_msgs/NavSatFix", 5, value)
}

fn imu(name: &'static str, acceleration: [f64; 3], variances: [f64; 3]) -> Message {
    let mut covariance = [0.0; 9];
    (covariance[0], covariance[4], covariance[8]) = (variances[0], variances[1], variances[2]);
    let value = build::message([
        ("header", build::header(5, "imu_link")),
        ("orientation", build::turn(0.0)),
        ("orientation_covariance", build::numbers(&[0.0; 9])),
        ("angular_velocity", build::vector([0.1, 0.2, 0.3])),
        ("angular_velocity_covariance", build::numbers(&covariance)),
        ("linear_acceleration", build::vector(acceleration)),
        ("linear_acceleration_covariance", build::numbers(&[0.0; 9])),
    ]);
    (name, IMU, 5, value)
}

const FLAT: [f64; 3] = [0.0, 0.0, 9.8];

fn joints(name: &'static str, joints: &[&str]) -> Message {
    let rates = vec![0.5; joints.len()];
    (
        name,
        JOINTS,
        5,
        build::joint_state(build::header(5, ""), joints, [&[], &rates, &[]]),
    )
}

/// A transform from a frame to the robot's base.
fn transform(parent: &str, child: &str, rotation: [f64; 4]) -> Message {
    let [x, y, z, w] = rotation.map(Value::Float);
    let rotation = build::message([("x", x), ("y", y), ("z", z), ("w", w)]);
    let parts = [
        ("translation", build::vector([0.0; 3])),
        ("rotation", rotation),
    ];
    let value = build::message([
        ("header", build::header(1, parent)),
        ("child_frame_id", Value::Text(child.into())),
        ("transform", build::message(parts)),
    ]);
    let value = build::message([("transforms", Value::Array(vec![value]))]);
    ("/tf_static", "tf2_msgs/TFMessage", 1, value)
}

#[test]
fn what_the_robot_file_names_must_fit() {
    let all = [
        odometry("/odom", 0.0),
        pose("/p"),
        twist("/t"),
        fix("/f", 1e-4),
        imu("/imu", FLAT, [0.0; 3]),
    ];
    for (wanted, expected) in [
        ("pose = \"/odom\"", Some("/odom: pose")),
        ("pose = \"/p\"", Some("/p: pose")),
        ("pose = \"/t\"", None),
        ("speed = \"/odom\"", Some("/odom: speed over ground")),
        ("speed = \"/t\"", Some("/t: speed over ground")),
        ("speed = \"/p\"", None),
        ("fix = \"/f\"", Some("/f: displacement between fixes")),
        ("fix = \"/p\"", None),
        ("command = \"/t\"", Some("/t: commanded speed")),
        ("command = \"/p\"", None),
        ("yaw_rate = \"/p\"", None),
        (
            "wheel_odometry = \"/p\"\nwheel_odometry_track_m = 0.5",
            None,
        ),
        ("contact = \"/p\"", None),
    ] {
        match (over(file(&all), wanted), expected) {
            (Ok(log), Some(expected)) => assert!(
                used(&log).contains(&expected.to_owned()),
                "{wanted}: {:?}",
                used(&log)
            ),
            (Err(error), None) => assert!(
                matches!(error, Error::UnfitTopic { .. }),
                "{wanted}: {error}"
            ),
            (found, _) => panic!("{wanted}: {found:?}"),
        }
    }
    let error = over(file(&all), "pose = \"/q\"").unwrap_err().to_string();
    assert!(
        error.starts_with("log.mcap: there are no messages of topic `/q`"),
        "{error}"
    );
}

#[test]
fn names_and_types_decide_the_rest() {
    let pose_and_speed = "/zed/odom: pose, speed over ground";
    for (messages, expected) in [
        (vec![odometry("/zed/odom", 0.0)], vec![pose_and_speed]),
        (vec![odometry("/odom", 0.0)], vec![]),
        (vec![pose("/goal_pose")], vec![]),
        (
            vec![pose("/goal_pose"), pose("/pose"), pose("/other")],
            vec!["/pose: pose"],
        ),
        (vec![way("/way"), way("/other")], vec!["/way: displacement"]),
        // fixes where nothing else measures the place
        (
            vec![fix("/fix", 1e-4), fix("/other", 1e-4)],
            vec!["/fix: displacement between fixes"],
        ),
        (vec![fix("/fix", 1e-4), pose("/pose")], vec!["/pose: pose"]),
        (
            vec![fix("/fix", 1e-4), way("/way")],
            vec!["/way: displacement"],
        ),
        (
            vec![twist("/vicon/twist")],
            vec!["/vicon/twist: speed over ground"],
        ),
        (
            vec![twist("/gps/vel")],
            vec!["/gps/vel: size of the speed over ground, to the east and north"],
        ),
        (
            vec![odometry("/gps/odom", 0.0)],
            vec!["/gps/odom: pose, speed over ground"],
        ),
        // over ground, and commanded, is neither
        (vec![twist("/vicon/cmd")], vec![]),
        (vec![twist("/speed")], vec![]),
        (
            vec![twist("/cmd_vel"), twist("/cmd_other")],
            vec!["/cmd_vel: commanded speed"],
        ),
        (vec![odometry("/cmd", 0.0)], vec![]),
        // truth, and what the estimator publishes
        (
            vec![pose("/simulation/truth/pose"), twist("/grouser/cmd_vel")],
            vec![],
        ),
    ] {
        assert_eq!(chosen(&messages, ""), expected);
    }
    assert_eq!(
        chosen(&[pose("/pose"), pose("/other")], "ignore = [\"/pose\"]"),
        ["/other: pose"]
    );
    // what is named for a use has no other
    assert_eq!(
        chosen(&[twist("/cmd_vel")], "speed = \"/cmd_vel\""),
        ["/cmd_vel: speed over ground"]
    );
    // notes on odometry that is not used, and on that alone
    let notes = |messages: &[Message], wanted: &str| log(messages, wanted).notes().join("\n");
    assert!(notes(&[odometry("/odom", 0.0)], "").contains("`/odom` is not used"));
    for (messages, wanted) in [
        (vec![odometry("/zed/odom", 0.0)], ""),
        (vec![odometry("/odom", 0.0)], "ignore = [\"/odom\"]"),
        (vec![odometry("/odom", 0.0)], "pose = \"/odom\""),
        (vec![pose("/pose")], ""),
    ] {
        assert_eq!(notes(&messages, wanted), "");
    }
}

#[test]
fn an_antenna_beside_the_origin_needs_a_gyro() {
    let says = |messages: &[Message], wanted: &str| {
        log(messages, wanted)
            .notes()
            .iter()
            .any(|note| note.contains("the antenna is not above"))
    };
    let antenna = "antenna_x_m = 0.5";
    let (fix, imu) = (fix("/fix", 1e-4), imu("/imu", FLAT, [0.0; 3]));
    assert!(says(std::slice::from_ref(&fix), antenna));
    assert!(!says(std::slice::from_ref(&fix), ""));
    assert!(!says(&[fix, imu], antenna));
}

#[test]
fn an_antenna_beside_a_pose_is_refused() {
    let refused = over(file(&[pose("/pose")]), "antenna_x_m = 0.5").unwrap_err();
    assert!(matches!(refused, Error::NoPlaces { .. }), "{refused}");
    assert!(refused.hint().unwrap().contains("reference_x_m"));
}

#[test]
fn wheels_are_measured_by_the_topic_with_the_most_of_them() {
    let (one, two, same) = (
        joints("/one", &["left"]),
        joints("/two", &["left", "right"]),
        joints("/same", &["left", "right"]),
    );
    let ticks = build::wheel_ticks(build::header(5, ""), &["left"], &[7]);
    let ticks = ("/ticks", known::WHEEL_TICKS, 5, ticks);
    assert_eq!(
        chosen(&[one.clone(), two.clone()], ""),
        ["/two: wheels by 2 joints"]
    );
    assert_eq!(
        chosen(&[two.clone(), one.clone()], ""),
        ["/two: wheels by 2 joints"]
    );
    assert_eq!(
        chosen(&[two.clone(), same], ""),
        ["/two: wheels by 2 joints"]
    );
    let both = log(&[two.clone(), ticks.clone()], "");
    assert_eq!(
        used(&both),
        ["/ticks: wheels by 1 joints", "/two: wheels by 2 joints"]
    );
    let measured = [
        (Meaning::WheelCount, "left"),
        (Meaning::WheelRate, "left"),
        (Meaning::WheelCount, "right"),
        (Meaning::WheelAngle, "left"),
    ];
    assert_eq!(
        measured.map(|(meaning, wheel)| both.measures_wheel(meaning, wheel)),
        [true, true, false, false]
    );
    // what the fields of a message measure is not measured twice
    let field = |meaning: &str, unit: &str| {
        format!(
            "[[topics.field]]\ntopic = \"/ticks\"\nfield = \"ticks[0]\"\nmeaning = \"{meaning}\"\nwheel = \"left\"\nunit = \"{unit}\"\n"
        )
    };
    let all = [two, ticks, imu("/imu", FLAT, [0.0; 3])];
    let counted = log(&all, &field("wheel_count", "tick"));
    assert_eq!(
        used(&counted),
        [
            "/ticks: fields",
            "/imu: yaw rate about its z axis (by gravity)"
        ]
    );
    assert_eq!(counted.wheels(), ["left", "right"]);
    assert!(
        counted.measures_wheel(Meaning::WheelCount, "left")
            && !counted.measures_wheel(Meaning::WheelCount, "right")
    );
    for (meaning, unit) in [
        ("wheel_torque", "N m"),
        ("motor_current", "A"),
        ("sinkage", "m"),
        ("entry_angle", "rad"),
        ("wheel_steering", "rad"),
    ] {
        assert_eq!(
            chosen(&all, &field(meaning, unit))[1],
            "/two: wheels by 2 joints",
            "{meaning}"
        );
    }
    let turning = "[[topics.field]]\ntopic = \"/ticks\"\nfield = \"ticks[0]\"\nmeaning = \"yaw_rate\"\nunit = \"rad/s\"\n";
    assert_eq!(
        chosen(&all, turning),
        ["/ticks: fields", "/two: wheels by 2 joints"]
    );
    let odometry = odometry("/odom", 0.0);
    let by_odometry = log(
        &[odometry],
        "wheel_odometry = \"/odom\"\nwheel_odometry_track_m = 0.5",
    );
    let rates =
        ["left", "right"].map(|wheel| by_odometry.measures_wheel(Meaning::WheelRate, wheel));
    assert_eq!((rates, by_odometry.wheels().len()), ([true; 2], 2));
    let [
        M::WheelRate {
            wheel: 0,
            rate: left,
        },
        M::WheelRate {
            wheel: 1,
            rate: right,
        },
    ] = readings(&by_odometry)[..]
    else {
        panic!("two rates")
    };
    // v ∓ Ω t/2 over the radius
    assert!((left - 6.5).abs() < 1e-12 && (right - 7.5).abs() < 1e-12);
}

#[test]
fn a_filtered_inertial_unit_is_taken_before_a_raw_one() {
    let (raw, plain, third) = (
        imu("/imu/data_raw", FLAT, [0.0; 3]),
        imu("/imu/data", FLAT, [0.0; 3]),
        imu("/imu/more", FLAT, [0.0; 3]),
    );
    let expected = ["/imu/data: yaw rate about its z axis (by gravity)"];
    assert_eq!(
        chosen(&[raw.clone(), plain.clone(), third.clone()], ""),
        expected
    );
    assert_eq!(chosen(&[plain, raw, third], ""), expected);
}

#[test]
fn the_mounting_is_told_and_its_contradictions_noted() {
    let half = 0.5_f64.sqrt();
    let level = transform("base_link", "imu_link", [0.0, 0.0, 0.0, 1.0]);
    let upside_down = transform("base_link", "imu_link", [1.0, 0.0, 0.0, 0.0]);
    let tilted = transform("base_link", "imu_link", [half, 0.0, 0.0, half]);
    let unit = |acceleration| imu("/imu", acceleration, [0.0; 3]);
    let told = |messages: &[Message], wanted: &str| {
        let log = log(messages, wanted);
        (
            used(&log).pop().unwrap(),
            log.notes().join("\n"),
            log.measures(Meaning::AccelerationForward),
        )
    };
    let (words, notes, accelerates) = told(&[level.clone(), unit(FLAT)], "");
    assert_eq!(
        (words.as_str(), notes.as_str(), accelerates),
        (
            "/imu: yaw rate about its z axis (by its transforms), acceleration",
            "",
            true
        )
    );
    let (words, notes, accelerates) = told(&[upside_down, unit([0.0, 0.0, -9.8])], "");
    assert_eq!(
        (words.as_str(), notes.as_str(), accelerates),
        (
            "/imu: yaw rate about its -z axis (by its transforms), acceleration",
            "",
            true
        )
    );
    // gravity is believed; the axes forwards are not
    let (words, notes, accelerates) = told(&[tilted.clone(), unit(FLAT)], "");
    assert_eq!(
        (words.as_str(), accelerates),
        ("/imu: yaw rate about its z axis (by gravity)", false)
    );
    assert!(
        notes.contains("say that y axis points up, but gravity says z axis"),
        "{notes}"
    );
    // no accelerometer: transforms alone; then nothing, or the one rate that may be used
    let (words, _, accelerates) = told(&[tilted, unit([0.0; 3])], "");
    assert_eq!(
        (words.as_str(), accelerates),
        ("/imu: yaw rate about its y axis (by its transforms)", false)
    );
    let (words, notes, _) = told(&[unit([0.0; 3])], "");
    assert_eq!(words, "/imu: yaw rate about its z axis (taken to point up)");
    assert!(notes.contains("neither transforms nor gravity"), "{notes}");
    let max = f64::MAX;
    let (words, ..) = told(&[imu("/imu", [0.0; 3], [max, 0.0, max])], "");
    assert_eq!(
        words,
        "/imu: yaw rate about its y axis (the only one to be used)"
    );
    let (words, ..) = told(&[unit([0.0, 6.0, 8.0])], "");
    assert_eq!(
        words,
        "/imu: yaw rate about its direction (0.000, 0.600, 0.800) (by gravity)"
    );
    let (words, ..) = told(&[unit(FLAT)], "imu_up = \"-x\"");
    assert_eq!(
        words,
        "/imu: yaw rate about its -x axis (by the robot file)"
    );
    // why accelerations are not used: without any transform, of another frame, of this frame that leads nowhere
    let other = transform("base_link", "camera", [0.0, 0.0, 0.0, 1.0]);
    let nowhere = transform("mast", "imu_link", [0.0, 0.0, 0.0, 1.0]);
    for (messages, is_lost) in [
        (vec![unit(FLAT)], false),
        (vec![other, unit(FLAT)], true),
        (vec![nowhere, unit(FLAT)], false),
    ] {
        let (_, notes, accelerates) = told(&messages, "");
        assert!(
            !accelerates && notes.contains("no transforms give its forward axis"),
            "{notes}"
        );
        assert_eq!(
            notes.contains("no transform holds its frame `imu_link`"),
            is_lost,
            "{notes}"
        );
    }
    let (_, notes, _) = told(&[unit(FLAT)], "imu_up = \"z\"\nimu_forward = \"x\"");
    assert_eq!(notes, "");
    // the one rate that is needed may not be used
    let refused = log(&[imu("/imu", FLAT, [0.0, 0.0, max])], "");
    assert!(used(&refused).is_empty() && refused.notes()[0].contains("is not to be used"));
    assert!(!used(&log(&[imu("/imu", FLAT, [max, max, 0.0])], "")).is_empty());
}

/// An IMU's message with variances of its acceleration.
fn accelerometer(acceleration: [f64; 3], variances: [f64; 3]) -> Message {
    let (name, kind, time, mut value) = imu("/imu", acceleration, [0.0; 3]);
    let mut covariance = [0.0; 9];
    (covariance[0], covariance[4], covariance[8]) = (variances[0], variances[1], variances[2]);
    let Value::Struct(fields) = &mut value else {
        panic!("a message has fields")
    };
    fields.last_mut().unwrap().1 = build::numbers(&covariance);
    (name, kind, time, value)
}

#[test]
fn topics_of_another_robot_are_not_taken() {
    let wheels = ["left", "right"];
    // those of /r0 come first, and would be taken
    let messages = [
        joints("/fleet/r1/joint_states", &wheels),
        joints("/fleet/r0/joint_states", &wheels),
        imu("/fleet/r0/imu/data", FLAT, [0.0; 3]),
        pose("/fleet/r0/slam/pose"),
        imu("/fleet/r1/imu/data", FLAT, [0.0; 3]),
        pose("/fleet/r1/slam/pose"),
    ];
    let of_r1 = log(&messages, "");
    let topics: Vec<String> = of_r1.topics().map(|topic| topic.topic).collect();
    assert_eq!(
        topics,
        [
            "/fleet/r1/joint_states",
            "/fleet/r1/imu/data",
            "/fleet/r1/slam/pose"
        ]
    );
    let notes = of_r1.notes().join("\n");
    assert!(
        notes.contains("`/fleet/r0/joint_states`") && notes.contains("what is under `/fleet/r0/`"),
        "{notes}"
    );
    // what the file names is taken
    let named = log(&messages, "wheels = \"/fleet/r0/joint_states\"\n");
    assert!(
        named
            .topics()
            .all(|topic| topic.topic.starts_with("/fleet/r0/"))
    );
    let mixed = log(&messages, "pose = \"/fleet/r0/slam/pose\"\n");
    assert_eq!(mixed.topics().count(), 3);
    assert!(
        mixed
            .topics()
            .any(|topic| topic.topic == "/fleet/r0/slam/pose")
    );
    // names that differ in their last part alone are no namespaces, nor are topics of other joints
    let messages = [
        joints("/joint_states", &wheels),
        joints("/joint_states_raw", &wheels),
        joints("/arm/joint_states", &["left"]),
        pose("/arm/pose"),
    ];
    let log = log(&messages, "");
    assert!(log.topics().any(|topic| topic.topic == "/arm/pose"));
    assert!(
        log.notes()
            .iter()
            .all(|note| !note.contains("another robot"))
    );
}

#[test]
fn of_several_inertial_units_that_of_the_robot_counts() {
    let wheels = ["left", "right"];
    let still = |name| imu(name, FLAT, [0.0; 3]);
    let of = |messages: &[Message], wanted: &str| {
        let found = log(messages, wanted);
        let topic = found
            .topics()
            .find(|topic| topic.used_for.contains("yaw rate"));
        (topic.unwrap().topic, found.notes().join("\n"))
    };
    // in the namespace of the wheels, though another comes first
    let robots = [
        joints("/r1/joint_states", &wheels),
        still("/r0/imu/data"),
        still("/r1/imu/data_raw"),
        still("/r1/imu/data"),
    ];
    let (topic, notes) = of(&robots, "");
    assert_eq!(topic, "/r1/imu/data");
    assert!(
        notes.contains("is that of `/r1/imu/data`, not of `/r0/imu/data`: `yaw_rate`"),
        "{notes}"
    );
    let (topic, notes) = of(&robots, "yaw_rate = \"/r0/imu/data\"\n");
    assert!(
        topic == "/r0/imu/data" && !notes.contains("not of"),
        "{notes}"
    );
    // no namespace says which: the first, with a note
    let (topic, notes) = of(
        &[
            joints("/joint_states", &wheels),
            still("/camera/imu"),
            still("/imu"),
        ],
        "",
    );
    assert_eq!(topic, "/camera/imu");
    assert!(notes.contains("not of `/imu`"), "{notes}");
    // before and after a filter it is one sensor
    let (topic, notes) = of(
        &[
            joints("/joint_states", &wheels),
            still("/imu/data_raw"),
            still("/imu/data"),
        ],
        "",
    );
    assert!(topic == "/imu/data" && !notes.contains("not of"), "{notes}");
}

/// Messages of JSON, one of each topic.
fn json_topics(topics: &[(&str, &str, &str)]) -> Vec<u8> {
    let mut file = mcap::MAGIC.to_vec();
    for (id, (topic, type_name, text)) in (1..).zip(topics) {
        mcap::schema(&mut file, id, type_name.as_bytes(), b"");
        mcap::channel(&mut file, id, id, topic.as_bytes(), b"json");
        mcap::message(&mut file, id, u64::from(id), text.as_bytes());
    }
    file
}

#[test]
fn a_speed_that_is_a_number_is_named_with_what_reads_it() {
    let wheels = (
        "/joint_states",
        "sensor_msgs/JointState",
        "{\"name\":[\"left\",\"right\"],\"position\":[],\"velocity\":[0.5,0.5]}",
    );
    let number = |topic| (topic, "std_msgs/Float32", "{\"data\":0.25}");
    let all = json_topics(&[wheels, number("/ground_speed"), number("/fan_speed")]);
    let notes = over(all.clone(), "").unwrap().notes().join("\n");
    assert!(
        notes.contains("`/ground_speed` is not used") && !notes.contains("fan"),
        "{notes}"
    );
    // the keys that it names read it
    let keys: Vec<&str> = notes
        .split('`')
        .filter(|part| part.contains(" = "))
        .collect();
    let wanted = format!("[[topics.field]]\n{}\n", keys.join("\n"));
    let read = over(all, &wanted).unwrap();
    let speed = M::Speed {
        forward: 0.25,
        left: None,
    };
    assert!(readings(&read).contains(&speed));
    assert!(!read.notes().join("\n").contains("ground_speed"));
    // where a speed is measured there is nothing to say
    let twist =
        "{\"twist\":{\"linear\":{\"x\":1,\"y\":0,\"z\":0},\"angular\":{\"x\":0,\"y\":0,\"z\":0}}}";
    let measured = ("/vo/twist", "geometry_msgs/TwistStamped", twist);
    let both = over(
        json_topics(&[wheels, number("/ground_speed"), measured]),
        "",
    )
    .unwrap();
    assert!(
        both.measures(Meaning::SpeedForward) && !both.notes().join("\n").contains("ground_speed")
    );
}

#[test]
fn accelerations_need_their_axes() {
    let max = f64::MAX;
    let wanted = "imu_up = \"z\"\nimu_forward = \"x\"";
    for (acceleration, variances, is_used) in [
        (FLAT, [0.0; 3], true),
        (FLAT, [max, 0.0, 0.0], false),
        (FLAT, [0.0, max, 0.0], false),
        // one that measures the plane alone feels no gravity
        ([0.1, 0.2, 0.0], [0.0, 0.0, max], true),
        ([0.1, 0.2, 0.0], [0.0; 3], false),
        ([0.0, 9.8, 0.0], [0.0; 3], false),
        (FLAT, [-1.0, 0.0, 0.0], false),
    ] {
        let found = log(&[accelerometer(acceleration, variances)], wanted);
        assert!(found.measures(Meaning::YawRate));
        assert_eq!(
            found.measures(Meaning::AccelerationForward),
            is_used,
            "{acceleration:?} {variances:?}"
        );
    }
}

#[test]
fn stamps_ten_seconds_apart_are_of_one_clock() {
    for (ahead, is_noted) in [(10_000_000_000, false), (10_000_000_001, true)] {
        let mut shifted = joints("/joints", &["left"]);
        shifted.3 = build::joint_state(build::header(ahead + 5, ""), &["left"], [&[], &[0.5], &[]]);
        let found = log(&[shifted, imu("/imu", FLAT, [0.0; 3])], "");
        assert_eq!(
            found
                .notes()
                .iter()
                .any(|note| note.contains("differ by 10 s")),
            is_noted,
            "{:?}",
            found.notes()
        );
    }
    // whenever they were recorded
    let mut later = imu("/imu", FLAT, [0.0; 3]);
    later.2 = 30_000_000_000;
    later.3 = build::planar_imu(build::header(30_000_000_000, "imu_link"), Some(0.1), None);
    let found = log(&[joints("/joints", &["left"]), later], "");
    assert!(
        !found.notes().iter().any(|note| note.contains("s apart")),
        "{:?}",
        found.notes()
    );
}

#[test]
fn the_speed_of_an_odometry_needs_its_variance() {
    assert_eq!(
        readings(&log(&[odometry("/odom", 0.01)], "speed = \"/odom\"")),
        [M::Speed {
            forward: 0.7,
            left: Some(0.1)
        }]
    );
    assert_eq!(
        readings(&log(&[odometry("/odom", f64::MAX)], "speed = \"/odom\"")),
        []
    );
}

/// Messages of JSON on one topic of that type.
fn json(type_name: &str, texts: &[&str]) -> Vec<u8> {
    let mut file = mcap::MAGIC.to_vec();
    mcap::schema(&mut file, 1, type_name.as_bytes(), b"");
    mcap::channel(&mut file, 1, 1, b"/cmd", b"json");
    for (time, text) in (1..).zip(texts) {
        mcap::message(&mut file, 1, time, text.as_bytes());
    }
    file
}

#[test]
fn fields_of_messages_of_no_known_type() {
    let field = |name: &str| {
        format!(
            "[[topics.field]]\ntopic = \"/cmd\"\nfield = \"{name}\"\nmeaning = \"wheel_count\"\nwheel = \"left\"\nunit = \"tick\"\n"
        )
    };
    let texts = [
        "{\"n\":5.0}",
        "{\"n\":-2.0}",
        "{\"n\":5.5}",
        "{\"n\":9007199254740992.0}",
        "{\"n\":7}",
    ];
    let found = readings(&over(json("demo/Ticks", &texts), &field("n")).unwrap());
    let counts = [5_i64, -2, 7].map(|n| M::WheelCount {
        wheel: 0,
        raw: n.cast_unsigned(),
    });
    assert_eq!(found, counts);
    let error = over(json("demo/Ticks", &texts), &field("m")).unwrap_err();
    assert!(matches!(error, Error::NoField { .. }), "{error}");
    // the first message that has a view counts
    let twist = "{\"linear\":{\"x\":1,\"y\":0,\"z\":0},\"angular\":{\"x\":0,\"y\":0,\"z\":0}}";
    let found = over(json(TWIST, &["{}", twist]), "").unwrap();
    assert_eq!(used(&found), ["/cmd: commanded speed"]);
    assert_eq!(
        readings(&found),
        [M::Command {
            forward: 1.0,
            left: 0.0
        }]
    );
    // and the first of those
    let max = f64::MAX;
    let units = [imu("/imu", FLAT, [0.0; 3]), imu("/imu", FLAT, [max; 3])];
    assert!(log(&units, "").measures(Meaning::YawRate));
}

#[test]
fn what_is_left_out_is_that_of_one_reading() {
    let mut bytes = json("demo/Ticks", &["{\"n\":5}", "{", "{"]);
    mcap::record(&mut bytes, 5, &[1, 0, 0]);
    let field = "[[topics.field]]\ntopic = \"/cmd\"\nfield = \"n\"\nmeaning = \"wheel_count\"\nwheel = \"left\"\nunit = \"tick\"\n";
    let found = over(bytes, field).unwrap();
    for _ in 0..2 {
        found.samples(&[]).unwrap().for_each(drop);
        let left_out = found.left_out();
        // and the end that is missing
        assert_eq!(
            (left_out.undecoded, left_out.damages, left_out.bytes_lost),
            (2, 2, 12)
        );
    }
}

fn channel(topic: &str, type_name: &str) -> Channel {
    known::channel(topic, type_name).unwrap()
}

fn encoded(type_name: &str, value: &Value) -> Vec<u8> {
    let text = known::definition(type_name).unwrap();
    Definition::parse(type_name, &text)
        .unwrap()
        .encode(value)
        .unwrap()
}

/// An intake of one topic of rates of the left wheel, and its number there.
fn intake() -> (Intake, Option<usize>) {
    let mut preview = Preview::new(&topics(""));
    let joints_channel = channel("/joints", JOINTS);
    let number = preview.channel(&joints_channel);
    preview.push(number, &rate(5), 5);
    let mut intake = preview.into_intake().unwrap();
    let number = intake.channel(&joints_channel);
    (intake, number)
}

/// A message with the rate of the left wheel, stamped with this time, ns.
fn rate(time_ns: i64) -> Vec<u8> {
    let value = build::joint_state(build::header(time_ns, ""), &["left"], [&[], &[0.5], &[]]);
    encoded(JOINTS, &value)
}

fn times(intake: &mut Intake) -> Vec<i64> {
    std::iter::from_fn(|| intake.pop_held())
        .map(|sample: Sample| sample.time_ns)
        .collect()
}

#[test]
fn a_live_source_says_what_it_measures() {
    let (mut live, number) = intake();
    assert_eq!(live.wheels(), ["left", "right"]);
    assert_eq!(live.channel(&channel("/other", JOINTS)), None);
    let measures: &dyn Measures = &live;
    assert!(!measures.is_of_tables());
    assert_eq!(measures.wheels(), ["left", "right"]);
    assert_eq!(
        [Meaning::WheelRate, Meaning::WheelAngle].map(|meaning| measures.measures(meaning)),
        [true, false]
    );
    assert_eq!(
        ["left", "right"].map(|wheel| measures.measures_wheel(Meaning::WheelRate, wheel)),
        [true, false]
    );
    assert_eq!(measures.position_sigma(), None);
    let fixes = log(&[fix("/fix", 0.0625)], "");
    assert_eq!(Measures::position_sigma(&fixes), Some(0.25));
    assert!(live.notes().is_empty());
    // what is no number of a channel, and what cannot be decoded
    live.push(None, &rate(10), 10);
    live.push(Some(1), &rate(10), 10);
    assert_eq!(live.left_out().undecoded, 0);
    for _ in 0..2 {
        live.push(number, &[0, 1, 0, 0], 10);
    }
    assert_eq!(live.left_out().undecoded, 2);
    live.push(number, &rate(20), 10);
    assert_eq!(live.pop(), None);
    assert_eq!(times(&mut live), [20]);
    // a receiver's standard deviation is the median of its first fixes'
    let mut preview = Preview::new(&topics(""));
    let fixes = channel("/fix", "sensor_msgs/NavSatFix");
    let number = preview.channel(&fixes);
    for sigma in [0.05, 0.02, 0.03, 0.04, 0.01] {
        let (_, kind, _, value) = fix("/fix", sigma * sigma);
        preview.push(number, &encoded(kind, &value), 5);
    }
    let imu_number = preview.channel(&channel("/imu", IMU));
    let (_, kind, _, value) = imu("/imu", [0.0; 3], [0.0; 3]);
    preview.push(imu_number, &encoded(kind, &value), 5);
    let found = preview.into_intake().unwrap();
    assert!((Measures::position_sigma(&found).unwrap() - 0.03).abs() < 1e-12);
    assert!(found.notes()[0].contains("neither transforms nor gravity"));
}

#[test]
fn a_clock_that_is_set_back_is_followed_after_three_messages() {
    let second = 1_000_000_000;
    let after = |back: &[i64]| {
        let (live, number) = intake();
        let mut live = live.with_hold(Duration::from_millis(100));
        live.push(number, &rate(100 * second), 0);
        assert_eq!(times(&mut live), [100 * second]);
        let mut found = Vec::new();
        for by in back {
            live.push(number, &rate(100 * second - by), 0);
            found.extend(times(&mut live));
        }
        (found, live.left_out().late)
    };
    // a second is far
    assert_eq!(after(&[second; 4]), (vec![99 * second; 2], 2));
    assert_eq!(after(&[second - 1; 5]), (vec![], 5));
    // stragglers alone, or with a good one between, show nothing
    assert_eq!(after(&[second; 2]), (vec![], 2));
    assert_eq!(
        after(&[second, second, 0, second, second]),
        (vec![100 * second], 4)
    );
    // nor do late ones, which are not counted
    assert_eq!(
        after(&[second, second, second - 1, second]),
        (vec![99 * second], 3)
    );
}

#[test]
fn a_message_like_the_one_before_costs_no_allocation() {
    let (mut live, number) = intake();
    let messages: Vec<Vec<u8>> = (1..40).map(|time| rate(10 * time)).collect();
    let mut take = |messages: &[Vec<u8>]| {
        for message in messages {
            live.push(number, message, 0);
            assert!(live.pop_held().is_some());
        }
    };
    take(&messages[..20]);
    let memory = allocation_counter::measure(|| take(&messages[20..]));
    assert_eq!(memory.count_total, 0);
}

#[test]
fn a_preview_is_complete_with_what_is_named_and_wheels() {
    let complete = |wanted: &str, pushed: &[Message], entered: &[(&str, &str)]| {
        let mut preview = Preview::new(&topics(wanted));
        for (topic, type_name) in entered {
            preview.channel(&channel(topic, type_name));
        }
        for (topic, type_name, time, value) in pushed {
            let number = preview.channel(&channel(topic, type_name));
            preview.push(number, &encoded(type_name, value), time.cast_unsigned());
        }
        let is_complete = preview.is_complete();
        let missing = preview.into_intake().err();
        assert!(
            missing
                .iter()
                .all(|error| matches!(error, Error::NoNamedTopic { .. }))
        );
        (is_complete, missing.is_none())
    };
    let wheels = joints("/joints", &["left"]);
    let named = "yaw_rate = \"/imu\"";
    let imu = imu("/imu", FLAT, [0.0; 3]);
    assert_eq!(complete("", &[], &[]), (false, true));
    assert_eq!(complete("", std::slice::from_ref(&imu), &[]), (false, true));
    assert_eq!(
        complete("", std::slice::from_ref(&wheels), &[]),
        (true, true)
    );
    assert_eq!(
        complete(named, std::slice::from_ref(&wheels), &[]),
        (false, false)
    );
    // a topic without a message is not there
    assert_eq!(
        complete(named, std::slice::from_ref(&wheels), &[("/imu", IMU)]),
        (false, false)
    );
    assert_eq!(
        complete(named, &[wheels.clone(), imu.clone()], &[]),
        (true, true)
    );
    let by_odometry = "wheel_odometry = \"/odom\"\nwheel_odometry_track_m = 0.5";
    assert_eq!(
        complete(by_odometry, &[odometry("/odom", 0.0)], &[]),
        (true, true)
    );
    assert_eq!(complete(by_odometry, &[wheels], &[]), (false, false));
    let field = "[[topics.field]]\ntopic = \"/imu\"\nfield = \"angular_velocity.z\"\nmeaning = \"yaw_rate\"\nunit = \"rad/s\"\n";
    assert_eq!(complete(field, &[imu], &[]), (true, true));
    let error = Preview::new(&topics(named))
        .into_intake()
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.starts_with("the messages: there are no messages of topic `/imu`"),
        "{error}"
    );
}

#[test]
fn topics_of_one_name_and_two_types_are_two() {
    let mut preview = Preview::new(&topics(""));
    let (_, _, _, twist) = twist("/cmd");
    let number = preview.channel(&channel("/cmd", IMU));
    preview.push(number, b"", 5);
    let number = preview.channel(&channel("/cmd", TWIST));
    preview.push(number, &encoded(TWIST, &twist), 5);
    let found = preview.into_intake().unwrap();
    assert_eq!(
        found
            .topics()
            .map(|topic| topic.used_for)
            .collect::<Vec<_>>(),
        ["commanded speed"]
    );
}

#[test]
fn messages_are_looked_at_until_they_say_enough() {
    // the 64th message may name joints, the 65th not
    for (number, is_seen) in [(64, true), (65, false)] {
        let mut all = vec![joints("/joints", &["left"]); number - 1];
        all.push(joints("/joints", &["left", "right"]));
        assert_eq!(
            log(&all, "").measures_wheel(Meaning::WheelRate, "right"),
            is_seen
        );
    }
    // the 500th acceleration counts, the 501st does not
    for (number, is_level) in [(500, false), (501, true)] {
        let mut all = vec![imu("/imu", FLAT, [0.0; 3]); number - 1];
        all.push(imu("/imu", [1e6, 0.0, 0.0], [0.0; 3]));
        let found = log(&all, "");
        assert_eq!(
            used(&found)[0].ends_with("(by gravity)"),
            is_level,
            "{:?}",
            used(&found)
        );
    }
    // every transform does
    let mut all = vec![transform("base_link", "camera", [0.0, 0.0, 0.0, 1.0]); 80];
    all.push(transform("base_link", "imu_link", [0.0, 0.0, 0.0, 1.0]));
    all.push(imu("/imu", FLAT, [0.0; 3]));
    assert!(used(&log(&all, ""))[0].contains("by its transforms"));
}

/// A channel with the given number of messages of the first value, and then one of the other.
fn many(type_name: &'static str, first: &Value, count: usize, last: &Value) -> Intake {
    let mut preview = Preview::new(&topics(""));
    let number = preview.channel(&channel("/topic", type_name));
    let (first, last) = (encoded(type_name, first), encoded(type_name, last));
    for _ in 0..count {
        preview.push(number, &first, 5);
    }
    preview.push(number, &last, 5);
    preview.into_intake().unwrap()
}

#[test]
fn twenty_thousand_messages_are_looked_at_for_a_fix_or_an_acceleration() {
    let poor = fix("/topic", 400.0).3;
    let good = fix("/topic", 1e-4).3;
    for (count, is_used) in [(19_999, true), (20_000, false)] {
        let found = many("sensor_msgs/NavSatFix", &poor, count, &good);
        assert_eq!(found.topics().count(), usize::from(is_used));
    }
    let without = build::planar_imu(build::header(5, "imu_link"), Some(0.1), None);
    let with = imu("/topic", [0.0, 9.8, 0.0], [0.0; 3]).3;
    for (count, is_seen) in [(19_999, true), (20_000, false)] {
        let found = many(IMU, &without, count, &with);
        // of this gyro only z may be used, and gravity says y
        assert_eq!(found.topics().count(), usize::from(!is_seen));
    }
}

#[test]
fn sixty_four_messages_are_looked_at_for_wheels() {
    let ticks = |names: &[&str]| {
        let header = build::header(5, "");
        build::wheel_ticks(header, names, &vec![7; names.len()])
    };
    let (first, last) = (ticks(&["left"]), ticks(&["left", "right"]));
    for (count, wheels) in [(63, 2), (64, 1), (65, 1)] {
        let found = many("grouser_msgs/WheelTicks", &first, count, &last);
        let used: Vec<String> = found.topics().map(|topic| topic.used_for).collect();
        assert_eq!(used, [format!("wheels by {wheels} joints")], "{count}");
    }
}

/// A file of these parts: joints, bytes that are of no use (up to a place, or 2 MiB), an IMU's message.
fn parts(order: &str, padding: usize) -> Vec<u8> {
    let mut file = mcap::MAGIC.to_vec();
    let mut declare = |id: u16, topic: &str, type_name: &str| {
        let text = known::definition(type_name).unwrap_or_default();
        let mut content = id.to_le_bytes().to_vec();
        for part in [type_name.as_bytes(), b"ros2msg", text.as_bytes()] {
            mcap::counted(&mut content, part);
        }
        mcap::record(&mut file, 3, &content);
        mcap::channel(&mut file, id, id, topic.as_bytes(), b"cdr");
    };
    declare(1, "/joints", JOINTS);
    declare(2, "/imu", IMU);
    declare(3, "/junk", "demo/Junk");
    for part in order.chars() {
        match part {
            'j' => mcap::message(&mut file, 1, 5, &rate(5)),
            'i' => mcap::message(
                &mut file,
                2,
                5,
                &encoded(IMU, &imu("/imu", FLAT, [0.0; 3]).3),
            ),
            '+' => mcap::message(&mut file, 3, 5, &vec![0; 2 << 20]),
            // up to this place in the file
            _ => {
                while padding - file.len() > 2 << 20 {
                    mcap::message(&mut file, 3, 5, &vec![0; 1 << 20]);
                }
                let room = padding - file.len();
                mcap::message(&mut file, 3, 5, &vec![0; room - 31]);
            }
        }
    }
    mcap::record(&mut file, 2, &[0; 20]);
    file.extend(mcap::MAGIC);
    file
}

/// So much of a file is looked at.
const LOOK: usize = 64 << 20;

fn has_yaw_rate(order: &str, padding: usize, wanted: &str) -> bool {
    let log = over(parts(order, padding), wanted).unwrap();
    log.measures(Meaning::YawRate)
}

#[test]
fn the_first_64_mebibytes_are_looked_at() {
    assert!(has_yaw_rate("j-i", 3 << 20, ""));
    assert!(has_yaw_rate("j-i", LOOK, ""));
}

#[test]
fn what_stands_behind_64_mebibytes_is_not() {
    assert!(!has_yaw_rate("j-i", LOOK + 40, ""));
}

#[test]
fn more_is_looked_at_while_a_topic_is_missing() {
    assert!(has_yaw_rate("j-i", LOOK + 40, "yaw_rate = \"/imu\""));
}

#[test]
fn more_is_looked_at_by_the_mebibyte() {
    // the topic that was missing does not end it at once
    assert!(has_yaw_rate("-ji", LOOK + 40, ""));
    assert!(!has_yaw_rate("-j+i", LOOK + 40, ""));
}

#[test]
fn a_preview_of_a_file() {
    let folder = crate::scratch::Folder::new("preview");
    let path = folder.file("log.mcap", &file(&[joints("/joints", &["left"])]));
    let mut preview = Preview::new(&topics(""));
    preview.read(&path).unwrap();
    assert!(preview.is_complete());
    assert_eq!(Encoding::Cdr, channel("/a", IMU).encoding);
}

fn amcl(name: &'static str, variance: f64) -> Message {
    let pose = build::message([
        ("pose", build::pose(1.0, 2.0, 0.5)),
        ("covariance", build::numbers(&[variance; 36])),
    ]);
    let value = build::message([("header", build::header(5, "map")), ("pose", pose)]);
    (name, "geometry_msgs/PoseWithCovarianceStamped", 5, value)
}

fn vicon(name: &'static str) -> Message {
    let transform = build::message([
        ("translation", build::vector([1.0, 2.0, 0.0])),
        ("rotation", build::turn(0.5)),
    ]);
    let value = build::message([
        ("header", build::header(5, "world")),
        ("child_frame_id", Value::Text("robot".into())),
        ("transform", transform),
    ]);
    (name, "geometry_msgs/TransformStamped", 5, value)
}

fn point(name: &'static str, time_ns: i64, place: [f64; 2]) -> Message {
    let [x, y] = place;
    let value = build::message([
        ("header", build::header(time_ns, "map")),
        ("point", build::vector([x, y, 0.3])),
    ]);
    (name, "geometry_msgs/PointStamped", time_ns, value)
}

fn twist_of(name: &'static str, variance: f64) -> Message {
    let twist = build::message([
        ("twist", build::twist([0.3, 0.4, 0.0], [0.0; 3])),
        ("covariance", build::numbers(&[variance; 36])),
    ]);
    let value = build::message([("header", build::header(5, "")), ("twist", twist)]);
    (name, "geometry_msgs/TwistWithCovarianceStamped", 5, value)
}

#[test]
fn poses_of_every_type_are_poses() {
    for message in [amcl("/amcl_pose", 0.01), vicon("/vicon/robot/robot")] {
        let found = log(std::slice::from_ref(&message), "");
        assert_eq!(used(&found), [format!("{}: pose", message.0)]);
        assert!(found.notes().is_empty(), "{:?}", found.notes());
        let [M::Pose { x, y, yaw }] = readings(&found)[..] else {
            panic!("{:?}", readings(&found))
        };
        assert!((x, y) == (1.0, 2.0) && (yaw - 0.5).abs() < 1e-12);
    }
    // what was chosen before is chosen still, and the covariance counts as that of an odometry
    let both = [amcl("/amcl_pose", 0.01), pose("/pose")];
    assert_eq!(chosen(&both, ""), ["/pose: pose"]);
    assert_eq!(chosen(&both, "pose = \"/amcl_pose\""), ["/amcl_pose: pose"]);
    for variance in [-1.0, f64::MAX] {
        assert_eq!(readings(&log(&[amcl("/amcl_pose", variance)], "")), []);
    }
    // names that say of what it is not, or do not say that it is of the robot
    for message in [
        amcl("/robot_pose_ekf/odom_combined", 0.01),
        vicon("/tool/transform"),
        point("/lookahead", 5, [1.0, 2.0]),
    ] {
        let found = log(std::slice::from_ref(&message), "");
        assert_eq!(used(&found), [""; 0]);
        let note = format!(
            "`{}` is not used: name it in `[topics]` of the robot file as `pose` if it measures where the robot is, or \
             under `ignore`",
            message.0
        );
        assert_eq!(found.notes(), [note]);
        let wanted = format!("ignore = [\"{}\"]", message.0);
        assert!(log(&[message], &wanted).notes().is_empty());
    }
    for message in [
        amcl("/initialpose", 0.01),
        point("/clicked_point", 5, [0.0; 2]),
    ] {
        let found = log(&[message], "");
        assert_eq!((used(&found).len(), found.notes().len()), (0, 0));
    }
}

#[test]
fn a_speed_of_unknown_origin_is_named() {
    let found = log(&[twist_of("/radar", 0.01), twist("/teleop")], "");
    assert_eq!(used(&found), [""; 0]);
    assert_eq!(
        found.notes(),
        [
            "`/radar` is not used: name it in `[topics]` of the robot file as `speed` if it measures the ground, as \
             `command` if it was commanded, or under `ignore`"
        ]
    );
    let found = log(&[twist_of("/radar", 0.01)], "speed = \"/radar\"");
    let left = Some(0.4);
    assert_eq!(readings(&found), [M::Speed { forward: 0.3, left }]);
    let found = log(&[twist_of("/radar", f64::MAX)], "speed = \"/radar\"");
    assert_eq!(readings(&found), []);
    assert_eq!(
        chosen(&[twist_of("/cmd_vel", 0.0)], ""),
        ["/cmd_vel: commanded speed"]
    );
}

#[test]
fn a_velocity_on_the_earth_is_used_where_it_is_known() {
    let of = |variance| readings(&log(&[twist_of("/gps/vel", variance)], ""));
    let left = None;
    assert_eq!(of(0.01), [M::Speed { forward: 0.5, left }]);
    assert_eq!([of(f64::MAX), of(-1.0)], [vec![], vec![]]);
}

#[test]
fn places_without_a_heading_are_ways_along_the_course() {
    // north-east, from the third place on the course is known: over 0.2 m
    let step = 0.15 * std::f64::consts::FRAC_1_SQRT_2;
    let places: Vec<Message> = (0..5)
        .map(|k| {
            let at = step * f64::from(k);
            point("/leica/point", 100_000_000 * i64::from(k) + 5, [at, at])
        })
        .collect();
    for (wanted, sigma) in [("", 0.05), ("pose = \"/leica/point\"", 0.05)] {
        let found = log(&places, wanted);
        assert_eq!(
            used(&found),
            ["/leica/point: displacement between positions"]
        );
        assert_eq!(found.position_sigma(), Some(sigma));
        assert_eq!(
            found.notes(),
            [
                "`/leica/point` does not say how accurate its places are: 0.05 m is assumed; `position_sigma_m` in \
                 `[estimator]` states it"
            ]
        );
        assert!(found.measures(Meaning::DisplacementForward) && !found.measures(Meaning::PoseX));
        let (positions, ways) = positions_and_ways(&found);
        assert_eq!((positions.len(), ways.len()), (5, 3));
        for ([x, y], k) in positions.into_iter().zip(0..) {
            let at = step * f64::from(k);
            assert!((x - at).abs() < 1e-12 && (y - at).abs() < 1e-12);
        }
        for way in ways {
            let M::Displacement {
                forward,
                left,
                turn,
            } = way
            else {
                panic!("{way:?}")
            };
            assert!((forward - 0.15).abs() < 1e-12 && left.abs() < 1e-12 && turn.is_none());
        }
    }
    // the robot file states the accuracy, and the course is taken over four of it
    let text = "format = 1\nname = \"cart\"\n[estimator]\nposition_sigma_m = 0.1\n[[wheel]]\nname = \"left\"\n\
                x_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n";
    let document = Document::from_text("robot.toml", text.into()).unwrap();
    let stated = robot::parse(&document).unwrap().topics;
    let bytes = Cursor::new(file(&places));
    let found = Log::over("log.mcap".as_ref(), bytes, None, &stated).unwrap();
    assert_eq!(
        (found.position_sigma(), found.notes().len()),
        (Some(0.1), 0)
    );
    assert_eq!(positions_and_ways(&found).1.len(), 2);
    // what measures the motion itself is used instead, and places are used instead of fixes
    let mut all = places.clone();
    all.push(pose("/pose"));
    assert_eq!(chosen(&all, ""), ["/pose: pose"]);
    all[5] = fix("/fix", 1e-4);
    assert_eq!(
        chosen(&all, ""),
        ["/leica/point: displacement between positions"]
    );
    assert_eq!(
        chosen(&all, "fix = \"/fix\""),
        ["/fix: displacement between fixes"]
    );
}

/// The position of a joint that turns by 1 rad a message, wrapped between -π and π.
fn wrapped(number: i64) -> Message {
    let angle = (number as f64 + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
        - std::f64::consts::PI;
    let header = build::header(5 + number, "");
    let value = build::joint_state(header, &["left", "arm"], [&[angle, 0.0], &[], &[]]);
    ("/joints", JOINTS, 5 + number, value)
}

#[test]
fn positions_within_one_turn_are_put_together() {
    let is_put_together = |found: &[M]| {
        found.len() == 40
            && found.iter().enumerate().all(|(number, reading)| {
                matches!(reading, M::WheelAngle { wheel: 0, angle } if (angle - number as f64).abs() < 1e-9)
            })
    };
    let note = "the positions in `/joints` jump by whole turns, as angles that are kept within one: they are put together again";
    let all: Vec<Message> = (0..40).map(wrapped).collect();
    let found = log(&all, "");
    assert!(is_put_together(&readings(&found)), "{:?}", readings(&found));
    assert_eq!(found.notes(), [note]);
    // in the files of a split recording too, and again with every reading
    let parts = [("0.mcap", &all[..23]), ("1.mcap", &all[23..])];
    let parts = parts.map(|(name, part)| (name.into(), Cursor::new(file(part))));
    let found = Log::over_all(parts, None, &topics("")).unwrap();
    assert!(is_put_together(&readings(&found)) && is_put_together(&readings(&found)));
    // live
    let mut preview = Preview::new(&topics(""));
    let number = preview.channel(&channel("/joints", JOINTS));
    preview.push(number, &encoded(JOINTS, &all[0].3), 5);
    let mut live = preview.into_intake().unwrap();
    let number = live.channel(&channel("/joints", JOINTS));
    for (_, _, time_ns, value) in &all {
        live.push(number, &encoded(JOINTS, value), time_ns.cast_unsigned());
    }
    live.finish();
    let found: Vec<M> = std::iter::from_fn(|| live.pop())
        .map(|sample| sample.measurement)
        .collect();
    assert!(is_put_together(&found), "{found:?}");
    // the first of three thousand messages show it
    for (rest, is_noted) in [(2997, true), (2998, false)] {
        let mut preview = Preview::new(&topics(""));
        let number = preview.channel(&channel("/joints", JOINTS));
        let values = (0..rest).map(|_| 0).chain([2, 3, 4]);
        for value in values.map(|number| wrapped(number).3) {
            preview.push(number, &encoded(JOINTS, &value), 5);
        }
        assert_eq!(!preview.into_intake().unwrap().notes().is_empty(), is_noted);
    }
    // a joint that is no wheel, and a wheel that counts on
    let mut others = Vec::new();
    for number in 0..40 {
        let (topic, kind, time_ns, _) = wrapped(number);
        let angle = -3.0 + 3.0 * number as f64;
        let arm = if number % 2 == 0 { 3.1 } else { -3.1 };
        let parts: [&[f64]; 3] = [&[angle, arm], &[], &[]];
        let value = build::joint_state(build::header(time_ns, ""), &["left", "arm"], parts);
        others.push((topic, kind, time_ns, value));
    }
    let found = log(&others, "");
    assert!(found.notes().is_empty(), "{:?}", found.notes());
    let last = readings(&found).pop().unwrap();
    assert_eq!(
        last,
        M::WheelAngle {
            wheel: 0,
            angle: 114.0
        }
    );
}

/// A column map of tables, each with its file and its columns (name, meaning, unit); their times are in ms.
fn map(tables: &[(&str, &[[&str; 3]])]) -> ColumnMap {
    let table = |(file, columns): &(&str, &[[&str; 3]])| {
        let columns: Vec<String> = columns
            .iter()
            .map(|[name, meaning, unit]| {
                format!("{{ column = \"{name}\", meaning = \"{meaning}\", unit = \"{unit}\" }}")
            })
            .collect();
        format!(
            "[[table]]\nfile = \"{file}\"\ntime = {{ column = \"t\", unit = \"ms\" }}\ncolumns = [{}]\n",
            columns.join(", ")
        )
    };
    let tables: String = tables.iter().map(table).collect();
    let text = format!("format = 1\n{tables}");
    columns::parse(&Document::from_text("columns.toml", text).unwrap()).unwrap()
}

const X: [&str; 3] = ["x", "pose_x", "m"];
const Y: [&str; 3] = ["y", "pose_y", "m"];

#[test]
fn places_of_a_table_are_ways_along_the_course() {
    // a circle to the left, begun to the north-east: the gyro is in a table of its own
    let (speed, rate, at) = (0.5, 0.4, std::f64::consts::FRAC_PI_4);
    let radius = speed / rate;
    let (mut places, mut gyro) = ("t,x,y\n".to_owned(), "t,g\n".to_owned());
    for row in 0..200 {
        let yaw = at + rate * 0.1 * f64::from(row);
        let (x, y) = (radius * yaw.sin(), -radius * yaw.cos());
        writeln!(places, "{},{x:?},{y:?}", 100 * row).unwrap();
        writeln!(gyro, "{0},{rate}\n{1},{rate}", 100 * row, 100 * row + 50).unwrap();
    }
    let map = map(&[("p.csv", &[X, Y]), ("g.csv", &[["g", "yaw_rate", "rad/s"]])]);
    let files = [
        ("p.csv".into(), Cursor::new(places)),
        ("g.csv".into(), Cursor::new(gyro)),
    ];
    let found = Log::over_all(files, Some(map), &topics("")).unwrap();
    assert!(
        found.measures(Meaning::DisplacementForward) && found.measures(Meaning::DisplacementLeft)
    );
    assert!(!found.measures(Meaning::PoseX) && !found.measures(Meaning::PoseY));
    assert_eq!(found.position_sigma(), Some(0.05));
    let [note] = found.notes() else {
        panic!("{:?}", found.notes())
    };
    assert!(
        note.starts_with("`p.csv` does not say how accurate its places are: 0.05 m"),
        "{note}"
    );
    let chord = 2.0 * radius * (0.05 * rate).sin();
    let (positions, mut ways) = positions_and_ways(&found);
    ways.retain(|one| !matches!(one, M::YawRate { .. }));
    // the first place comes before the gyro, and the course is known after 0.2 m, five steps later
    assert_eq!((positions.len(), ways.len()), (200, 200 - 6));
    for way in ways {
        let M::Displacement {
            forward,
            left,
            turn: None,
        } = way
        else {
            panic!("{way:?}")
        };
        assert!(
            (forward - chord).abs() < 1e-6 && left.abs() < 1e-5,
            "{way:?}"
        );
    }
}

#[test]
fn places_of_a_table_give_way_to_better_references() {
    let over = |columns: &[[&str; 3]]| {
        let header: Vec<&str> = columns.iter().map(|column| column[0]).collect();
        let row = |time: i32| format!("{time}{}\n", format!(",0.{time}").repeat(header.len()));
        let text = format!(
            "t,{}\n{}{}{}",
            header.join(","),
            row(100),
            row(200),
            row(600)
        );
        let map = map(&[("run.csv", columns)]);
        Log::over(
            "run.csv".as_ref(),
            Cursor::new(text),
            Some(map),
            &topics(""),
        )
        .unwrap()
    };
    let pose = over(&[X, Y, ["yaw", "pose_yaw", "rad"]]);
    assert!(pose.measures(Meaning::PoseX) && pose.measures(Meaning::PoseY));
    assert!(!pose.measures(Meaning::DisplacementForward));
    assert!(
        readings(&pose)
            .iter()
            .all(|one| matches!(one, M::Pose { yaw, .. } if *yaw != 0.0))
    );
    assert_eq!((pose.notes().len(), pose.position_sigma()), (0, None));
    let dx = ["dx", "displacement_forward", "m"];
    let both = over(&[X, Y, dx, ["dy", "displacement_left", "m"]]);
    assert_eq!(readings(&both).len(), 3);
    assert_eq!(
        both.notes(),
        [
            "`run.csv`: its places without a heading are not used, since the log has another reference"
        ]
    );
    // the fields of messages likewise
    let fields = "[[topics.field]]\ntopic = \"/prism\"\nfield = \"point.x\"\nmeaning = \"pose_x\"\nunit = \"m\"\n\
                  [[topics.field]]\ntopic = \"/prism\"\nfield = \"point.y\"\nmeaning = \"pose_y\"\nunit = \"m\"\n";
    let places: Vec<Message> = (0..5)
        .map(|k| {
            point(
                "/prism",
                100_000_000 * i64::from(k) + 5,
                [0.15 * f64::from(k), 0.0],
            )
        })
        .collect();
    let found = log(&places, fields);
    assert_eq!(found.position_sigma(), Some(0.05));
    assert!(found.measures(Meaning::DisplacementForward) && !found.measures(Meaning::PoseX));
    let (positions, ways) = positions_and_ways(&found);
    assert_eq!((positions.len(), ways.len()), (5, 3));
    let is_way =
        |way: &M| matches!(way, M::Displacement { forward, .. } if (forward - 0.15).abs() < 1e-12);
    assert!(ways.iter().all(is_way), "{ways:?}");
}

#[test]
fn a_pose_beside_places_stays_a_pose() {
    // one message is a pose with its heading, the other a place without one
    let field = |topic: &str, axis: &str, meaning: &str| {
        format!(
            "[[topics.field]]\ntopic = \"{topic}\"\nfield = \"point.{axis}\"\nmeaning = \"{meaning}\"\nunit = \"{}\"\n",
            if axis == "z" { "rad" } else { "m" }
        )
    };
    let wanted = [
        field("/pose", "x", "pose_x"),
        field("/pose", "y", "pose_y"),
        field("/pose", "z", "pose_yaw"),
        field("/place", "x", "pose_x"),
        field("/place", "y", "pose_y"),
    ]
    .concat();
    let found = log(
        &[
            point("/pose", 5, [1.0, 2.0]),
            point("/place", 7, [3.0, 4.0]),
        ],
        &wanted,
    );
    let (yaw, [x, y]) = (0.3, [1.0, 2.0]);
    assert_eq!(
        readings(&found),
        [M::Pose { x, y, yaw }, M::Position { x: 3.0, y: 4.0 }]
    );
}
