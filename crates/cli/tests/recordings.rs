//! MCAP files that the command writes: what `estimate` says in them, and what a kill leaves.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use grouser_log::Messages;
use grouser_log::container::Channel;
use grouser_log::message::{Value, View};

use crate::repository::{Folder, root};

const MCAP: &str = "examples/five-wheel/log.mcap";
const ROBOT: &str = "examples/five-wheel/robot.toml";

fn grouser(arguments: &[&str]) -> Command {
    let mut command = crate::repository::program();
    command.current_dir(root()).args(arguments);
    command
}

/// The points of a `sensor_msgs/PointCloud2`: x, y, z and slip.
fn points(cloud: &Value) -> Vec<[f64; 4]> {
    let Some(Value::Bytes(data)) = cloud.at("data") else {
        panic!("no bytes")
    };
    let width = cloud.number_at("width").unwrap();
    assert_eq!(data.len() as f64, 20.0 * width);
    let number = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().unwrap()));
    let point = |bytes: &[u8]| [0, 4, 8, 12].map(|at| number(&bytes[at..at + 4]));
    data.chunks_exact(20).map(point).collect()
}

/// What others read: every field of every point by the fields that the message declares.
const POINT_READER: &str = r#"
import struct, sys
from pathlib import Path
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

CODES = {6: "I", 7: "f"}

def show(who, message):
    order = ">" if message.is_bigendian else "<"
    data = bytes(message.data)
    assert len(data) == message.height * message.row_step
    assert message.row_step == message.width * message.point_step
    for begin in range(0, len(data), message.point_step):
        values = [struct.unpack_from(order + CODES[f.datatype], data, begin + f.offset)[0] for f in message.fields]
        print(who, [f.name for f in message.fields] == ["x", "y", "z", "slip", "colour"], *values)

