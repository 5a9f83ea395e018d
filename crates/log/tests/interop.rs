//! Logs exchanged with code that is not ours, both ways, equal to the bit: `mcap-ros2-support` and `rosbags`
//! in a Python that `GROUSER_PYTHON` names (`.ci/run` makes one). Without it the tests say that they are
//! skipped.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use grouser_log::Log;
use grouser_log::container::{Container, Event, Format};
use grouser_log::message::{Decoder, Value, build, known};
use grouser_log::write::{McapWriter, copy, verify};
use grouser_slip::Measurement;

use crate::scratch::Folder;

/// Runs the other side; false (said on stderr) where there is no Python for it.
fn exchange(job: &str, arguments: &[&Path]) -> bool {
    let Some(python) = std::env::var_os("GROUSER_PYTHON") else {
        eprintln!("skipped: GROUSER_PYTHON names no Python with rosbags and mcap-ros2-support");
        return false;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/interop/exchange.py");
    let done = Command::new(python)
        .arg(script)
        .arg(job)
        .args(arguments)
        .output()
        .unwrap();
    let reported = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{job}: {reported}");
    true
}

/// What a message holds, one line a leaf, as exchange.py tells it.
fn tell(who: &str, topic: &str, time: u64, value: &Value, path: &str, lines: &mut String) {
    let leaf = match value {
        Value::Struct(fields) => {
            for (name, value) in fields {
                let dot = if path.is_empty() { "" } else { "." };
                tell(
                    who,
                    topic,
                    time,
                    value,
                    &format!("{path}{dot}{name}"),
                    lines,
                );
            }
            return;
        }
        Value::Array(values) => {
            for (place, value) in values.iter().enumerate() {
                tell(who, topic, time, value, &format!("{path}[{place}]"), lines);
            }
            return;
        }
        Value::Bytes(bytes) => {
            for (place, byte) in bytes.iter().enumerate() {
                writeln!(lines, "{who}\t{topic}\t{time}\t{path}[{place}]\ti{byte}").unwrap();
            }
            return;
        }
        Value::Bool(value) => format!("b{}", u8::from(*value)),
        Value::Int(number) => format!("i{number}"),
        Value::UInt(number) => format!("i{number}"),
        Value::Float(number) => format!("f{:016x}", number.to_bits()),
        Value::Text(text) => text.bytes().fold("s".to_owned(), |mut hex, byte| {
            write!(hex, "{byte:02x}").unwrap();
            hex
        }),
        other => panic!("{other:?}"),
    };
    writeln!(lines, "{who}\t{topic}\t{time}\t{path}\t{leaf}").unwrap();
}

/// All that a file holds, as it is read here.
fn reported(path: &Path, who: &str) -> String {
    let mut container = Container::open(path).unwrap();
    let mut decoders = BTreeMap::new();
    let mut lines = String::new();
    while let Some(event) = container.next() {
        let Event::Message(message) = event else {
            panic!("{}: {event:?}", path.display());
        };
        let decoder = decoders
            .entry(message.channel)
            .or_insert_with(|| Decoder::new(message.of).unwrap());
        let value = decoder.decode(message.data).unwrap();
        tell(
            who,
            &message.of.topic,
            message.log_time_ns,
            &value,
            "",
            &mut lines,
        );
    }
    lines
}

/// The two must be the same; the first line that is not is shown.
fn same(ours: &str, theirs: &str, of: &str) {
    assert!(!theirs.is_empty(), "{of}: nothing");
    let differing = ours.lines().zip(theirs.lines()).find(|(a, b)| a != b);
    assert!(ours == theirs, "{of}: {differing:?}");
}

fn of(all: &str, who: &str) -> String {
    let start = format!("{who}\t");
    let lines = all.lines().filter(|line| line.starts_with(&start));
    lines.flat_map(|line| [line, "\n"]).collect()
}

#[test]
fn what_others_write_is_read_to_the_bit() {
    let folder = Folder::new("others-write");
    if !exchange("write", &[&folder.0]) {
        return;
    }
    let expected = fs::read_to_string(folder.0.join("expected.tsv")).unwrap();
    let files: BTreeSet<&str> = expected
        .lines()
        .filter_map(|line| line.split('\t').next())
        .collect();
    assert_eq!(files.len(), 8, "{files:?}");
    for file in files {
        same(
            &reported(&folder.0.join(file), file),
            &of(&expected, file),
            file,
        );
    }
    // A bag written anew is read by others as the one that they wrote.
    for name in ["rosbags_none.bag", "rosbags_bz2.bag", "rosbags_lz4.bag"] {
        let (bag, lines) = (folder.0.join("again.bag"), folder.0.join("again.tsv"));
        let file = File::create(&bag).unwrap();
        let copied = copy(&folder.0.join(name), file, Format::Bag, |_| ()).unwrap();
        verify(&bag, &copied).unwrap();
        exchange("read", &[&bag, &lines]);
        let theirs = fs::read_to_string(&lines).unwrap();
        same(&of(&expected, name).replace(name, "rosbags"), &theirs, name);
    }
}

/// Numbers that look random, and are the same in every run.
struct Dice(u64);

impl Dice {
    fn bits(&mut self) -> u64 {
        // Knuth's MMIX generator; its high bits, twice.
        let mut half = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            self.0 >> 32
        };
        half() << 32 | half()
    }

    fn number(&mut self) -> f64 {
        let special = [
            0.0,
            -0.0,
            f64::INFINITY,
            f64::MAX,
            f64::MIN_POSITIVE / 3.0,
            f64::NAN,
        ];
        match self.bits() % 16 {
            kind @ 0..6 => special[usize::try_from(kind).unwrap()],
            _ => Some(f64::from_bits(self.bits()))
                .filter(|n| !n.is_nan())
                .unwrap_or(1.5),
        }
    }

    fn numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.number())
    }
}

