//! What a bag or an MCAP file holds: times, gaps and uses of topics, counted by hand.

use std::path::PathBuf;

use grouser_log::message::{Value, build};
use grouser_log::write::{McapWriter, Topic};
use grouser_log::{Error, Survey, Use};

use crate::scratch::Folder;
use crate::written::mcap;

const TWIST: &str = "geometry_msgs/Twist";

/// A file by what `write` puts into it.
fn file(folder: &Folder, name: &str, write: impl FnOnce(&mut McapWriter<Vec<u8>>)) -> PathBuf {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    write(&mut writer);
    folder.file(name, &writer.finish().unwrap())
}

fn survey(write: impl FnOnce(&mut McapWriter<Vec<u8>>)) -> Survey {
    let folder = Folder::new("survey");
    Survey::read(&file(&folder, "log.mcap", write), |_| ()).unwrap()
}

fn twist() -> Value {
    build::twist([0.2, 0.0, 0.0], [0.0; 3])
}

/// Messages of one topic without stamps, recorded at these times, ms.
fn recorded(times_ms: &[i64]) -> grouser_log::Topic {
    let survey = survey(|writer| {
        let mut topic = writer.topic("/cmd_vel", TWIST).unwrap();
        for time in times_ms {
            writer.send(&mut topic, time * 1_000_000, &twist()).unwrap();
        }
    });
    survey.topics[0].clone()
}

#[test]
fn stamps_have_intervals_gaps_and_jumps() {
    // 5.4 times the median is of the bin before the gaps, 6 times is one; back by 0.1 s is no jump, by more it is
    let steps = [54, 60, -100, -101, 10, -150];
    let steps: Vec<i64> = [[10; 30].as_slice(), &steps].concat();
    let found = survey(|writer| {
        let mut topic = writer.topic("/imu", "sensor_msgs/Imu").unwrap();
        let mut stamp = 1_000_000_000;
        for (number, step) in [0].iter().chain(&steps).enumerate() {
            stamp += step * 1_000_000;
            let value = build::planar_imu(build::header(stamp, "imu"), Some(0.1), None);
            // recorded in bursts of four
            let burst = i64::try_from(number / 4).unwrap();
            writer
                .send(&mut topic, 2_000_000_000 + burst * 40_000_000, &value)
                .unwrap();
        }
    });
    let [imu] = &found.topics[..] else {
        panic!("{found:?}")
    };
    assert_eq!((imu.messages, imu.stamped), (37, true));
    assert_eq!((imu.gaps, imu.jumps), (1, 2));
    assert!((imu.longest_s - 0.06).abs() < 1e-12, "{}", imu.longest_s);
    assert_eq!((imu.first_ns, imu.last_ns), (2_000_000_000, 2_360_000_000));
    assert!((imu.rate_hz.unwrap() - 36.0 / 0.36).abs() < 1e-9);
    assert_eq!(
        (found.first_ns, found.last_ns),
        (Some(2_000_000_000), Some(2_360_000_000))
    );
    assert!((found.duration_s().unwrap() - 0.36).abs() < 1e-12);
    assert_eq!(
        (imu.use_for, found.has(Use::YawRate)),
        (Some(Use::YawRate), true)
    );
    assert!(!found.has(Use::Wheels));
}

#[test]
fn times_of_recording_stand_for_stamps() {
    let found = recorded(&[100, 110, 120, 130, 140, 150, 160, 1160]);
    assert!(!found.stamped);
    // seven intervals have no rhythm, eight have
    assert_eq!(found.gaps, 0);
    assert_eq!(
        recorded(&[100, 110, 120, 130, 140, 150, 160, 170, 1170]).gaps,
        1
    );
    // of as many short as long ones the short are the rhythm
    assert_eq!(recorded(&[0, 10, 20, 30, 40, 140, 240, 340, 440]).gaps, 4);
    assert_eq!(recorded(&[0, 10, 20, 30, 130, 230, 330, 430, 530]).gaps, 0);
    let found = recorded(&[500, 400, 299, 600]);
    assert_eq!(
        (found.jumps, found.first_ns, found.last_ns),
        (1, 299_000_000, 600_000_000)
    );
    assert!((found.longest_s - 0.301).abs() < 1e-12);
    assert_eq!(recorded(&[500]).rate_hz, None);
    assert_eq!(recorded(&[500, 500]).rate_hz, None);
    // 4 bytes of encapsulation and six numbers
    assert_eq!(recorded(&[0, 250, 500]).bytes, 3 * 52);
    assert_eq!(recorded(&[0, 250, 500]).rate_hz, Some(4.0));
}

