//! Rows as loggers write them: without a new pose, with a time in two columns, with times that are rounded.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Cursor;

use grouser_files::columns::{self, ColumnMap};
use grouser_files::{Document, robot, topics::Topics};
use grouser_log::{Error, Log, Sheet, suggest_for_sheets};
use grouser_slip::{Measurement, Sample};

use crate::scratch::Folder;

const COLUMNS: &str = "columns = [\n\
    { column = \"ticks\", meaning = \"wheel_count\", wheel = \"left\", unit = \"tick\" },\n\
    { column = \"x\", meaning = \"pose_x\", unit = \"m\" },\n\
    { column = \"y\", meaning = \"pose_y\", unit = \"m\" },\n\
    { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" },\n]\n";

fn map(time: &str) -> ColumnMap {
    let text = format!("format = 1\n[[table]]\ntime = {time}\n{COLUMNS}");
    columns::parse(&Document::from_text("map.toml", text).unwrap()).unwrap()
}

fn log(time: &str, table: String) -> Log {
    let bytes = Cursor::new(table);
    Log::over(
        "log.csv".as_ref(),
        bytes,
        Some(map(time)),
        &Topics::default(),
    )
    .unwrap()
}

fn samples(log: &Log) -> Vec<Sample> {
    log.samples(&[]).unwrap().map(Result::unwrap).collect()
}

fn poses(log: &Log) -> Vec<[f64; 3]> {
    let pose = |sample: &Sample| match sample.measurement {
        Measurement::Pose { x, y, yaw } => Some([x, y, yaw]),
        _ => None,
    };
    samples(log).iter().filter_map(pose).collect()
}

#[test]
fn zeros_in_rows_without_a_new_pose_are_no_pose() {
    let mut table = String::from("t,ticks,x,y,yaw\n");
    for row in 0..50 {
        let pose = if row % 5 == 0 {
            format!("{:.1},2.0,0.3", 5.0 + 0.1 * f64::from(row))
        } else {
            "0,0.000,0".to_owned()
        };
        writeln!(table, "{},{row},{pose}", 0.02 * f64::from(row)).unwrap();
    }
    let log = log("{ column = \"t\", unit = \"s\" }", table);
    let expected: Vec<[f64; 3]> = (0..10)
        .map(|k| [5.0 + 0.5 * f64::from(k), 2.0, 0.3])
        .collect();
    assert_eq!(poses(&log), expected);
    assert_eq!(log.left_out().zero_poses, 40);
    // of each reading anew
    assert_eq!(samples(&log).len(), 60);
    assert_eq!(log.left_out().zero_poses, 40);
}

#[test]
fn a_robot_that_rests_at_the_origin_is_there() {
    let mut table = String::from("t,ticks,x,y,yaw\n");
    for row in 0..50 {
        let x = 0.01 * f64::from((row - 20).clamp(0, 4));
        // and back
        let x = if row > 40 { 0.0 } else { x };
        writeln!(table, "{},{row},{x:.2},0.0,0.0", 0.02 * f64::from(row)).unwrap();
    }
    let log = log("{ column = \"t\", unit = \"s\" }", table);
    assert_eq!(poses(&log).len(), 50);
    assert_eq!(log.left_out().zero_poses, 0);
}

#[test]
fn a_time_of_seconds_and_nanoseconds_is_exact() {
    let time = "{ column = \"sec\", unit = \"s\", nanoseconds = \"nanosec\" }";
    let table = "sec,nanosec,ticks,x,y,yaw\n1700000000,999999999,1,1,2,0.5\n1700000001,20000001,2,1,2,0.5\n";
    let times: Vec<i64> = samples(&log(time, table.to_owned()))
        .iter()
        .map(|sample| sample.time_ns)
        .collect();
    let [first, second] = [1_700_000_000_999_999_999, 1_700_000_001_020_000_001];
    assert_eq!(times, [first, first, second, second]);
    let again = columns::to_toml(&map(time));
    assert_eq!(
        columns::parse(&Document::from_text("map.toml", again).unwrap()).unwrap(),
        map(time)
    );
    let bytes = Cursor::new("sec,ticks,x,y,yaw\n1,1,1,1,1\n");
    let log = Log::over(
        "log.csv".as_ref(),
        bytes,
        Some(map(time)),
        &Topics::default(),
    )
    .unwrap();
    let Err(error) = log.samples(&[]) else {
        panic!("the column of nanoseconds is missing");
    };
    assert!(
        matches!(&error, Error::NoColumn { column, .. } if column == "nanosec"),
        "{error}"
    );
}

#[test]
fn a_time_of_two_columns_is_proposed() {
    let mut table = String::from("header.stamp.sec,header.stamp.nanosec,left_ticks,right_ticks\n");
    for row in 0..200 {
        let (seconds, beyond) = (1_700_000_000 + row / 50, row % 50 * 20_000_000);
        writeln!(table, "{seconds},{beyond},{row},{row}").unwrap();
    }
    let folder = Folder::new("two-columns-of-time");
    let path = folder.file("log.csv", table.as_bytes());
    let sheet = Sheet::read(&path, |_| ()).unwrap();
    let time = sheet.time.clone().unwrap();
    assert_eq!(
        (time.column, time.nanoseconds, time.unit),
        (0, Some(1), "s")
    );
    assert!((time.rate_hz.unwrap() - 50.0).abs() < 0.01, "{time:?}");
    assert!((time.duration_s - 3.98).abs() < 1e-6 && time.jumps == 0);
    let text = suggest_for_sheets([(&sheet, "log.csv")]).replace("= \"measure\"", "= 2.0");
    let file = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    let own = &file.columns.unwrap().tables[0].time;
    assert_eq!(
        (own.column.as_str(), own.nanoseconds.as_deref()),
        ("header.stamp.sec", Some("header.stamp.nanosec"))
    );
}

#[test]
fn rows_that_share_a_time_are_counted() {
    let mut table = String::from("t,ticks,x,y,yaw\n");
    for row in 0..150 {
        writeln!(table, "{},{row},1.0,2.0,0.5", 1_700_000_000 + row / 50).unwrap();
    }
    let log = log("{ column = \"t\", unit = \"s\" }", table);
    for _ in 0..2 {
        assert_eq!(samples(&log).len(), 300);
        let left_out = log.left_out();
        assert_eq!((left_out.rows, left_out.same_time), (150, 147));
    }
}

#[test]
fn a_word_in_a_column_of_numbers_may_stand_for_no_value() {
    for (row, has_hint) in [
        ("0,None,1,2,0.5", true),
        ("0,1,null,2,0.5", true),
        ("0,nan,1,2,0.5", true),
        ("0,7x,1,2,0.5", false),
    ] {
        let table = format!("t,ticks,x,y,yaw\n{row}\n1,2,1,2,0.5\n");
        let log = log("{ column = \"t\", unit = \"s\" }", table);
        let error = log.samples(&[]).unwrap().find_map(Result::err).unwrap();
        let hint = error.hint().is_some_and(|hint| hint.contains("`missing`"));
        assert_eq!(hint, has_hint, "{row}: {error}");
    }
}
