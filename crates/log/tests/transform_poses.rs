//! The robot's pose by transforms, beside a composition by matrices of four rows.

use std::io::Cursor;

use grouser_files::columns::Meaning;
use grouser_log::message::{Value, build};
use grouser_log::write::McapWriter;
use grouser_log::{Error, Log, Survey, Use, suggest_for_survey};
use grouser_slip::Measurement as M;

use crate::choosing::topics;
use crate::scratch::Folder;

const MS: i64 = 1_000_000;
const START: i64 = 1_700_000_000_000 * MS;

/// A transform: its stamp (ms from the start), parent, child, translation, and roll, pitch and yaw.
type Link<'a> = (i64, &'a str, &'a str, [f64; 3], [f64; 3]);
/// A message: its topic, when it is recorded (ms from the start), and what it holds.
type Message<'a> = (&'a str, i64, Vec<Link<'a>>);

type Matrix = [[f64; 4]; 4];

/// Of a translation, and of a turn by roll, then pitch, then yaw about the fixed axes.
fn matrix([x, y, z]: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Matrix {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, x],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, y],
        [-sp, cp * sr, cp * cr, z],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

/// The place and the yaw by a product of matrices.
fn composed(all: &[Matrix]) -> [f64; 3] {
    let one: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let product = all.iter().fold(one, |a, b| {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
    });
    [
        product[0][3],
        product[1][3],
        product[1][0].atan2(product[0][0]),
    ]
}

fn transforms(all: &[Link]) -> Value {
    let one = |&(stamp, parent, child, translation, turn): &Link| {
        build::message([
            ("header", build::header(START + stamp * MS, parent)),
            ("child_frame_id", Value::Text(child.into())),
            (
                "transform",
                build::message([
                    ("translation", build::vector(translation)),
                    ("rotation", build::orientation(turn)),
                ]),
            ),
        ])
    };
    build::message([("transforms", Value::Array(all.iter().map(one).collect()))])
}

/// A file of these messages and of the wheels' joints on `wheels`.
fn file(messages: &[Message], wheels: &str) -> Vec<u8> {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let mut joints = writer.topic(wheels, "sensor_msgs/JointState").unwrap();
    let state = build::joint_state(
        build::header(START, ""),
        &["left", "right"],
        [&[], &[1.0, 1.0], &[]],
    );
    writer.send(&mut joints, START, &state).unwrap();
    let mut known: Vec<(&str, _)> = Vec::new();
    for (name, time, all) in messages {
        let place = known
            .iter()
            .position(|(own, _)| own == name)
            .unwrap_or_else(|| {
                known.push((name, writer.topic(name, "tf2_msgs/TFMessage").unwrap()));
                known.len() - 1
            });
        let value = transforms(all);
        writer
            .send(&mut known[place].1, START + time * MS, &value)
            .unwrap();
    }
    writer.finish().unwrap()
}

fn opened(bytes: Vec<u8>, wanted: &str) -> Result<Log, Error> {
    Log::over(
        "run.mcap".as_ref(),
        Cursor::new(bytes),
        None,
        &topics(wanted),
    )
}

fn log(messages: &[Message], wanted: &str) -> Log {
    opened(file(messages, "/joint_states"), wanted).unwrap()
}

/// Poses with their times, ms from the start.
fn poses(log: &Log) -> Vec<(i64, [f64; 3])> {
    let samples = log.samples(&[]).unwrap().map(Result::unwrap);
    let pose = samples.filter_map(|sample| match sample.measurement {
        M::Pose { x, y, yaw } => Some(((sample.time_ns - START) / MS, [x, y, yaw])),
        _ => None,
    });
    let found = pose.collect();
    assert_eq!(log.left_out().late, 0);
    found
}

fn assert_close(found: &[(i64, [f64; 3])], expected: &[(i64, [f64; 3])]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        let is_close = found
            .1
            .iter()
            .zip(expected.1)
            .all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(
            found.0 == expected.0 && is_close,
            "{found:?} and {expected:?}"
        );
    }
}