path = sys.argv[1]
with open(path, "rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    for _, _, _, message in reader.iter_decoded_messages(topics=["/grouser/points"]):
        show("mcap", message)
with AnyReader([Path(path)]) as reader:
    wanted = [one for one in reader.connections if one.topic == "/grouser/points"]
    for connection, _, raw in reader.messages(connections=wanted):
        show("rosbags", reader.deserialize(raw, connection.msgtype))
"#;

#[test]
#[allow(clippy::print_stderr, reason = "a test that is skipped is reported")]
fn others_read_where_the_wheels_of_a_drive_were_and_how_they_slipped() {
    let folder = Folder::new("recordings-points");
    let mcap = folder.path("drive.mcap");
    let scenario = "examples/scenarios/sandbox.toml";
    let done = grouser(&["drive", scenario, "-o", &mcap]).output().unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let wanted = ["/grouser/points", "/simulation/truth/pose"];
    let wanted = move |channel: &Channel| wanted.contains(&channel.topic.as_str());
    let messages = Messages::open(Path::new(&mcap), grouser_log::Clock::Header, wanted).unwrap();
    let (mut mine, mut robot) = (Vec::new(), [0.0; 3]);
    for message in messages {
        let number = |name: &str| message.value.number_at(&format!("pose.position.{name}"));
        if let (Some(x), Some(y), Some(z)) = (number("x"), number("y"), number("z")) {
            robot = [x, y, z];
            continue;
        }
        for [x, y, z, slip] in points(&message.value) {
            // as far as the robot drives in a second and is long
            let apart = (x - robot[0]).hypot(y - robot[1]);
            assert!(
                apart < 1.5 && (z - robot[2]).abs() < 0.3,
                "{x} {y} {z}: {robot:?}"
            );
            mine.push([x, y, z, slip]);
        }
    }
    assert!(mine.len() > 500, "{}", mine.len());
    assert!(mine.iter().any(|[_, _, _, slip]| *slip > 0.2));
    let Some(python) = std::env::var_os("GROUSER_PYTHON") else {
        eprintln!("skipped: GROUSER_PYTHON names no Python with rosbags and mcap-ros2-support");
        return;
    };
    let read = Command::new(python)
        .args(["-c", POINT_READER, &mcap])
        .output()
        .unwrap();
    assert!(
        read.status.success(),
        "{}",
        String::from_utf8_lossy(&read.stderr)
    );
    let shown = String::from_utf8(read.stdout).unwrap();
    for who in ["mcap", "rosbags"] {
        let theirs: Vec<Vec<&str>> = shown
            .lines()
            .filter_map(|line| line.strip_prefix(who))
            .map(|line| line.split_whitespace().collect())
            .collect();
        assert_eq!(theirs.len(), mine.len(), "{who}");
        for (theirs, mine) in theirs.iter().zip(&mine) {
            assert_eq!(theirs[0], "True", "{who}: the fields");
            for (their, my) in theirs[1..5].iter().zip(mine) {
                let their: f64 = their.parse().unwrap();
                assert!(their.to_bits() == my.to_bits() || their.is_nan() && my.is_nan());
            }
            let colour: u32 = theirs[5].parse().unwrap();
            assert_eq!(colour & 0xff, 0xff, "opaque");
        }
    }
}

#[test]
#[allow(clippy::too_many_lines, reason = "a part for each topic")]
fn an_estimate_as_messages_says_what_the_table_says() {
    let folder = Folder::new("recordings-estimate");
    let (mcap, table) = (folder.path("slip.mcap"), folder.path("slip.csv"));
    let done = grouser(&[
        "estimate", MCAP, "--robot", ROBOT, "-o", &mcap, "-o", &table,
    ])
    .output()
    .unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    // Slip by wheel and time, from the table: its rows have a time in s since the start.
    let text = fs::read_to_string(table).unwrap();
    let mut rows = BTreeMap::new();
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let time_ms = (fields[0].parse::<f64>().unwrap() * 1e3).round();
        rows.insert(
            (format!("{time_ms}"), fields[1].to_owned()),
            fields[2].to_owned(),
        );
    }
    let mut messages =
        Messages::open(Path::new(&mcap), grouser_log::Clock::Header, |_| true).unwrap();
    let (mut slips, mut last, mut diagnostics, mut start) = (0, None, 0, None);
    let (mut way_points, mut pictures, mut poses, mut wheel_points) = (0, 0, 0, 0);
    #[allow(
        clippy::cast_possible_truncation,
        reason = "points have floats of 32 bits"
    )]
    let seen: BTreeSet<String> = rows
        .values()
        .filter_map(|slip| slip.parse::<f64>().ok())
        .map(|slip| format!("{:.6}", slip as f32))
        .collect();
    while let Some(message) = messages.next() {
        let topic = messages.channels()[message.channel].topic.clone();
        let start = *start.get_or_insert(message.time_ns);
        match topic.as_str() {
            "/grouser/slip" => {
                let time_ms = format!("{}", (message.time_ns - start) / 1_000_000);
                for wheel in 0..5 {
                    let text = |field: &str| {
                        message
                            .value
                            .at(&format!("{field}[{wheel}]"))
                            .unwrap()
                            .clone()
                    };
                    let name = text("name").text().unwrap().to_owned();
                    let slip = text("slip").number().unwrap();
                    let row = &rows[&(time_ms.clone(), name)];
                    match row.parse::<f64>() {
                        Ok(number) => assert_eq!(number.to_bits(), slip.to_bits()),
                        Err(_) => assert!(row.is_empty() && slip.is_nan()),
                    }
                    slips += 1;
                }
            }
            "/grouser/odom" => {
                let Some(View::Odometry(odometry)) = messages.view(&message) else {
                    panic!("{:?}", message.value)
                };
                last = Some((odometry.position, odometry.orientation));
            }
            "/diagnostics" => {
                assert_eq!(
                    message
                        .value
                        .at("status")
                        .unwrap()
                        .elements()
                        .unwrap()
                        .len(),
                    5
                );
                diagnostics += 1;
            }
            "/grouser/way" => {
                let count = |field| message.value.at(field).unwrap().elements().unwrap().len();
                assert_eq!(count("points"), count("colors"));
                way_points += count("points") - 1;
            }
            "/grouser/robot" => {
                let markers = message.value.at("markers").unwrap().elements().unwrap();
                assert_eq!(markers.len(), 6, "a body and five wheels");
                // the picture is where the odometry is
                let Some((position, _)) = last else {
                    panic!("a picture without a pose")
                };
                let wheels = markers[1..].iter();
                let middle = |name: &str| {
                    let places = wheels.clone();
                    let sum: f64 = places
                        .map(|wheel| wheel.number_at(&format!("pose.position.{name}")).unwrap())
                        .sum();
                    sum / 5.0
                };
                let [x, y, _] = position;
                let apart = (middle("x") - x).hypot(middle("y") - y);
                assert!(apart < 0.3, "{apart} m");
                pictures += 1;
            }
            "/grouser/pose" => poses += 1,
            "/grouser/points" => {
                let Some((position, _)) = last else {
                    panic!("points without a pose")
                };
                for [x, y, z, slip] in points(&message.value) {
                    // as far as the robot drives in a second and is long
                    let apart = (x - position[0]).hypot(y - position[1]);
                    assert!(apart < 1.5 && z.abs() < 1e-6, "{x} {y} {z}");
                    assert!(
                        slip.is_nan() || seen.contains(&format!("{slip:.6}")),
                        "{slip}"
                    );
                    wheel_points += 1;
                }
            }
            other => panic!("{other}"),
        }
    }
    assert_eq!(poses, pictures);
    // five wheels, a point every two centimetres at most
    assert!((300..3000).contains(&wheel_points), "{wheel_points}");
    assert_eq!((slips, diagnostics), (5 * 2001, 41));
    assert!((195..=201).contains(&pictures), "five a second: {pictures}");
    // a point every centimetre at most, of a way of some metres
    assert!((100..2000).contains(&way_points), "{way_points}");
    // The gyro's turn by another sum (the doctest of grouser-log): 0.94 rad, 0.04 of them the gyro's bias, which the
    // filter has learnt while the robot stood.
    let (_, [_, _, z, w]) = last.expect("an odometry");
    let yaw = 2.0 * z.atan2(w);
    assert!((yaw - 0.90).abs() < 0.01, "{yaw}");
}

/// A kill at any moment leaves the old file or the whole new one.
#[test]
fn a_kill_leaves_the_old_file_or_the_new_one() {
    let folder = Folder::new("recordings-kill");
    let out = folder.path("out.mcap");
    let old = b"the old file".to_vec();
    let (mut kept, mut renewed) = (0, 0);
    for delay_ms in (0..60).step_by(3) {
        fs::write(&out, &old).unwrap();
        let mut running = grouser(&["log", "recover", MCAP, &out])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(delay_ms));
        let _ = running.kill();
        running.wait().unwrap();
        if fs::read(&out).unwrap() == old {
            kept += 1;
        } else {
            renewed += 1;
            let messages = Messages::open(Path::new(&out), grouser_log::Clock::Header, |_| true);
            let mut messages = messages.unwrap();
            assert_eq!(messages.by_ref().count(), 4002);
            assert_eq!(messages.left_out().damages, 0);
        }
    }
    assert!(kept > 0 && kept + renewed == 20, "{kept} {renewed}");
}
