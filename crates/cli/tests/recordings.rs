//! MCAP files that the command writes: what `estimate` says in them, and what a kill leaves.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use grouser_log::Messages;
use grouser_log::message::View;

const MCAP: &str = "examples/five-wheel/log.mcap";
const ROBOT: &str = "examples/five-wheel/robot.toml";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn grouser(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grouser"));
    command.current_dir(root()).args(arguments);
    command
}

/// A folder of its own for each test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("grouser-rec-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn an_estimate_as_messages_says_what_the_table_says() {
    let folder = Folder::new("estimate");
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
    let (mut way_points, mut pictures) = (0, 0);
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
            "/grouser/odom" => last = messages.view(&message),
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
                let Some(View::Odometry(odometry)) = &last else {
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
                let [x, y, _] = odometry.position;
                let apart = (middle("x") - x).hypot(middle("y") - y);
                assert!(apart < 0.3, "{apart} m");
                pictures += 1;
            }
            other => panic!("{other}"),
        }
    }
    assert_eq!((slips, diagnostics), (5 * 2001, 41));
    assert!((195..=201).contains(&pictures), "five a second: {pictures}");
    // a point every centimetre at most, of a way of some metres
    assert!((100..2000).contains(&way_points), "{way_points}");
    // The gyro's turn by another sum (the doctest of grouser-log): 0.94 rad, 0.04 of them the gyro's bias, which the
    // filter has learnt while the robot stood.
    let Some(View::Odometry(odometry)) = last else {
        panic!("{last:?}")
    };
    let yaw = 2.0 * odometry.orientation[2].atan2(odometry.orientation[3]);
    assert!((yaw - 0.90).abs() < 0.01, "{yaw}");
}

/// A kill at any moment leaves the old file or the whole new one.
#[test]
fn a_kill_leaves_the_old_file_or_the_new_one() {
    let folder = Folder::new("kill");
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
