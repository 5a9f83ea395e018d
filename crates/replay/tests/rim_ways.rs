//! Ways of rims, as odometers count them, are rotations by the radius of the wheel.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Options, run};

/// Neither the gear nor the mounting of an encoder, nor another radius, is in a way that was counted at the rim.
const ROBOT: &str = "format = 1\nname = \"cart\"\n\
    [[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
    encoder_on = \"motor\"\ngear = 20.0\nreversed = true\n\
    [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.2\ndrive = \"powered\"\n";

const MAP: &str = "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
    { column = \"left\", meaning = \"wheel_distance\", wheel = \"left\", unit = \"cm\" },\n\
    { column = \"right\", meaning = \"wheel_distance\", wheel = \"right\", unit = \"ft\" },\n\
    { column = \"speed\", meaning = \"speed_forward\", unit = \"m/s\" },\n]\n";

/// Rims of 0.5 m/s beside a robot of 0.4 m/s, 20 s at 50 Hz.
#[test]
fn a_cart_with_odometers_has_its_slip() {
    let mut table = String::from("t,left,right,speed\n");
    for row in 0..=1000 {
        let time = 0.02 * f64::from(row);
        let way = 7.0 + 0.5 * time;
        writeln!(table, "{time},{},{},0.4", 100.0 * way, way / 0.3048).unwrap();
    }
    let document = |name: &str, text: &str| Document::from_text(name, text.into()).unwrap();
    let map = columns::parse(&document("map.toml", MAP)).unwrap();
    let robot = robot::parse(&document("robot.toml", ROBOT)).unwrap();
    let log = Log::over(
        "log.csv".as_ref(),
        Cursor::new(table),
        Some(map),
        &Topics::default(),
    )
    .unwrap();
    let summary = run(&log, &robot, &Options::default(), |_| Ok(())).unwrap();
    assert_eq!(summary.wheel_sensor, "angle");
    let along = &summary.along;
    assert!((along.travel_wheels - 10.0).abs() < 0.3, "{along:?}");
    assert!((along.overall.unwrap() - 0.2).abs() < 0.005, "{along:?}");
    for wheel in &summary.wheels {
        assert!(
            (wheel.slip.median.unwrap() - 0.2).abs() < 0.005,
            "{wheel:?}"
        );
    }
}
