//! Positions that are stamped as they arrive, after stalls all at once.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Doubt, Options, run};
use grouser_synthetic::Noise;

const ROBOT: &str = "format = 1\nname = \"cart\"\n[estimator]\nposition_sigma_m = 0.01\nyaw_sigma_deg = 0.57\n\
    [[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
    [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";
const MAP: &str = "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
    { column = \"left\", meaning = \"wheel_angle\", wheel = \"left\", unit = \"rad\" },\n\
    { column = \"right\", meaning = \"wheel_angle\", wheel = \"right\", unit = \"rad\" },\n\
    { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n\
    { column = \"x\", meaning = \"pose_x\", unit = \"m\" },\n\
    { column = \"y\", meaning = \"pose_y\", unit = \"m\" },\n\
    { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" },\n]\n";

/// Rims at 0.6 m/s that slip by a third after 3 s of rest; poses at 10 Hz arrive 0.05 s late and later, in the mean by 0.05 s,
/// and one in thirty by another 0.5 s. None passes another.
fn log() -> Log {
    let mut rows: Vec<(f64, String)> = Vec::new();
    for row in 0..3000 {
        let time = f64::from(row) * 0.02;
        let angle = 6.0 * (time - 3.0).max(0.0);
        rows.push((time, format!("{angle},{angle},0.0,,,")));
    }
    let mut noise = Noise::new(5);
    let mut last = 0.0;
    for pose in 0..600 {
        let time = f64::from(pose) * 0.1;
        let stall = if noise.uniform() < 1.0 / 30.0 {
            0.5
        } else {
            0.0
        };
        let delay = 0.05 - 0.05 * (1.0 - noise.uniform()).ln() + stall;
        last = f64::max(time + delay, last + 1e-6);
        let x = 0.4 * (time - 3.0).max(0.0) + 0.01 * noise.normal();
        let (y, yaw) = (0.01 * noise.normal(), 0.01 * noise.normal());
        rows.push((last, format!(",,,{x},{y},{yaw}")));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut table = String::from("t,left,right,gyro,x,y,yaw\n");
    for (time, row) in rows {
        writeln!(table, "{time:.6},{row}").unwrap();
    }
    let map = columns::parse(&Document::from_text("map.toml", MAP.into()).unwrap()).unwrap();
    let bytes = Cursor::new(table);
    Log::over("log.csv".as_ref(), bytes, Some(map), &Topics::default()).unwrap()
}

#[test]
fn the_whole_way_contains_what_comes_late() {
    let robot = robot::parse(&Document::from_text("robot.toml", ROBOT.into()).unwrap()).unwrap();
    let summary = run(&log(), &robot, &Options::default(), |_| Ok(())).unwrap();
    // what comes late is behind the filter too: its own distance may differ by more than the check allows
    let differs = |of: &Doubt| matches!(of, Doubt::WaysDiffer { .. });
    assert!(
        summary.doubts().iter().all(differs),
        "{:?}",
        summary.doubts()
    );
    let along = summary.along;
    let way = along.travel_reference.unwrap();
    // 57 s at 0.6 and 0.4 m/s; the last step of up to 0.2 s is not counted, and the last pose is late
    assert!((along.travel_wheels - 34.2).abs() < 0.2, "{along:?}");
    assert!((way - 22.8).abs() < 0.2, "{along:?}");
    let slip = summary.fused.ways.slip_by_reference().unwrap();
    assert!((slip - 1.0 / 3.0).abs() < 0.01, "{slip}");
}
