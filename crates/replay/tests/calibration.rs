//! Radius, track, scale of the gyro and intervals from runs with a reference.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::robot::RobotFile;
use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{
    Error, GeometryCalibration, Options, calibrate_geometry, calibrate_intervals,
};

use crate::shipped;
use crate::shipped::{ROBOTINO, TWO_SURFACES, data, example};

const ROBOT: &str = "format = 1\nname = \"cart\"\n\
    [[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
    [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";

const MAP: &str = "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
    { column = \"left\", meaning = \"wheel_rate\", wheel = \"left\", unit = \"rad/s\" },\n\
    { column = \"right\", meaning = \"wheel_rate\", wheel = \"right\", unit = \"rad/s\" },\n\
    { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n\
    { column = \"x\", meaning = \"pose_x\", unit = \"m\" },\n\
    { column = \"y\", meaning = \"pose_y\", unit = \"m\" },\n\
    { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" },\n]\n";

/// True radius 0.097 m, track 0.43 m, a gyro that shows 1.03 of the rate and 0.01 rad/s more: 60 s of weaving at 0.4 m/s, or
/// straight on. The pose has an error of 2 mm.
fn cart(is_weaving: bool) -> Log {
    cart_of(is_weaving, |_| 0.4)
}

/// As [`cart`], at a speed of the row, m/s.
fn cart_of(is_weaving: bool, speed: impl Fn(i32) -> f64) -> Log {
    let mut table = String::from("t,left,right,gyro,x,y,yaw\n");
    let (mut x, mut y, mut yaw) = (0.0, 0.0, 0.0_f64);
    let mut state = 1_u64;
    let mut noise = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        0.004 * ((state >> 32) as f64 / f64::from(u32::MAX) - 0.5)
    };
    for row in 0..3000 {
        let time = f64::from(row) * 0.02;
        let rate = if is_weaving {
            0.5 * (0.4 * time).sin()
        } else {
            0.0
        };
        let speed = speed(row);
        let rim = |side: f64| (speed + side * 0.5 * 0.43 * rate) / 0.097;
        writeln!(
            table,
            "{time},{},{},{},{},{},{yaw}",
            rim(-1.0),
            rim(1.0),
            1.03 * rate + 0.01,
            x + noise(),
            y + noise()
        )
        .unwrap();
        x += 0.02 * speed * yaw.cos();
        y += 0.02 * speed * yaw.sin();
        yaw += 0.02 * rate;
    }
    let map = columns::parse(&Document::from_text("map.toml", MAP.into()).unwrap()).unwrap();
    let bytes = Cursor::new(table);
    Log::over("log.csv".as_ref(), bytes, Some(map), &Topics::default()).unwrap()
}

fn file() -> RobotFile {
    robot::parse(&Document::from_text("robot.toml", ROBOT.into()).unwrap()).unwrap()
}

#[test]
fn radius_track_and_gyro_are_found_within_their_intervals() {
    let found = calibrate_geometry(&[cart(true)], &file(), &Options::default()).unwrap();
    println!("{found:?}");
    let GeometryCalibration {
        radius,
        track,
        yaw_rate,
    } = found;
    for (name, factor, truth) in [
        ("radius", radius, 0.97),
        ("track", track.unwrap(), 0.43 / 0.4),
        ("yaw rate", yaw_rate.unwrap(), 1.0 / 1.03),
    ] {
        let half = factor.half_width.unwrap();
        let error = (factor.value - truth).abs();
        assert!(error < 0.01 && half < 0.03, "{name}: {factor:?}, {truth}");
        assert!(error < 2.0 * half + 1e-3, "{name}: {factor:?}, {truth}");
    }
}

#[test]
fn a_straight_drive_shows_neither_track_nor_gyro() {
    let found = calibrate_geometry(&[cart(false)], &file(), &Options::default()).unwrap();
    assert!((found.radius.value - 0.97).abs() < 0.005, "{found:?}");
    assert_eq!((found.track, found.yaw_rate), (None, None));
}