/// The k-th reading of an odometry that drives an arc on a slope.
fn odometry(k: i64) -> ([f64; 3], [f64; 3]) {
    let s = 0.02 * k as f64;
    ([s, 0.1 * s * s, 0.01 * s], [0.02, -0.05, 0.2 * s])
}

fn moved<'a>(k: i64, parent: &'a str, child: &'a str) -> Link<'a> {
    let (place, turn) = odometry(k);
    (20 * k, parent, child, place, turn)
}

const MOUNTED: ([f64; 3], [f64; 3]) = ([-0.3, 0.1, 0.05], [0.01, 0.02, 0.4]);

/// A map that is corrected at 200 and at 600 ms, and sent again, 500 ms ahead of its time, each 40 ms between them; below it
/// an odometry's frame and a base that is fixed to what the odometry moves. What is fixed was sent an hour before.
fn localised() -> (Vec<Message<'static>>, Vec<(i64, [f64; 3])>) {
    let corrections: [([f64; 3], [f64; 3]); 2] = [
        ([5.0, -2.0, 0.1], [0.0, 0.01, 1.1]),
        ([5.2, -2.1, 0.1], [0.0, 0.01, 1.2]),
    ];
    let mut messages = vec![(
        "/tf_static",
        0,
        vec![(
            -3_600_000,
            "base_footprint",
            "base_link",
            MOUNTED.0,
            MOUNTED.1,
        )],
    )];
    let mut expected = Vec::new();
    for k in 0..50 {
        let time = 20 * k;
        if time >= 200 && time % 40 == 0 {
            let (place, turn) = corrections[usize::from(time >= 600)];
            messages.push(("/tf", time, vec![(time + 500, "map", "odom", place, turn)]));
            if time == 200 || time == 600 {
                let own = odometry(k);
                let all = [(place, turn), own, MOUNTED].map(|(place, turn)| matrix(place, turn));
                expected.push((time, composed(&all)));
            }
        }
        messages.push(("/tf", time, vec![moved(k, "odom", "base_footprint")]));
    }
    (messages, expected)
}

#[test]
fn a_pose_is_what_localisation_corrects() {
    let (messages, expected) = localised();
    let found = log(&messages, "");
    assert!(found.measures(Meaning::PoseX));
    assert_close(&poses(&found), &expected);
    let used: Vec<String> = found
        .topics()
        .map(|topic| format!("{}: {}", topic.topic, topic.used_for))
        .collect();
    assert_eq!(
        used[1..],
        [
            "/tf_static: frames that do not move",
            "/tf: pose of `base_link` in `map`"
        ]
    );
    // the stamps of what is fixed are no clock
    assert!(
        found.notes().iter().all(|note| !note.contains("apart")),
        "{:?}",
        found.notes()
    );
    // named alike, and by its frames with a slash in front
    for wanted in [
        "pose = \"/tf\"\n",
        "pose = \"/tf\"\npose_frame = \"/map\"\npose_child_frame = \"/base_link\"\n",
    ] {
        assert_close(&poses(&log(&messages, wanted)), &expected);
    }
    // who names the odometry's own frame says that it measures the ground
    let by_odometry = log(&messages, "pose = \"/tf\"\npose_frame = \"odom\"\n");
    let expected: Vec<_> = (0..50)
        .map(|k| {
            let all = [odometry(k), MOUNTED].map(|(place, turn)| matrix(place, turn));
            (20 * k, composed(&all))
        })
        .collect();
    assert_close(&poses(&by_odometry), &expected);
    // what is ignored is not used
    let ignored = log(&messages, "ignore = [\"/tf\"]\n");
    assert!(!ignored.measures(Meaning::PoseX) && ignored.topics().count() == 1);
}

#[test]
fn what_never_moves_is_known_in_every_file_of_a_run() {
    let (messages, expected) = localised();
    let (first, second) = messages.split_at(40);
    let files = [("run_0.mcap", first), ("run_1.mcap", second)]
        .map(|(name, part)| (name.into(), Cursor::new(file(part, "/joint_states"))));
    let found = Log::over_all(files, None, &topics("")).unwrap();
    let all = poses(&found);
    assert_close(&all[..1], &expected[..1]);
    assert_close(&all[all.len() - 1..], &expected[1..]);
}

