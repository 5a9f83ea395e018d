//! Bags and MCAP files as logs: which topics are chosen, how an IMU is mounted, which times count, what
//! covariances say. The files are written here, with other programs' files tested in `interop.rs`.

use std::fs::File;
use std::path::{Path, PathBuf};

use grouser_files::columns::Meaning;
use grouser_files::{Document, robot};
use grouser_log::message::{Value, build};
use grouser_log::write::{McapWriter, SampleWriter};
use grouser_log::{Error, Log};
use grouser_slip::{Measurement, Sample};

use crate::scratch::Folder;

const WHEELS: &str = "[[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
     [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";

/// A log of these messages (topic, type, time in ns, fields) read by a robot file with this `[topics]`.
fn log(folder: &Folder, topics: &str, messages: &[(&str, &str, i64, Value)]) -> Result<Log, Error> {
    let path = write(&folder.0.join("log.mcap"), messages);
    let text = format!("format = 1\nname = \"cart\"\n{topics}\n{WHEELS}");
    let robot = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    Log::find_any(&[path], None, &robot.topics)
}

pub(crate) fn write(path: &Path, messages: &[(&str, &str, i64, Value)]) -> PathBuf {
    let mut writer = McapWriter::new(File::create(path).unwrap(), "ros2").unwrap();
    let mut topics = Vec::new();
    for (name, kind, time_ns, value) in messages {
        let known = topics.iter().position(|(own, _)| own == name);
        let index = known.unwrap_or_else(|| {
            topics.push((*name, writer.topic(name, kind).unwrap()));
            topics.len() - 1
        });
        writer.send(&mut topics[index].1, *time_ns, value).unwrap();
    }
    writer.finish().unwrap();
    path.to_owned()
}

fn readings(log: &Log) -> Vec<Sample> {
    log.samples(&[]).unwrap().map(Result::unwrap).collect()
}

fn joints(
    time_ns: i64,
    position: &[f64],
    velocity: &[f64],
) -> (&'static str, &'static str, i64, Value) {
    let names = ["left_wheel_joint", "right_wheel_joint", "arm"];
    let value = build::joint_state(
        build::header(time_ns, ""),
        &names,
        [position, velocity, &[]],
    );
    ("/joint_states", "sensor_msgs/JointState", time_ns, value)
}

/// An IMU's message of these rates and accelerations; `variances` stand on the rates' diagonal.
fn imu(time_ns: i64, rate: [f64; 3], acceleration: [f64; 3], variances: [f64; 3]) -> Value {
    let mut covariance = [0.0; 9];
    for (axis, variance) in variances.into_iter().enumerate() {
        covariance[4 * axis] = variance;
    }
    build::message([
        ("header", build::header(time_ns, "imu_link")),
        ("orientation", build::turn(0.0)),
        (
            "orientation_covariance",
            build::numbers(&[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ),
        ("angular_velocity", build::vector(rate)),
        ("angular_velocity_covariance", build::numbers(&covariance)),
        ("linear_acceleration", build::vector(acceleration)),
        ("linear_acceleration_covariance", build::numbers(&[0.0; 9])),
    ])
}

const IMU: &str = "sensor_msgs/Imu";

#[test]
fn joints_are_read_by_their_wheels_names() {
    let folder = Folder::new("joints");
    let messages = [
        joints(1_000, &[0.5, -0.5, 9.0], &[1.0, 2.0, 9.0]),
        joints(2_000, &[0.6, -0.4, 9.0], &[]),
    ];
    let log = log(&folder, "", &messages).unwrap();
    assert!(log.measures_wheel(Meaning::WheelAngle, "left"));
    assert!(log.measures_wheel(Meaning::WheelRate, "right"));
    assert!(!log.measures(Meaning::YawRate));
    let found: Vec<Measurement> = readings(&log)
        .iter()
        .map(|record| record.measurement)
        .collect();
    assert_eq!(
        found,
        [
            Measurement::WheelAngle {
                wheel: 0,
                angle: 0.5
            },
            Measurement::WheelRate {
                wheel: 0,
                rate: 1.0
            },
            Measurement::WheelAngle {
                wheel: 1,
                angle: -0.5
            },
            Measurement::WheelRate {
                wheel: 1,
                rate: 2.0
            },
            Measurement::WheelAngle {
                wheel: 0,
                angle: 0.6
            },
            Measurement::WheelAngle {
                wheel: 1,
                angle: -0.4
            },
        ]
    );
}

#[test]
fn an_imu_with_y_up_still_gives_the_yaw_rate() {
    let folder = Folder::new("y-up");
    // At rest it shows gravity upwards, along its y axis; the robot turns left by 0.4 rad/s about it.
    let standing = |n: i64| {
        (
            "/imu",
            IMU,
            n,
            imu(n, [0.1, 0.4, -0.2], [0.2, 9.79, -0.1], [0.0; 3]),
        )
    };
    let messages: Vec<_> = (1..20).map(standing).collect();
    let log = log(&folder, "", &messages).unwrap();
    assert!(
        readings(&log)
            .iter()
            .all(|r| r.measurement == Measurement::YawRate { rate: 0.4 })
    );
    assert_eq!(
        log.topics().next().unwrap().used_for,
        "yaw rate about its y axis (by gravity)"
    );
}

#[test]
fn static_transforms_tell_the_mounting_too() {
    let folder = Folder::new("transforms");
    // Turned about x by −90 degrees: the IMU's y axis points down. No acceleration is given.
    let half = 0.5_f64.sqrt();
    let rotation = build::message([
        ("x", Value::Float(-half)),
        ("y", Value::Float(0.0)),
        ("z", Value::Float(0.0)),
        ("w", Value::Float(half)),
    ]);
    let transform = build::message([
        ("header", build::header(1, "base_link")),
        ("child_frame_id", Value::Text("imu_link".into())),
        (
            "transform",
            build::message([
                ("translation", build::vector([0.0; 3])),
                ("rotation", rotation),
            ]),
        ),
    ]);
    let transforms = build::message([("transforms", Value::Array(vec![transform]))]);
    let mut messages = vec![("/tf_static", "tf2_msgs/TFMessage", 1, transforms)];
    messages.push(("/imu", IMU, 2, imu(2, [0.1, -0.4, 0.2], [0.0; 3], [0.0; 3])));
    let log = log(&folder, "", &messages).unwrap();
    let [record] = readings(&log)[..] else {
        panic!("one reading")
    };
    let Measurement::YawRate { rate } = record.measurement else {
        panic!("{record:?}")
    };
    assert!((rate - 0.4).abs() < 1e-15, "{rate}");
    assert!(log.notes().is_empty(), "{:?}", log.notes());

    // With an accelerometer: its z axis points to the robot's left, and gravity is felt along −y.
    let felt = imu(2, [0.1, -0.4, 0.2], [0.5, -9.8, -0.2], [0.0; 3]);
    messages[1] = ("/imu", IMU, 2, felt);
    let folder = Folder::new("transforms-felt");
    let log = self::log(&folder, "", &messages).unwrap();
    let [_, record] = readings(&log)[..] else {
        panic!("two readings")
    };
    let Measurement::Acceleration { forward, left } = record.measurement else {
        panic!("{record:?}")
    };
    assert!(
        (forward - 0.5).abs() < 1e-15 && (left + 0.2).abs() < 1e-14,
        "{forward} {left}"
    );
}

#[test]
fn efforts_are_torques_of_wheels() {
    let folder = Folder::new("efforts");
    let names = ["left_wheel_joint", "right_wheel_joint"];
    let state = build::joint_state(
        build::header(5, ""),
        &names,
        [&[], &[1.0, 2.0], &[0.3, f64::NAN]],
    );
    let log = log(
        &folder,
        "",
        &[("/joint_states", "sensor_msgs/JointState", 5, state)],
    )
    .unwrap();
    let torques: Vec<_> = readings(&log)
        .iter()
        .map(|record| record.measurement)
        .filter(|reading| matches!(reading, Measurement::WheelTorque { .. }))
        .collect();
    assert_eq!(
        torques,
        [Measurement::WheelTorque {
            wheel: 0,
            torque: 0.3
        }]
    );
}

#[test]
fn the_robot_file_decides_over_gravity() {
    let folder = Folder::new("decides");
    let messages = [(
        "/imu",
        IMU,
        5,
        imu(5, [0.3, 0.0, 0.0], [0.0, 0.0, 9.8], [0.0; 3]),
    )];
    let log = log(&folder, "[topics]\nimu_up = \"-x\"", &messages).unwrap();
    assert_eq!(
        readings(&log)[0].measurement,
        Measurement::YawRate { rate: -0.3 }
    );
}

#[test]
fn a_covariance_says_what_may_be_used() {
    let folder = Folder::new("c2");
    let max = f64::MAX;
    let of = |variances| {
        [(
            "/imu",
            IMU,
            5,
            imu(5, [0.1, 0.2, 0.3], [0.0, 0.0, 9.8], variances),
        )]
    };
    // Kobuki's driver: x and y are not to be used, z is.
    for usable in [
        [max, max, 0.05],
        [0.0; 3],
        [f64::NAN, f64::NAN, -3.0],
        [1e6; 3],
    ] {
        let log = log(&folder, "", &of(usable)).unwrap();
        assert_eq!(
            readings(&log)[0].measurement,
            Measurement::YawRate { rate: 0.3 },
            "{usable:?}"
        );
    }
    for unusable in [[0.0, 0.0, max], [-1.0, 0.0, 0.0]] {
        let log = log(&folder, "", &of(unusable)).unwrap();
        assert!(
            !log.measures(Meaning::YawRate) && readings(&log).is_empty(),
            "{unusable:?}"
        );
    }
}

#[test]
fn a_gyro_of_one_axis_needs_no_mounting() {
    let folder = Folder::new("one-axis");
    let gyro = build::planar_imu(build::header(5, "base_link"), Some(0.25), None);
    let log = log(&folder, "", &[("/gyro", IMU, 5, gyro)]).unwrap();
    assert_eq!(
        readings(&log)[0].measurement,
        Measurement::YawRate { rate: 0.25 }
    );
    let none = imu(5, [0.0, 0.3, 0.0], [0.0; 3], [f64::MAX, 0.0, f64::MAX]);
    let other = Folder::new("one-axis-y");
    let path = write(&other.0.join("log.mcap"), &[("/gyro", IMU, 5, none)]);
    let text = format!("format = 1\nname = \"cart\"\n{WHEELS}");
    let robot = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    let log = Log::find_any(&[path], None, &robot.topics).unwrap();
    assert_eq!(
        readings(&log)[0].measurement,
        Measurement::YawRate { rate: 0.3 }
    );
    assert!(log.notes().is_empty(), "{:?}", log.notes());
}

#[test]
fn odometry_of_unknown_origin_is_named_not_believed() {
    let folder = Folder::new("odometry");
    let odometry = |topic| {
        let pose = build::message([
            ("pose", build::pose(1.0, 2.0, 0.5)),
            ("covariance", build::numbers(&[0.0; 36])),
        ]);
        let twist = build::message([
            ("twist", build::twist([0.7, 0.0, 0.0], [0.0, 0.0, 0.2])),
            ("covariance", build::numbers(&[0.0; 36])),
        ]);
        let value = build::message([
            ("header", build::header(7, "odom")),
            ("child_frame_id", Value::Text("base_link".into())),
            ("pose", pose),
            ("twist", twist),
        ]);
        [(topic, "nav_msgs/Odometry", 7, value)]
    };
    let wheels = log(&folder, "", &odometry("/odom")).unwrap();
    assert!(readings(&wheels).is_empty() && wheels.notes()[0].contains("`/odom` is not used"));
    let camera = log(&folder, "", &odometry("/zed/odom")).unwrap();
    let found: Vec<Measurement> = readings(&camera)
        .iter()
        .map(|record| record.measurement)
        .collect();
    let yaw = match found[0] {
        Measurement::Pose {
            x: 1.0,
            y: 2.0,
            yaw,
        } => yaw,
        other => panic!("{other:?}"),
    };
    assert!((yaw - 0.5).abs() < 1e-15);
    assert_eq!(
        found[1],
        Measurement::Speed {
            forward: 0.7,
            left: Some(0.0)
        }
    );
    // As the wheels' own: v ∓ Ω t/2 over the radius.
    let topics = "[topics]\nwheel_odometry = \"/odom\"\nwheel_odometry_track_m = 0.5";
    let wheels = log(&folder, topics, &odometry("/odom")).unwrap();
    let rates: Vec<f64> = readings(&wheels)
        .iter()
        .map(|record| match record.measurement {
            Measurement::WheelRate { rate, .. } => rate,
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(
        (rates[0] - 6.5).abs() < 1e-12 && (rates[1] - 7.5).abs() < 1e-12,
        "{rates:?}"
    );
}

#[test]
fn any_number_of_any_message_can_be_a_wheels_count() {
    let folder = Folder::new("fields");
    let ticks = |n: i64, left, right| {
        let value = build::wheel_ticks(build::header(n, ""), &["a", "b"], &[left, right]);
        ("/encoders", "grouser_msgs/WheelTicks", n, value)
    };
    let messages = [ticks(1, 65_535, 3), ticks(2, 1, 4)];
    let field = |place: usize, wheel: &str| {
        format!(
            "[[topics.field]]\ntopic = \"/encoders\"\nfield = \"ticks[{place}]\"\n\
             meaning = \"wheel_count\"\nwheel = \"{wheel}\"\nunit = \"tick\"\n"
        )
    };
    let topics = field(1, "left") + &field(0, "right");
    let found = readings(&log(&folder, &topics, &messages).unwrap());
    let found: Vec<_> = found.iter().map(|r| (r.time_ns, r.measurement)).collect();
    let count = |time, wheel, raw| (time, Measurement::WheelCount { wheel, raw });
    assert_eq!(
        found,
        [
            count(1, 0, 3),
            count(1, 1, 65_535),
            count(2, 0, 4),
            count(2, 1, 1)
        ]
    );
    // What no message has is reported by name.
    let topics = field(0, "left").replace("ticks[0]", "tick[0]");
    let error = log(&folder, &topics, &messages).unwrap_err();
    assert!(
        error.to_string().contains("have no number at `tick[0]`"),
        "{error}"
    );
    let topics = field(0, "left").replace("/encoders", "/encoder");
    let error = log(&folder, &topics, &messages).unwrap_err();
    assert_eq!(error.hint().unwrap(), "did you mean `/encoders`?");
    let error = log(&folder, "[topics]\nyaw_rate = \"/encoders\"", &messages).unwrap_err();
    assert!(error.to_string().contains("named as") || error.to_string().contains("names it as"));
    let error = log(&folder, "[topics]\nwheels = \"/encoders\"", &messages).unwrap_err();
    assert!(error.to_string().ends_with("it has a, b"), "{error}");
}

#[test]
fn stamps_order_the_records_and_late_ones_are_counted() {
    let folder = Folder::new("order");
    let message = |stamp: i64, log: i64| {
        let (name, kind, _, value) = joints(stamp, &[stamp as f64], &[]);
        (name, kind, log, value)
    };
    // Recorded in another order than measured, 2000 messages apart at most.
    let n = 12_000;
    let shuffled: Vec<_> = (0..n)
        .map(|k| message(1 + (k / 2000) * 2000 + (1999 - k % 2000), 10 + k))
        .collect();
    let ordered = log(&folder, "", &shuffled).unwrap();
    let times: Vec<i64> = readings(&ordered)
        .iter()
        .map(|record| record.time_ns)
        .collect();
    assert_eq!(times, (1..=n).collect::<Vec<_>>());
    assert_eq!(ordered.left_out().late, 0);
    // One that comes 9000 messages late is counted, and the others are read.
    let mut late = shuffled;
    late.push(message(5, 20_000));
    let late = log(&folder, "", &late).unwrap();
    assert_eq!(i64::try_from(readings(&late).len()).unwrap(), n);
    assert_eq!(late.left_out().late, 1);
    // By the recorder's clock every one is in its place.
    let recorded = log(
        &folder,
        "[topics]\ntime = \"log\"",
        &[message(9, 100), message(3, 200)],
    )
    .unwrap();
    let times: Vec<i64> = readings(&recorded)
        .iter()
        .map(|record| record.time_ns)
        .collect();
    assert_eq!(times, [100, 200]);
}

#[test]
fn stamps_of_two_clocks_give_way_to_the_recorders() {
    let folder = Folder::new("clocks");
    let second = 1_000_000_000;
    let gyro = imu(5 * second, [0.0, 0.0, 0.1], [0.0, 0.0, 9.8], [0.0; 3]);
    let messages = [
        joints(1_700_000_000 * second, &[0.1, 0.2], &[]),
        ("/imu", IMU, 1_700_000_001 * second, gyro),
    ];
    let log = log(&folder, "", &messages).unwrap();
    assert!(
        log.notes()
            .last()
            .unwrap()
            .contains("times of recording are used"),
        "{:?}",
        log.notes()
    );
    let times: Vec<i64> = readings(&log)
        .iter()
        .map(|record| record.time_ns / second)
        .collect();
    assert_eq!(times, [1_700_000_000, 1_700_000_000, 1_700_000_001]);
}

#[test]
fn typed_readings_written_as_messages_are_the_same_again() {
    let folder = Folder::new("again");
    let at = |time_ns, measurement| Sample {
        time_ns,
        measurement,
    };
    let (rates, torques) = ([0.5, -0.25], [0.125, 3.0]);
    let mut all = Vec::new();
    for time_ns in [1_000_000, 2_000_000] {
        for wheel in 0..2 {
            let rate = rates[wheel];
            all.push(at(time_ns, Measurement::WheelRate { wheel, rate }));
            let torque = torques[wheel];
            all.push(at(time_ns, Measurement::WheelTorque { wheel, torque }));
        }
        all.push(at(time_ns, Measurement::YawRate { rate: 0.2 }));
        let (forward, left) = (0.4, -0.1);
        all.push(at(time_ns, Measurement::Acceleration { forward, left }));
    }
    // An angle of one wheel alone: it shares no message with the rates of both.
    let (wheel, angle) = (1, 7.5);
    all.push(at(3_000_000, Measurement::WheelAngle { wheel, angle }));
    let path = folder.0.join("again.mcap");
    let names = ["left", "right"].map(String::from);
    let mut writer = SampleWriter::new(File::create(&path).unwrap(), &names).unwrap();
    for record in &all {
        writer.sample(record).unwrap();
    }
    let (_, messages) = writer.finish().unwrap();
    assert_eq!(messages, 2 * 2 + 1);
    let text = format!("format = 1\nname = \"cart\"\n{WHEELS}");
    let robot = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    let log = Log::find_any(&[path], None, &robot.topics).unwrap();
    let plain = |records: &[Sample]| -> Vec<String> {
        let mut out: Vec<_> = records
            .iter()
            .map(|record| format!("{} {:?}", record.time_ns, record.measurement))
            .collect();
        out.sort();
        out
    };
    assert_eq!(plain(&readings(&log)), plain(&all));
}

#[test]
fn the_robot_file_names_the_forward_axis_of_an_imu() {
    let folder = Folder::new("imu-forward");
    // Mounted backwards: x to the rear, y to the right, z up.
    let messages = [(
        "/imu",
        IMU,
        2,
        imu(2, [0.0, 0.0, 0.2], [-0.5, 0.1, 9.8], [0.0; 3]),
    )];
    let log = log(
        &folder,
        "[topics]\nimu_up = \"z\"\nimu_forward = \"-x\"",
        &messages,
    )
    .unwrap();
    let found: Vec<Measurement> = readings(&log).iter().map(|s| s.measurement).collect();
    let (forward, left) = (0.5, -0.1);
    assert!(
        found.contains(&Measurement::Acceleration { forward, left }),
        "{found:?}"
    );
    assert!(log.notes().is_empty(), "{:?}", log.notes());

    // Without the axis the accelerations are not used, and a note says so.
    let log = self::log(&folder, "", &messages).unwrap();
    assert_eq!(readings(&log).len(), 1);
    let notes = log.notes().join("\n");
    assert!(notes.contains("imu_forward"), "{notes}");
}

#[test]
fn a_gnss_velocity_is_a_speed_and_no_command() {
    let folder = Folder::new("gnss-velocity");
    let twist =
        |time_ns| build::twist_stamped(build::header(time_ns, "gps"), [-0.3, 0.4, 0.0], [0.0; 3]);
    let kind = "geometry_msgs/TwistStamped";
    let messages = [
        ("/gps/velocity", kind, 5, twist(5)),
        ("/cmd_vel", kind, 6, twist(6)),
    ];
    let log = log(&folder, "", &messages).unwrap();
    let found: Vec<Measurement> = readings(&log).iter().map(|s| s.measurement).collect();
    // to the east and north: its size is the robot's speed
    let (forward, left) = (0.5, None);
    assert_eq!(found[0], Measurement::Speed { forward, left });
    assert!(matches!(found[1], Measurement::Command { .. }));
    let path = folder.0.join("log.mcap");
    let survey = grouser_log::Survey::read(&path, |_| ()).unwrap();
    let uses: Vec<_> = survey
        .topics
        .iter()
        .map(|topic| topic.use_for.unwrap())
        .collect();
    assert_eq!(uses, [grouser_log::Use::Motion, grouser_log::Use::Command]);
}

#[test]
fn wheels_are_found_by_their_own_names_where_their_joints_are_not() {
    let folder = Folder::new("own-names");
    let path = folder.0.join("log.mcap");
    let names = ["left", "right"].map(String::from);
    let mut writer = SampleWriter::new(File::create(&path).unwrap(), &names).unwrap();
    let (wheel, angle) = (0, 7.5);
    let measurement = Measurement::WheelAngle { wheel, angle };
    let sample = Sample {
        time_ns: 5,
        measurement,
    };
    writer.sample(&sample).unwrap();
    writer.finish().unwrap();
    let wheels = WHEELS.replace(
        "name = \"left\"",
        "name = \"left\"\njoint = \"base_to_left\"",
    );
    let text = format!("format = 1\nname = \"cart\"\n{wheels}");
    let robot = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    let log = Log::find_any(&[path], None, &robot.topics).unwrap();
    assert_eq!(readings(&log), [sample]);
}

#[test]
fn sinkages_and_entry_angles_are_read_by_their_interfaces() {
    let folder = Folder::new("contacts");
    let path = folder.0.join("log.mcap");
    let names = ["left", "right"].map(String::from);
    let mut writer = SampleWriter::new(File::create(&path).unwrap(), &names).unwrap();
    let at = |time_ns, measurement| Sample {
        time_ns,
        measurement,
    };
    let (wheel, angle, depth) = (0, 0.5, 0.0125);
    let samples = [
        at(5, Measurement::WheelAngle { wheel, angle: 7.5 }),
        at(5, Measurement::Sinkage { wheel, depth }),
        at(5, Measurement::EntryAngle { wheel, angle }),
        at(9, Measurement::EntryAngle { wheel: 1, angle }),
    ];
    for sample in &samples {
        writer.sample(sample).unwrap();
    }
    writer.finish().unwrap();
    let robot = |topics: &str| {
        let text = format!("format = 1\nname = \"cart\"\n{topics}\n{WHEELS}");
        robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap()
    };
    let paths = [path];
    for topics in ["", "[topics]\ncontact = \"/wheel_contacts\""] {
        let log = Log::find_any(&paths, None, &robot(topics).topics).unwrap();
        let mut found = readings(&log);
        found.sort_by_key(|sample| !sample.measurement.is_rotation());
        assert_eq!(found, samples);
        assert!(log.measures_wheel(Meaning::Sinkage, "left"));
        // of the right wheel the first messages show none
        assert!(!log.measures_wheel(Meaning::Sinkage, "right"));
    }
    let wrong = robot("[topics]\ncontact = \"/joint_states\"");
    let error = Log::find_any(&paths, None, &wrong.topics).unwrap_err();
    assert!(error.to_string().contains("entry_angle"), "{error}");
}

#[test]
fn a_distance_from_the_ground_is_a_sinkage() {
    let column = "column = \"range_mm\", meaning = \"sinkage\", wheel = \"left\", unit = \"mm\"";
    let map = |column: &str| {
        let text = format!(
            "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [{{ {column} }}]\n"
        );
        grouser_files::columns::parse(&Document::from_text("map", text).unwrap())
    };
    let map_of_range = map(&format!("{column}, scale = -1.0, offset_m = 0.12")).unwrap();
    let again = grouser_files::columns::to_toml(&map_of_range);
    let again =
        grouser_files::columns::parse(&Document::from_text("again", again).unwrap()).unwrap();
    assert_eq!(again, map_of_range);
    let bytes = std::io::Cursor::new("t,range_mm\n0,120\n1,\n2,95\n".as_bytes());
    let topics = grouser_files::topics::Topics::default();
    let log = Log::over("log.csv".as_ref(), bytes, Some(map_of_range), &topics).unwrap();
    let depths: Vec<f64> = readings(&log)
        .iter()
        .map(|sample| match sample.measurement {
            Measurement::Sinkage { wheel: 0, depth } => depth,
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(depths.len(), 2);
    assert!(
        depths[0].abs() < 1e-15 && (depths[1] - 0.025).abs() < 1e-15,
        "{depths:?}"
    );
    let torque = "column = \"a\", meaning = \"wheel_torque\", wheel = \"left\", unit = \"N m\"";
    let error = map(&format!("{torque}, offset_m = 0.1")).unwrap_err();
    assert!(
        error.to_string().contains("belongs to `sinkage`"),
        "{error}"
    );
}

#[test]
fn a_table_may_lack_a_column_that_is_optional() {
    let read = |keys: &str, table: &'static str| {
        let text = format!(
            "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n\
             {{ column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" }},\n{{ column = \"z\", {keys} }}]\n"
        );
        let map = grouser_files::columns::parse(&Document::from_text("map", text).unwrap());
        let map = map.map_err(|error| error.to_string())?;
        let topics = grouser_files::topics::Topics::default();
        let bytes = std::io::Cursor::new(table.as_bytes());
        let log = Log::over("log.csv".as_ref(), bytes, Some(map), &topics);
        let log = log.map_err(|error| error.to_string())?;
        let samples = log.samples(&[]).map_err(|error| error.to_string())?;
        Ok::<usize, String>(samples.count())
    };
    let (with, without) = (
        "t,z,gyro\n0,0.01,0.1\n1,0.02,0.1\n",
        "t,gyro\n0,0.1\n1,0.1\n",
    );
    let sinkage = "meaning = \"sinkage\", wheel = \"left\", unit = \"m\"";
    let optional = format!("{sinkage}, optional = true");
    assert_eq!(
        (read(&optional, with), read(&optional, without)),
        (Ok(4), Ok(2))
    );
    assert!(
        read(sinkage, without)
            .unwrap_err()
            .contains("no column `z`")
    );
    let torque = "meaning = \"wheel_torque\", wheel = \"left\", unit = \"N m\", optional = true";
    let refused = read(torque, with).unwrap_err();
    assert!(
        refused.contains("belongs to what no slip needs"),
        "{refused}"
    );
}

/// 20.5 ft and 0.1 ft are a turn apart but for 0.07 rad, taken for radians.
#[test]
fn ways_of_rims_keep_their_unit_and_are_not_put_together_as_angles() {
    let map = |second: &str| {
        let text = format!(
            "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n\
             {{ column = \"way\", meaning = \"wheel_distance\", wheel = \"left\", unit = \"ft\" }},\n{second}]\n"
        );
        grouser_files::columns::parse(&Document::from_text("map", text).unwrap())
    };
    let table = std::io::Cursor::new(&b"t,way\n0,20.0\n1,20.5\n2,0.1\n"[..]);
    let topics = grouser_files::topics::Topics::default();
    let log = Log::over("log.csv".as_ref(), table, Some(map("").unwrap()), &topics).unwrap();
    assert!(log.measures_wheel(Meaning::WheelDistance, "left"));
    let ways = log.samples(&[]).unwrap().map(|sample| sample.unwrap());
    let ways: Vec<f64> = ways
        .map(|sample| match sample.measurement {
            Measurement::WheelAngle { wheel: 0, angle } => angle,
            other => panic!("{other:?}"),
        })
        .collect();
    let expected = [6.096, 6.2484, 0.03048]; // m
    let error = |(way, expected): (&f64, f64)| (way - expected).abs();
    assert!(
        ways.iter().zip(expected).map(error).all(|e| e < 1e-12),
        "{ways:?}"
    );
    let angle =
        "{ column = \"angle\", meaning = \"wheel_angle\", wheel = \"left\", unit = \"rad\" }";
    let error = map(angle).unwrap_err().to_string();
    assert!(error.contains("are the same reading"), "{error}");
    assert!(map(&angle.replace("\"left\"", "\"right\"")).is_ok());
}

#[test]
fn dates_are_times_and_rim_speeds_keep_their_unit() {
    let map = "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"date\" }\ncolumns = [\n\
               { column = \"v\", meaning = \"wheel_speed\", wheel = \"left\", unit = \"km/h\" },\n]\n";
    let map =
        grouser_files::columns::parse(&Document::from_text("map", map.into()).unwrap()).unwrap();
    let over = |table: &'static str| {
        let bytes = std::io::Cursor::new(table.as_bytes());
        let topics = grouser_files::topics::Topics::default();
        let log = Log::over("log.csv".as_ref(), bytes, Some(map.clone()), &topics).unwrap();
        assert!(log.measures_wheel(Meaning::WheelSpeed, "left"));
        log.samples(&[]).unwrap().collect::<Result<Vec<_>, _>>()
    };
    let found = over("t,v\n1970-01-01T00:00:01Z,3.6\n1970-01-01 01:00:01.5+01:00,7.2\n").unwrap();
    assert_eq!(
        found.iter().map(|s| s.time_ns).collect::<Vec<_>>(),
        [1_000_000_000, 1_500_000_000]
    );
    let Measurement::WheelRate { rate, .. } = found[1].measurement else {
        panic!("{found:?}")
    };
    assert!(
        (rate - 2.0).abs() < 1e-15,
        "m/s until the radius is known: {rate}"
    );
    let error = over("t,v\n1970-02-30,3.6\n").unwrap_err().to_string();
    assert!(error.contains("must be a date"), "{error}");
}
