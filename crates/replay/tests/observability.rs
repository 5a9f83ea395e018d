//! What a log can show: an absolute reference outranks `grip`, and without one there is no way over ground.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Method, Options, Summary, run};
use grouser_slip::Reference;

const ROBOT: &str = "format = 1\nname = \"cart\"\n[estimator]\nreference = \"grip\"\n\
    [[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
    [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";

/// A cart that drives straight at 0.5 m/s by its rims and at 0.4 m/s over ground, 20 s at 50 Hz.
fn summary(with_pose: bool, options: &Options) -> Summary {
    let mut table = String::from("t,left,right,gyro,x,y,yaw\n");
    for row in 0..1000 {
        let time = f64::from(row) * 0.02;
        writeln!(table, "{time},1.8,1.8,0.0,{},0,0", 0.4 * time).unwrap();
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
    let by_windows = Options {
        method: Some(Method::Window),
        ..Options::default()
    };
    let summary = summary(true, &by_windows);
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

#[test]
fn without_an_absolute_reference_there_is_no_way_over_ground() {
    let along = summary(false, &Options::default()).along;
    assert_eq!((along.overall, along.travel_reference), (None, None));
    assert_eq!(along.slip.count, 0);
    assert!((along.travel_wheels - 10.0).abs() < 0.5, "{along:?}");
}

#[test]
fn the_filters_checks_pass_where_it_follows_its_reference() {
    let summary = summary(true, &Options::default());
    let fused = summary.fused.unwrap();
    assert!(fused.doubts.is_empty(), "{:?}", fused.doubts);
    let used = fused.reference.unwrap();
    assert!(used.readings > 50 && used.used <= used.readings, "{used:?}");
    let (filter, reference) = (fused.ways.slip_by_filter(), fused.ways.slip_by_reference());
    assert!((filter.unwrap() - reference.unwrap()).abs() < 0.03);
    assert!(summary.wheels[0].window_slip.is_none());
}