#[test]
fn a_tracker_measures_at_every_transform() {
    for (fixed, body) in [
        ("/world", "/vicon/jackal/jackal"),
        ("mocap", "rigid_body_1"),
        ("map", "base_link"),
        ("camera_odom_frame", "base_link"),
    ] {
        let messages: Vec<Message> = (0..5)
            .map(|k| ("/tf", 20 * k, vec![moved(k, fixed, body)]))
            .collect();
        let expected: Vec<_> = (0..5)
            .map(|k| {
                let (place, turn) = odometry(k);
                (20 * k, composed(&[matrix(place, turn)]))
            })
            .collect();
        assert_close(&poses(&log(&messages, "")), &expected);
    }
}

#[test]
fn an_odometry_alone_is_named_and_not_used() {
    let messages: Vec<Message> = (0..5)
        .map(|k| ("/tf", 20 * k, vec![moved(k, "odom", "base_link")]))
        .collect();
    let found = log(&messages, "");
    assert!(poses(&found).is_empty() && !found.measures(Meaning::PoseX));
    let notes = found.notes().join("\n");
    assert!(
        notes.contains("`base_link` in `odom`")
            && notes.contains("as `pose` if it measures the ground"),
        "{notes}"
    );
    assert_eq!(poses(&log(&messages, "pose = \"/tf\"\n")).len(), 5);
}

#[test]
fn an_odometry_beside_a_measured_speed_needs_no_note() {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let mut tf = writer.topic("/tf", "tf2_msgs/TFMessage").unwrap();
    let mut speeds = writer
        .topic("/radar", "geometry_msgs/TwistStamped")
        .unwrap();
    for k in 0..5 {
        let time_ns = START + 20 * k * MS;
        let value = transforms(&[moved(k, "odom", "base_link")]);
        writer.send(&mut tf, time_ns, &value).unwrap();
        let header = build::header(time_ns, "base_link");
        let value = build::twist_stamped(header, [0.3, 0.0, 0.0], [0.0; 3]);
        writer.send(&mut speeds, time_ns, &value).unwrap();
    }
    let bytes = writer.finish().unwrap();
    let notes = |wanted: &str| opened(bytes.clone(), wanted).unwrap().notes().join("\n");
    assert!(notes("").contains("the transforms hold a pose"));
    assert_eq!(notes("speed = \"/radar\"\n"), "");
}

#[test]
fn transforms_of_other_topics_are_not_those_that_are_named() {
    // a localisation on a topic of its own; the odometry that is named counts without it, but with what never moves
    let (messages, _) = localised();
    let apart = messages.into_iter().map(|(topic, time, all)| {
        let is_map = all[0].1 == "map";
        (if is_map { "/tf_map" } else { topic }, time, all)
    });
    let apart: Vec<Message> = apart.collect();
    let expected: Vec<_> = (0..50)
        .map(|k| {
            let all = [odometry(k), MOUNTED].map(|(place, turn)| matrix(place, turn));
            (20 * k, composed(&all))
        })
        .collect();
    assert_close(&poses(&log(&apart, "pose = \"/tf\"\n")), &expected);
}

#[test]
fn transforms_that_are_ignored_move_nothing() {
    let (mut messages, expected) = localised();
    // another localisation between: of the same frames, elsewhere
    for k in 11..50 {
        let wrong = (
            20 * k,
            "map",
            "odom",
            [90.0, 0.0, 0.0],
            [0.0, 0.0, 0.01 * k as f64],
        );
        messages.push(("/other/tf", 20 * k + 1, vec![wrong]));
    }
    messages.sort_by_key(|message| message.1);
    let found = log(&messages, "ignore = [\"/other/tf\"]\n");
    assert_close(&poses(&found), &expected);
    assert!(found.topics().all(|topic| topic.topic != "/other/tf"));
    assert!(poses(&log(&messages, "")).len() > expected.len());
}