#[test]
fn what_is_not_decoded_is_counted_with_the_first_reason() {
    let found = survey(|writer| {
        let mut topic = writer.topic("/cmd_vel", TWIST).unwrap();
        for bytes in [&[][..], &[0, 1, 0, 0, 5]] {
            writer.send_encoded(&mut topic, 5, bytes).unwrap();
        }
        writer.send(&mut topic, 6, &twist()).unwrap();
    });
    let topic = &found.topics[0];
    assert_eq!((topic.messages, topic.undecoded), (3, 2));
    let problem = topic.problem.as_deref().unwrap();
    assert!(problem.contains("the encapsulation"), "{problem}");
    // the first that can be decoded says what it is
    assert_eq!(topic.use_for, Some(Use::Command));
}

#[test]
#[allow(clippy::too_many_lines, reason = "one line a type")]
fn every_topic_has_its_use() {
    let header = || build::header(7, "map");
    let numbers = |count| build::numbers(&vec![0.0; count]);
    let odometry = build::message([
        ("header", header()),
        ("child_frame_id", Value::Text("base".into())),
        (
            "pose",
            build::message([
                ("pose", build::pose(0.0, 0.0, 0.0)),
                ("covariance", numbers(36)),
            ]),
        ),
        (
            "twist",
            build::message([("twist", twist()), ("covariance", numbers(36))]),
        ),
    ]);
    let status = build::message([("status", Value::Int(0)), ("service", Value::UInt(1))]);
    let fix = build::message([
        ("header", header()),
        ("status", status),
        ("latitude", Value::Float(45.0)),
        ("longitude", Value::Float(9.0)),
        ("altitude", Value::Float(100.0)),
        ("position_covariance", numbers(9)),
        ("position_covariance_type", Value::UInt(0)),
    ]);
    let transforms = build::message([("transforms", Value::Array(Vec::new()))]);
    let pose = || build::message([("header", header()), ("pose", build::pose(1.0, 2.0, 0.0))]);
    let contacts = |values| build::wheel_contacts(header(), &["left"], &[values]);
    let cases = [
        (
            "/joints",
            "sensor_msgs/JointState",
            build::joint_state(header(), &["left"], [&[1.0], &[], &[]]),
            Some(Use::Wheels),
        ),
        (
            "/ticks",
            "grouser_msgs/WheelTicks",
            build::wheel_ticks(header(), &["right"], &[5]),
            Some(Use::Wheels),
        ),
        (
            "/contacts",
            "control_msgs/DynamicJointState",
            contacts([Some(0.1), None]),
            Some(Use::Contacts),
        ),
        (
            "/states",
            "control_msgs/DynamicJointState",
            contacts([None; 2]),
            None,
        ),
        (
            "/imu",
            "sensor_msgs/Imu",
            build::planar_imu(header(), Some(0.1), None),
            Some(Use::YawRate),
        ),
        (
            "/accelerations",
            "sensor_msgs/Imu",
            build::planar_imu(header(), None, Some([0.0; 2])),
            None,
        ),
        ("/odom", "nav_msgs/Odometry", odometry, Some(Use::Motion)),
        (
            "/pose",
            "geometry_msgs/PoseStamped",
            pose(),
            Some(Use::Motion),
        ),
        (
            "/simulation/truth/pose",
            "geometry_msgs/PoseStamped",
            pose(),
            None,
        ),
        (
            "/way",
            "grouser_msgs/Displacement",
            build::displacement(header(), 1.0, 0.0, None),
            Some(Use::Motion),
        ),
        ("/gps/velocity", TWIST, twist(), Some(Use::Motion)),
        ("/cmd_vel", TWIST, twist(), Some(Use::Command)),
        ("/speed", TWIST, twist(), None),
        ("/fix", "sensor_msgs/NavSatFix", fix, Some(Use::Position)),
        (
            "/tf_static",
            "tf2_msgs/TFMessage",
            transforms,
            Some(Use::Mounting),
        ),
    ];
    let found = survey(|writer| {
        for (name, type_name, value, _) in &cases {
            let mut topic = writer.topic(name, type_name).unwrap();
            writer.send(&mut topic, 5, value).unwrap();
        }
    });
    for (topic, (name, _, _, expected)) in found.topics.iter().zip(&cases) {
        assert_eq!(
            (topic.channel.topic.as_str(), topic.use_for),
            (*name, *expected)
        );
    }
    let joints: Vec<&[String]> = found.topics[..3].iter().map(|t| &t.joints[..]).collect();
    assert_eq!(joints, [["left"], ["right"], ["left"]]);
    assert!(
        found.topics[3..]
            .iter()
            .all(|topic| topic.joints.is_empty())
    );
    let words = [
        (Use::Wheels, "wheel angles or rates"),
        (Use::Contacts, "sinkages, entry angles or encoder edges"),
        (Use::YawRate, "yaw rate"),
        (Use::Motion, "pose and speed"),
        (Use::Command, "commanded speed"),
        (Use::Position, "position on Earth"),
        (Use::Mounting, "mounting of sensors"),
    ];
    assert!(words.iter().all(|(one, words)| one.words() == *words));
}

