//! What a log can show: an absolute reference outranks `grip`, and without one there is no way over ground.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Options, Summary, run};
use grouser_slip::Reference;

const ROBOT: &str = "format = 1\nname = \"cart\"\n[estimator]\nreference = \"grip\"\n\
    [[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
    [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";

/// A cart that drives straight at 0.5 m/s by its rims and at 0.4 m/s over ground, 20 s at 50 Hz.
fn summary(with_pose: bool, options: &Options) -> Summary {
    summary_of(with_pose, |row| (1.8, 0.4 * 0.02 * f64::from(row)), options)
}

/// A cart that runs straight at a speed by its rims, km/h, and is at a place, m, both of the row, 20 s at 50 Hz.
fn summary_of(with_pose: bool, drive: impl Fn(i32) -> (f64, f64), options: &Options) -> Summary {
    summary_with(1.0, with_pose, drive, options)
}

/// The same with a right wheel of this multiple of the left one's speed.
fn summary_with(
    right: f64,
    with_pose: bool,
    drive: impl Fn(i32) -> (f64, f64),
    options: &Options,
) -> Summary {
    let mut table = String::from("t,left,right,gyro,x,y,yaw\n");
    for row in 0..1000 {
        let time = f64::from(row) * 0.02;
        let (speed, place) = drive(row);
        writeln!(table, "{time},{speed},{},0.0,{place},0,0", right * speed).unwrap();
    }
    let pose = "{ column = \"x\", meaning = \"pose_x\", unit = \"m\" }, { column = \"y\", meaning = \"pose_y\", \
        unit = \"m\" }, { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" },";
    let map = format!(
        "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n\
         {{ column = \"left\", meaning = \"wheel_speed\", wheel = \"left\", unit = \"km/h\" }},\n\
         {{ column = \"right\", meaning = \"wheel_speed\", wheel = \"right\", unit = \"km/h\" }},\n\
         {{ column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" }},\n{}]\n",
        if with_pose { pose } else { "" }
    );
    let document = |name: &str, text: String| Document::from_text(name, text).unwrap();
    let map = columns::parse(&document("map.toml", map)).unwrap();
    let robot = robot::parse(&document("robot.toml", ROBOT.into())).unwrap();
    let log = Log::over(
        "log.csv".as_ref(),
        Cursor::new(table),
        Some(map),
        &Topics::default(),
    )
    .unwrap();
    run(&log, &robot, options, |_| Ok(())).unwrap()
}

#[test]
fn an_absolute_reference_outranks_grip() {
    let summary = summary(true, &Options::default());
    assert_eq!(summary.reference, Reference::Pose);
    // rims of 1.8 km/h by the wheels' radius
    let slip = summary.along.overall.unwrap();
    assert!((slip - 0.2).abs() < 0.005, "{slip}");
    let by_grip = Options {
        reference: Some(Reference::Grip),
        ..Options::default()
    };
    assert_eq!(self::summary(true, &by_grip).reference, Reference::Grip);
}

/// Five seconds forwards at a slip of 0.3 and five back at 0.05, twice: the wheels run 10 m, the robot 2 · (1.75 m + 2.375 m).
#[test]
fn ways_forwards_and_back_add_up() {
    let leg = |row: i32| row / 250;
    let drive = |row: i32| {
        let steps = |legs: i32| f64::from((row - 250 * legs).clamp(0, 250));
        let forwards = 0.007 * (steps(0) + steps(2));
        let back = 0.0095 * (steps(1) + steps(3));
        (if leg(row) % 2 == 0 { 1.8 } else { -1.8 }, forwards - back)
    };
    let along = summary_of(true, drive, &Options::default()).along;
    let (slip, reference) = (along.overall.unwrap(), along.travel_reference.unwrap());
    assert!((along.travel_wheels - 10.0).abs() < 0.4, "{along:?}");
    assert!((reference - 8.25).abs() < 0.4, "{along:?}");
    assert!((slip - 0.175).abs() < 0.01, "{along:?}");
}

#[test]
fn without_an_absolute_reference_there_is_no_way_over_ground() {
    let along = summary(false, &Options::default()).along;
    assert_eq!((along.overall, along.travel_reference), (None, None));
    assert_eq!(along.slip.count, 0);
    assert!((along.travel_wheels - 10.0).abs() < 0.5, "{along:?}");
}

/// Rims of 0.5 and 0.4 m/s and a gyro that shows no turn: one centre's speed, whatever it is.
#[test]
fn without_an_absolute_reference_slips_differ_as_the_rims_do() {
    let summary = summary_with(0.8, false, |_| (1.8, 0.0), &Options::default());
    assert_eq!(summary.reference, Reference::Grip);
    let [left, right] = [0, 1].map(|wheel| summary.wheels[wheel].slip.median.unwrap());
    let speeds = [0.5 * (1.0 - left), 0.4 * (1.0 - right)];
    assert!((speeds[0] - speeds[1]).abs() < 0.005, "{left} {right}");
    for wheel in &summary.wheels {
        let share = wheel.healths.get("Degraded(Relative)");
        assert!(share.is_some_and(|share| *share > 0.9), "{wheel:?}");
        assert!(!wheel.healths.contains_key("Ok"));
    }
    assert!(summary.doubts().is_empty(), "{:?}", summary.doubts());
}

#[test]
fn the_filters_checks_pass_where_it_follows_its_reference() {
    let summary = summary(true, &Options::default());
    let fused = summary.fused;
    assert!(fused.doubts.is_empty(), "{:?}", fused.doubts);
    let used = fused.reference.unwrap();
    assert!(used.readings > 50 && used.used <= used.readings, "{used:?}");
    let (filter, reference) = (fused.ways.slip_by_filter(), fused.ways.slip_by_reference());
    assert!((filter.unwrap() - reference.unwrap()).abs() < 0.03);
}

#[test]
fn the_noise_of_a_reference_at_rest_is_no_skid() {
    // half of the time at rest; positions that jump by up to 4 cm
    let drive = |row: i32| {
        let noise = f64::from(row * row % 997 * 7919 % 1009) / 504.0 - 1.0;
        let driven = f64::from((row - 500).max(0)) * 0.02;
        let speed = if row > 500 { 1.8 } else { 0.0 };
        (speed, 0.4 * driven + 0.02 * noise)
    };
    let slip = summary_of(true, drive, &Options::default()).along.slip;
    assert!((slip.median.unwrap() - 0.2).abs() < 0.05, "{slip:?}");
    assert!(slip.p5.unwrap() > -0.5 && slip.count > 15, "{slip:?}");
}