#[test]
fn a_drive_forwards_and_back_shows_the_radius() {
    let shuttle = cart_of(false, |row| if row / 250 % 2 == 0 { 0.4 } else { -0.4 });
    let found = calibrate_geometry(&[shuttle], &file(), &Options::default()).unwrap();
    // it turns round at once, between two rows: up to 8 mm each of 11 times, on 24 m
    assert!((found.radius.value - 0.97).abs() < 0.006, "{found:?}");
    let half = found.radius.half_width.unwrap();
    assert!(half < 0.01, "{found:?}");
}

#[test]
fn what_was_calibrated_is_written_beside_everything_else() {
    let revision = robot::Revision {
        radius: Some(0.97),
        track: Some(1.1),
        yaw_rate: Some(0.98),
        interval: Some(1.5),
        reference_latency: Some(0.12),
    };
    let kept = "# a comment\n";
    for estimator in [
        "",
        "[estimator]  # of ours\nlow_speed_m_per_s = 0.04\n",
        "[estimator]\ninterval_factor = 3.0\n",
        "[filter]\nslip_sigma = 0.3\n[estimator]\n",
        "[filter]\nreference_latency_s = 0.3 # of a camera\n",
    ] {
        let text = format!(
            "format = 1\n{kept}{}",
            ROBOT.replace("format = 1\n", "").replacen(
                "[[wheel]]",
                &format!("{estimator}[[wheel]]"),
                1
            )
        );
        let text =
            robot::revised(&Document::from_text("robot.toml", text).unwrap(), &revision).unwrap();
        assert!(text.contains(kept), "{text}");
        let file = robot::parse(&Document::from_text("robot.toml", text.clone()).unwrap()).unwrap();
        let wheel = &file.robot.wheels()[0];
        assert!(
            (wheel.radius - 0.097).abs() < 1e-9 && (wheel.y - 0.22).abs() < 1e-9,
            "{text}"
        );
        assert!(
            (file.corrections.yaw_rate_scale - 0.98).abs() < 1e-9,
            "{text}"
        );
        assert!(
            (file.corrections.interval_factor - 1.5).abs() < 1e-9,
            "{text}"
        );
        assert!(file.is_reference_latency_stated, "{text}");
        assert!(
            (file.filter.reference_latency - 0.12).abs() < 1e-9,
            "{text}"
        );
    }
    let inline = format!(
        "format = 1\nestimator = {{ low_speed_m_per_s = 0.04 }}\n{}",
        ROBOT.replace("format = 1\n", "")
    );
    let error = robot::revised(
        &Document::from_text("robot.toml", inline).unwrap(),
        &revision,
    )
    .unwrap_err();
    assert!(error.to_string().contains("add to it by hand"), "{error}");
}

/// Runs of the Robotino on one surface each, and from one surface onto another.
fn robotino(folder: &str, names: &[&str]) -> Option<Vec<Log>> {
    let path = data(folder)?;
    let map = columns::read(&shipped::root().join("examples/robotino/columns.toml")).unwrap();
    let open =
        |name: &&str| Log::find(&[path.join(format!("{name}.csv.gz"))], map.clone()).unwrap();
    Some(names.iter().map(open).collect())
}

#[test]
fn intervals_hold_in_runs_that_they_were_not_calibrated_on() {
    let (Some(one), Some(two)) = (
        robotino("robotino", &ROBOTINO),
        robotino("robotino-two-surfaces", &TWO_SURFACES),
    ) else {
        return;
    };
    let file = example("robotino").robot;
    let options = Options {
        from_s: Some(1.9),
        ..Options::default()
    };
    for (name, logs) in [("one surface", &one), ("two surfaces", &two)] {
        let found = calibrate_intervals(logs, &file, &options).unwrap();
        println!("{name}: {found:?}");
        // Each run is covered by the factor of the five others.
        assert!((0.85..0.95).contains(&found.coverage), "{name}: {found:?}");
        assert!(found.half_width < 0.130, "{name}: {found:?}");
        assert!(found.coverage_before > 0.85, "{name}: {found:?}");
    }
    let few = calibrate_intervals(&one[..2], &file, &options);
    assert!(matches!(few, Err(Error::TooFewRuns { runs: 2, .. })));
}