#[test]
fn joints_are_few_and_have_short_names() {
    let mut names = vec!["a".repeat(257), "b".repeat(256)];
    names.extend((0..70).map(|number| format!("joint_{number}")));
    let found = survey(|writer| {
        let mut topic = writer.topic("/joints", "sensor_msgs/JointState").unwrap();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let value = build::joint_state(build::header(5, ""), &names, [&[], &[], &[]]);
        writer.send(&mut topic, 5, &value).unwrap();
    });
    assert_eq!(found.topics[0].joints, names[1..65]);
}

#[test]
fn files_of_a_run_are_one() {
    let folder = Folder::new("run");
    let send = |writer: &mut McapWriter<Vec<u8>>, topic: &mut Topic, times: [i64; 2]| {
        for time in times {
            writer.send(topic, time, &twist()).unwrap();
        }
    };
    let first = file(&folder, "run_0.mcap", |writer| {
        let mut topic = writer.topic("/cmd_vel", TWIST).unwrap();
        send(writer, &mut topic, [3_000, 1_000]);
    });
    let second = file(&folder, "run_1.mcap", |writer| {
        let mut other = writer.topic("/other", TWIST).unwrap();
        let mut topic = writer.topic("/cmd_vel", TWIST).unwrap();
        send(writer, &mut topic, [4_000, 2_000]);
        send(writer, &mut other, [2_500, 2_600]);
    });
    // the second ends in its middle
    let whole = std::fs::read(&second).unwrap();
    std::fs::write(&second, &whole[..whole.len() - 20]).unwrap();
    let length = |path: &PathBuf| std::fs::metadata(path).unwrap().len();
    let mut seen = Vec::new();
    let run = [first.clone(), second.clone()];
    let found = Survey::read_run(&run, |offset| seen.push(offset)).unwrap();
    assert!(seen.is_sorted());
    assert_eq!(seen.last(), Some(&(length(&first) + length(&second))));
    let counts: Vec<_> = found
        .topics
        .iter()
        .map(|t| (t.channel.topic.as_str(), t.messages))
        .collect();
    assert_eq!(counts, [("/cmd_vel", 4), ("/other", 2)]);
    assert_eq!((found.first_ns, found.last_ns), (Some(1_000), Some(4_000)));
    let alone = Survey::read(&second, |_| ()).unwrap();
    assert!(found.damage_count > 0 && found.damage_count == alone.damage_count);
    assert_eq!(found.bytes_lost, alone.bytes_lost);
    for (here, there) in found.damages.iter().zip(&alone.damages) {
        assert_eq!(here.offset, length(&first) + there.offset);
    }
    let none = Survey::read_run(&[], |_| ()).unwrap_err();
    assert!(matches!(none, Error::Empty { .. }), "{none}");
}