#[test]
fn a_transform_that_comes_too_late_is_counted() {
    // more than are held back before one of long ago
    let mut messages: Vec<Message> = (0..5000)
        .map(|k| ("/tf", 20 * k, vec![moved(k, "map", "base_link")]))
        .collect();
    messages.push(("/tf", 20 * 5000, vec![moved(1, "map", "base_link")]));
    let found = log(&messages, "");
    let poses = found.samples(&[]).unwrap().map(Result::unwrap);
    let is_pose = |sample: &grouser_slip::Sample| matches!(sample.measurement, M::Pose { .. });
    assert_eq!(poses.filter(is_pose).count(), 5000);
    assert_eq!(found.left_out().late, 1);
}

#[test]
fn of_several_robots_that_of_the_wheels_counts() {
    let both = |k: i64| {
        let (place, turn) = odometry(k);
        let other = (
            20 * k,
            "map",
            "r2/base_link",
            [9.0 + place[0], 9.0, 0.0],
            turn,
        );
        ("/tf", 20 * k, vec![moved(k, "map", "r1/base_link"), other])
    };
    let messages: Vec<Message> = (0..5).map(both).collect();
    let first = |wheels: &str, wanted: &str| {
        let found = opened(file(&messages, wheels), wanted).unwrap();
        poses(&found).first().map(|(_, pose)| pose[0])
    };
    assert_eq!(first("/r1/joint_states", ""), Some(0.0));
    assert_eq!(first("/fleet/r2/joint_states", ""), Some(9.0));
    assert_eq!(
        first(
            "/joint_states",
            "pose = \"/tf\"\npose_child_frame = \"r2/base_link\"\n"
        ),
        Some(9.0)
    );
    // whose they are is not known
    let unknown = opened(file(&messages, "/joint_states"), "").unwrap();
    assert!(poses(&unknown).is_empty());
    let notes = unknown.notes().join("\n");
    assert!(
        notes.contains(
            "a pose (`r1/base_link` in `map`, `r2/base_link` in `map`) that is of several robots"
        ),
        "{notes}"
    );
    let error = opened(file(&messages, "/joint_states"), "pose = \"/tf\"\n").unwrap_err();
    assert!(
        error
            .to_string()
            .contains("several: `r1/base_link` in `map`"),
        "{error}"
    );
    assert!(error.hint().unwrap().contains("`pose_child_frame`"));
}

#[test]
fn what_leads_nowhere_is_no_pose() {
    let none = ([0.0; 3], [0.0; 3]);
    let link = |k: i64, parent, child| (20 * k, parent, child, none.0, none.1);
    // a frame is missing between them; a circle; a robot that is fixed
    let missing = |k| {
        (
            "/tf",
            20 * k,
            vec![link(k, "map", "odom"), moved(k, "odom_2", "base_link")],
        )
    };
    let circle = |k| {
        (
            "/tf",
            20 * k,
            vec![
                moved(k, "a", "base_link"),
                link(k, "b", "a"),
                link(k, "a", "b"),
            ],
        )
    };
    let fixed = |k| ("/tf_static", 20 * k, vec![link(k, "map", "base_link")]);
    for kind in [
        &missing as &dyn Fn(i64) -> Message<'static>,
        &circle,
        &fixed,
    ] {
        let messages: Vec<Message> = (0..5).map(kind).collect();
        assert!(poses(&log(&messages, "")).is_empty());
        let topic = messages[0].0;
        let wanted = format!("pose = \"{topic}\"\npose_frame = \"map\"\n");
        let error = opened(file(&messages, "/joint_states"), &wanted).unwrap_err();
        assert!(matches!(error, Error::NoFramePose { .. }), "{error}");
    }
    // a rotation that is none gives no pose, and what follows does
    let mut messages: Vec<Message> = (0..3)
        .map(|k| ("/tf", 20 * k, vec![moved(k, "map", "base_link")]))
        .collect();
    messages[1].2[0].3 = [f64::NAN; 3];
    let found = poses(&log(&messages, ""));
    assert!(found.len() == 3 && found[1].1[0].is_nan() && found[2].1[0].is_finite());
}