/// A message of each type that is written, full of such numbers.
fn messages(dice: &mut Dice, time_ns: i64) -> Vec<(&'static str, &'static str, Value)> {
    let head = || build::header(time_ns, "räder");
    let names = ["left", "右"];
    let covariance = |dice: &mut Dice| build::numbers(&dice.numbers::<36>());
    let pose = build::message([
        ("position", build::vector(dice.numbers())),
        ("orientation", build::turn(0.3)),
    ]);
    let odometry = build::message([
        ("header", head()),
        ("child_frame_id", Value::Text("base_link".into())),
        (
            "pose",
            build::message([("pose", pose.clone()), ("covariance", covariance(dice))]),
        ),
        (
            "twist",
            build::message([
                ("twist", build::twist(dice.numbers(), dice.numbers())),
                ("covariance", covariance(dice)),
            ]),
        ),
    ]);
    let slip = build::message([
        ("header", head()),
        ("name", build::texts(&names)),
        ("slip", build::numbers(&dice.numbers::<2>())),
        ("slip_sigma", build::numbers(&dice.numbers::<2>())),
        ("motion", build::texts(&["Driving", ""])),
        ("health", build::texts(&["Degraded(Relative)", "Ok"])),
    ]);
    let value = build::message([
        ("key", Value::Text("slip".into())),
        ("value", Value::Text("0.1".into())),
    ]);
    let status = build::message([
        ("level", Value::UInt(dice.bits() % 4)),
        ("name", Value::Text("slip of left".into())),
        ("message", Value::Text("Ok".into())),
        ("hardware_id", Value::Text(String::new())),
        ("values", Value::Array(vec![value.clone(), value])),
    ]);
    let diagnostics = build::message([("header", head()), ("status", Value::Array(vec![status]))]);
    let transform = build::message([
        ("header", head()),
        ("child_frame_id", Value::Text("imu".into())),
        (
            "transform",
            build::message([
                ("translation", build::vector(dice.numbers())),
                ("rotation", build::turn(1.0)),
            ]),
        ),
    ]);
    let ticks = [dice.bits(), u64::MAX];
    vec![
        (
            "/joints",
            "sensor_msgs/JointState",
            build::joint_state(head(), &names, [&dice.numbers::<2>(), &[], &[]]),
        ),
        (
            "/imu",
            "sensor_msgs/Imu",
            build::planar_imu(head(), Some(dice.number()), None),
        ),
        ("/odom", "nav_msgs/Odometry", odometry),
        (
            "/pose",
            "geometry_msgs/PoseStamped",
            build::message([("header", head()), ("pose", pose)]),
        ),
        (
            "/speed",
            "geometry_msgs/TwistStamped",
            build::twist_stamped(head(), dice.numbers(), dice.numbers()),
        ),
        ("/slip", known::WHEEL_SLIP, slip),
        (
            "/ticks",
            known::WHEEL_TICKS,
            build::wheel_ticks(head(), &names, &ticks),
        ),
        (
            "/way",
            known::DISPLACEMENT,
            build::displacement(head(), dice.number(), 0.5, None),
        ),
        (
            "/diagnostics",
            "diagnostic_msgs/DiagnosticArray",
            diagnostics,
        ),
        (
            "/tf_static",
            "tf2_msgs/TFMessage",
            build::message([("transforms", Value::Array(vec![transform]))]),
        ),
    ]
}

/// A picture of two parts.
fn robot(dice: &mut Dice, time_ns: i64) -> (&'static str, &'static str, Value) {
    let header = build::header(time_ns, "odom");
    let parts = [1, 3].map(|kind| marker(header.clone(), dice, kind));
    let value = build::message([("markers", Value::Array(parts.to_vec()))]);
    ("/robot", "visualization_msgs/MarkerArray", value)
}