#[test]
fn damages_are_counted_and_the_first_thousand_kept() {
    let mut bytes = mcap::MAGIC.to_vec();
    // two channels of one topic are two
    mcap::channel(&mut bytes, 1, 0, b"/a", b"json");
    mcap::channel(&mut bytes, 2, 0, b"/a", b"ros1");
    let begin = bytes.len() as u64;
    for _ in 0..1001 {
        // a message without its numbers
        mcap::record(&mut bytes, 5, b"x");
    }
    mcap::message(&mut bytes, 1, 5, b"[1]");
    mcap::message(&mut bytes, 2, 6, b"");
    mcap::message(&mut bytes, 2, 7, b"");
    let folder = Folder::new("damages");
    let found = Survey::read(&folder.file("log.mcap", &bytes), |_| ()).unwrap();
    // and the end that is missing
    assert_eq!((found.damage_count, found.damages.len()), (1002, 1000));
    assert_eq!(found.bytes_lost, 1001 * 10);
    let offsets: Vec<u64> = found.damages.iter().take(2).map(|d| d.offset).collect();
    assert_eq!(offsets, [begin, begin + 10]);
    let counts: Vec<u64> = found.topics.iter().map(|topic| topic.messages).collect();
    assert_eq!(counts, [1, 2]);
}

#[test]
fn the_first_message_says_what_a_topic_is() {
    let found = survey(|writer| {
        let mut topic = writer.topic("/joints", "sensor_msgs/JointState").unwrap();
        for (stamp, joint) in [(5, "left"), (0, "right"), (0, "arm")] {
            let value = build::joint_state(build::header(stamp, ""), &[joint], [&[0.5], &[], &[]]);
            writer.send(&mut topic, 7, &value).unwrap();
        }
    });
    let topic = &found.topics[0];
    assert_eq!(
        (topic.joints.as_slice(), topic.stamped),
        (["left".to_owned()].as_slice(), true)
    );
}

#[test]
fn topics_without_messages_are_listed() {
    let mut file = mcap::MAGIC.to_vec();
    mcap::schema(&mut file, 1, b"std_msgs/Float32", b"float32 data");
    for (id, topic) in (1..).zip(["/first", "/silent", "/last"]) {
        mcap::channel(&mut file, id, 1, topic.as_bytes(), b"ros1");
    }
    for time in 1..4 {
        mcap::message(&mut file, 3, time, &[0; 4]);
    }
    let folder = Folder::new("silent");
    let found = Survey::read(&folder.file("log.mcap", &file), |_| ()).unwrap();
    let counts = found.topics.iter();
    let counts: Vec<_> = counts
        .map(|topic| (topic.channel.topic.as_str(), topic.messages))
        .collect();
    assert_eq!(counts, [("/last", 3), ("/first", 0), ("/silent", 0)]);
}

#[test]
fn a_pose_that_nobody_measured_has_no_use() {
    let of = |name: &str| {
        let found = survey(|writer| {
            let mut topic = writer.topic(name, "geometry_msgs/PoseStamped").unwrap();
            let header = build::header(5, "map");
            let pose = build::pose(1.0, 2.0, 0.5);
            let value = build::message([("header", header), ("pose", pose)]);
            writer.send(&mut topic, 5, &value).unwrap();
        });
        found.topics[0].use_for
    };
    assert_eq!(of("/move_base_simple/goal"), None);
    assert_eq!(of("/vicon/pose"), Some(Use::Motion));
}
