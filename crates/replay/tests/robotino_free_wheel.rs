//! Robotino with the camera's path turned into free wheels of 500 ticks: what the filter says by them, and by the camera
//! itself, against the slip by the camera.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use grouser_files::Document;
use grouser_files::columns;
use grouser_files::robot;
use grouser_log::Log;
use grouser_replay::{Row, Sink, Step, Summary, run_into};
use grouser_slip::Measurement;

use crate::shipped::{CUT, ROBOTINO, data, example, median, root};

/// The free wheels: radius (m) and ticks per turn.
const RADIUS: f64 = 0.05;
const TICKS: f64 = 500.0;

/// The columns of the run that is written.
const COLUMNS: &str = r#"format = 1
[[table]]
time = { column = "t_ns", unit = "ns" }
columns = [
    { column = "m1", meaning = "wheel_count", wheel = "m1", unit = "tick" },
    { column = "m2", meaning = "wheel_count", wheel = "m2", unit = "tick" },
    { column = "m3", meaning = "wheel_count", wheel = "m3", unit = "tick" },
    { column = "along", meaning = "wheel_count", wheel = "along", unit = "tick" },
    { column = "across", meaning = "wheel_count", wheel = "across", unit = "tick" },
]
"#;

/// The run with a free wheel that follows the camera along the commanded way and one across it, and without the
/// camera. The motors' velocities, which the figures are from, are written as the ticks that they come to.
fn with_free_wheels(folder: &Path, name: &str) -> (Log, robot::RobotFile) {
    let log = example("robotino").log(folder.join(format!("{name}.csv.gz")));
    let mut text = String::from("t_ns,m1,m2,m3,along,across\n");
    let (mut turned, mut way) = ([0.0; 3], [0.0; 2]);
    let mut heading: Option<f64> = None;
    let (mut last_ns, mut since) = (None, 0.0);
    let mut row = |time_ns: i64, turned: [f64; 3], way: [f64; 2]| {
        let ticks = |turns: f64, per_turn: f64| (turns * per_turn).floor();
        let [m1, m2, m3] = turned.map(|angle| ticks(angle / TAU, 2000.0));
        let [along, across] = way.map(|way| ticks(way / (TAU * RADIUS), TICKS));
        writeln!(text, "{time_ns},{m1},{m2},{m3},{along},{across}").unwrap();
    };
    for record in log.samples(&[]).unwrap() {
        let record = record.unwrap();
        if let Some(last) = last_ns.filter(|&last| last != record.time_ns) {
            row(last, turned, way);
            since = (record.time_ns - last) as f64 * 1e-9;
        }
        last_ns = Some(record.time_ns);
        match record.measurement {
            Measurement::WheelRate { wheel, rate } => turned[wheel] += rate * since,
            Measurement::Command { forward, left } => {
                heading.get_or_insert(left.atan2(forward));
            }
            Measurement::Displacement { forward, left, .. } => {
                let (sin, cos) = heading.unwrap_or(0.0).sin_cos();
                way[0] += cos * forward + sin * left;
                way[1] += cos * left - sin * forward;
            }
            _ => {}
        }
    }
    row(last_ns.unwrap(), turned, way);
    let path = std::env::temp_dir().join(format!("grouser-{name}-{}.csv", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let map =
        columns::parse(&Document::from_text("columns.toml", COLUMNS.into()).unwrap()).unwrap();
    let log = Log::find(&[path], map).unwrap();
    let mut file = std::fs::read_to_string(root().join("examples/robotino/robot.toml")).unwrap();
    file = file
        .replace("\"displacement\"", "\"free-wheel\"")
        .replace("\"rate\"", "\"count\"");
    for (name, turn) in [("along", 0.0), ("across", 90.0)] {
        let heading_deg = heading.unwrap().to_degrees() + turn;
        writeln!(
            file,
            "[[wheel]]\nname = \"{name}\"\nx_m = 0.0\ny_m = 0.0\nheading_deg = {heading_deg}\nradius_m = {RADIUS}\n\
             drive = \"free\"\nticks_per_turn = {TICKS}\n"
        )
        .unwrap();
    }
    let robot = robot::parse(&Document::from_text("robot.toml", file).unwrap()).unwrap();
    (log, robot)
}

/// Slip of the robot along its way, in windows of a second of the corrected odometry and of the wheels' own.
struct Along {
    last: Option<(f64, f64, f64)>,
    slips: Vec<f64>,
}

impl Sink for Along {
    fn row(&mut self, _row: &Row<'_>) -> std::io::Result<()> {
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> std::io::Result<()> {
        let Some(odometry) = step.odometry else {
            return Ok(());
        };
        let now = (step.time_s, odometry.distance, odometry.distance_of_wheels);
        let last = *self.last.get_or_insert(now);
        if now.0 - last.0 >= 1.0 {
            self.slips.push(1.0 - (now.1 - last.1) / (now.2 - last.2));
            self.last = Some(now);
        }
        Ok(())
    }
}

fn along(log: &Log, robot: &robot::RobotFile) -> (f64, Summary) {
    let mut along = Along {
        last: None,
        slips: Vec::new(),
    };
    let summary = run_into(log, robot, &CUT, &mut along).unwrap();
    (median(along.slips), summary)
}

#[test]
fn the_median_slip_of_a_run_is_the_cameras() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let robotino = example("robotino");
    for name in ROBOTINO {
        let camera = robotino.log(folder.join(format!("{name}.csv.gz")));
        let (by_camera, window) = along(&camera, &robotino.robot);
        let windowed = window.along.slip.median.unwrap();
        let (log, robot) = with_free_wheels(&folder, name);
        let (by_wheels, summary) = along(&log, &robot);
        println!(
            "{name}: median over half seconds with the camera {windowed:.4}, over seconds {by_camera:.4}, with \
             free wheels {by_wheels:.4}"
        );
        // 16 seconds, each with a scatter of 0.02 to 0.08 of its own that the two share
        assert!(
            (by_wheels - by_camera).abs() < 0.02,
            "{name}: {by_wheels} {by_camera}"
        );
        let found = summary.along.slip.median.unwrap();
        assert!((found - windowed).abs() < 0.03, "{name}: {found}");
    }
}