/// `visualization_msgs/Marker` of a kind, with all of its fields.
fn marker(header: Value, dice: &mut Dice, kind: i64) -> Value {
    let text = |text: &str| Value::Text(text.into());
    let colour = |r| {
        let part = |name, value| (name, Value::Float(value));
        build::message([
            part("r", r),
            part("g", 0.25),
            part("b", 0.5),
            part("a", 1.0),
        ])
    };
    let nothing = || Value::Array(Vec::new());
    build::message([
        ("header", header.clone()),
        ("ns", text("wheels")),
        ("id", Value::Int(7)),
        ("type", Value::Int(kind)),
        ("action", Value::Int(0)),
        (
            "pose",
            build::message([
                ("position", build::vector(dice.numbers())),
                ("orientation", build::orientation([0.1, 0.2, 0.3])),
            ]),
        ),
        ("scale", build::vector(dice.numbers())),
        ("color", colour(0.75)),
        (
            "lifetime",
            build::message([("sec", Value::Int(0)), ("nanosec", Value::UInt(0))]),
        ),
        ("frame_locked", Value::Bool(false)),
        (
            "points",
            Value::Array((0..kind).map(|_| build::vector(dice.numbers())).collect()),
        ),
        (
            "colors",
            Value::Array((0..kind).map(|_| colour(0.125)).collect()),
        ),
        ("texture_resource", text("")),
        (
            "texture",
            build::message([
                ("header", header),
                ("format", text("")),
                ("data", nothing()),
            ]),
        ),
        ("uv_coordinates", nothing()),
        ("text", text("")),
        ("mesh_resource", text("")),
        (
            "mesh_file",
            build::message([("filename", text("")), ("data", nothing())]),
        ),
        ("mesh_use_embedded_materials", Value::Bool(false)),
    ])
}

#[test]
fn what_is_written_here_others_read_to_the_bit() {
    let folder = Folder::new("others-read");
    let (path, lines) = (folder.0.join("ours.mcap"), folder.0.join("ours.tsv"));
    let mut writer = McapWriter::new(File::create(&path).unwrap(), "ros2").unwrap();
    let mut topics = BTreeMap::new();
    let (mut dice, mut written) = (Dice(2012), String::new());
    for k in 0..400_i64 {
        // One message at a time: the order of equal times is the readers' own.
        let mut all = messages(&mut dice, 1 + 20 * k);
        all.push(robot(&mut dice, 1 + 20 * k));
        for (place, (topic, kind, value)) in all.into_iter().enumerate() {
            let time = 1_700_000_000_000_000_000 + 20 * k + i64::try_from(place).unwrap();
            let entry = match topics.entry(topic) {
                std::collections::btree_map::Entry::Occupied(known) => known.into_mut(),
                std::collections::btree_map::Entry::Vacant(new) => {
                    new.insert(writer.topic(topic, kind).unwrap())
                }
            };
            writer.send(entry, time, &value).unwrap();
            tell(
                "ours",
                topic,
                time.cast_unsigned(),
                &value,
                "",
                &mut written,
            );
        }
    }
    writer.finish().unwrap();
    same(&reported(&path, "ours"), &written, "read here");
    if !exchange("read", &[&path, &lines]) {
        return;
    }
    let theirs = fs::read_to_string(&lines).unwrap();
    for who in ["mcap-ros2-support", "rosbags"] {
        same(
            &written.replace("ours\t", &format!("{who}\t")),
            &of(&theirs, who),
            who,
        );
    }
}

#[test]
fn the_shipped_example_is_read_by_others() {
    let folder = Folder::new("others-example");
    let example: PathBuf =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/five-wheel/log.mcap");
    let lines = folder.0.join("example.tsv");
    if !exchange("read", &[&example, &lines]) {
        return;
    }
    let theirs = fs::read_to_string(&lines).unwrap();
    let sorted = |all: &str| all.lines().map(str::to_owned).collect::<BTreeSet<_>>();
    for who in ["mcap-ros2-support", "rosbags"] {
        // Messages of equal time may come in any order.
        assert_eq!(sorted(&reported(&example, who)), sorted(&of(&theirs, who)));
    }
}

#[test]
fn poses_by_transforms_that_others_write_are_theirs() {
    let folder = Folder::new("others-frames");
    if !exchange("frames", &[&folder.0]) {
        return;
    }
    let text = fs::read_to_string(folder.0.join("poses.tsv")).unwrap();
    let numbers = |line: &str| -> Vec<f64> {
        line.split('\t')
            .skip(1)
            .map(|n| n.parse().unwrap())
            .collect()
    };
    let expected: Vec<(i64, Vec<f64>)> = text
        .lines()
        .map(|line| {
            (
                line.split('\t').next().unwrap().parse().unwrap(),
                numbers(line),
            )
        })
        .collect();
    assert_eq!(expected.len(), 4);
    for name in ["frames.bag", "frames.mcap"] {
        let log =
            Log::find_any(&[folder.0.join(name)], None, &crate::choosing::topics("")).unwrap();
        let samples = log.samples(&[]).unwrap().map(Result::unwrap);
        let found: Vec<(i64, [f64; 3])> = samples
            .filter_map(|sample| match sample.measurement {
                Measurement::Pose { x, y, yaw } => Some((sample.time_ns, [x, y, yaw])),
                _ => None,
            })
            .collect();
        assert_eq!(found.len(), expected.len(), "{name}: {found:?}");
        for (found, expected) in found.iter().zip(&expected) {
            let is_close = found
                .1
                .iter()
                .zip(&expected.1)
                .all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(
                found.0 == expected.0 && is_close,
                "{name}: {found:?} and {expected:?}"
            );
        }
    }
}