#[test]
fn a_chain_may_change() {
    // 0 to 4: in the map; then below an odometry that a map holds
    let before = (0..5).map(|k| ("/tf", 20 * k, vec![moved(k, "map", "base_link")]));
    let turned = ([1.0, 2.0, 0.0], [0.0, 0.0, 0.5]);
    let after = (5..10).map(|k| {
        let map = (20 * k, "map", "odom", turned.0, turned.1);
        ("/tf", 20 * k, vec![map, moved(k, "odom", "base_link")])
    });
    let messages: Vec<Message> = before.chain(after).collect();
    let mut expected: Vec<_> = (0..5)
        .map(|k| {
            let (place, turn) = odometry(k);
            (20 * k, composed(&[matrix(place, turn)]))
        })
        .collect();
    let all = [turned, odometry(5)].map(|(place, turn)| matrix(place, turn));
    expected.push((100, composed(&all)));
    assert_close(&poses(&log(&messages, "")), &expected);
}

#[test]
fn a_pose_that_is_typed_counts_before_transforms() {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let mut tf = writer.topic("/tf", "tf2_msgs/TFMessage").unwrap();
    let mut typed = writer
        .topic("/slam/pose", "geometry_msgs/PoseStamped")
        .unwrap();
    for k in 0..5 {
        let value = transforms(&[moved(k, "map", "base_link")]);
        writer.send(&mut tf, START + 20 * k * MS, &value).unwrap();
        let value = build::message([
            ("header", build::header(START + 20 * k * MS, "map")),
            ("pose", build::pose(7.0, 8.0, 0.0)),
        ]);
        writer
            .send(&mut typed, START + 20 * k * MS, &value)
            .unwrap();
    }
    let bytes = writer.finish().unwrap();
    let found = poses(&opened(bytes.clone(), "").unwrap());
    assert!(found.len() == 5 && found.iter().all(|(_, pose)| pose[0] == 7.0));
    let found = poses(&opened(bytes.clone(), "pose = \"/tf\"\n").unwrap());
    assert!(found.len() == 5 && found.iter().all(|(_, pose)| pose[0] < 1.0));
    let error = opened(bytes, "pose = \"/slam/pose\"\npose_frame = \"map\"\n").unwrap_err();
    assert!(
        error
            .to_string()
            .contains("`pose_frame`, which is tf2_msgs/TFMessage"),
        "{error}"
    );
}

#[test]
fn a_survey_and_a_proposal_name_the_pose() {
    let folder = Folder::new("transform-poses");
    let path = folder.0.join("run.mcap");
    let of = |messages: &[Message]| {
        std::fs::write(&path, file(messages, "/joint_states")).unwrap();
        let survey = Survey::read(&path, |_| ()).unwrap();
        let tf = survey
            .topics
            .iter()
            .find(|topic| topic.channel.topic == "/tf")
            .unwrap()
            .clone();
        // corrections stamped ahead are no jumps of a clock
        assert_eq!((tf.jumps, tf.gaps, tf.stamped), (0, 0, false));
        (tf.use_for, tf.moves, suggest_for_survey(&survey))
    };
    let (used, moves, robot) = of(&localised().0);
    assert_eq!(used, Some(Use::Transforms));
    assert_eq!(moves, Some(("base_link".to_owned(), "map".to_owned())));
    assert!(
        robot.contains("# pose = \"/tf\"  # \"base_link\" in \"map\": used without this line"),
        "{robot}"
    );
    let odometry: Vec<Message> = (0..5)
        .map(|k| ("/tf", 20 * k, vec![moved(k, "odom", "base_link")]))
        .collect();
    let (used, moves, robot) = of(&odometry);
    assert_eq!(used, Some(Use::Mounting));
    assert_eq!(moves, Some(("base_link".to_owned(), "odom".to_owned())));
    assert!(
        robot.contains("# pose = \"/tf\"  # \"base_link\" in \"odom\": if it measures the ground"),
        "{robot}"
    );
}
