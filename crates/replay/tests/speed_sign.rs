//! A speed over ground of which only the size is measured, and a robot that drives forwards and back.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_doctor::{Mistake, StartOutcome};
use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Doubt, Options, Row, Summary, check_start, run};

/// Its right encoder counts backwards.
const ROBOT: &str = "format = 1\nname = \"cart\"\n\
    [[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\nticks_per_turn = 500\ncounter_bits = 32\n\
    [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nreversed = true\nradius_m = 0.1\ndrive = \"powered\"\n\
    ticks_per_turn = 500\ncounter_bits = 32\n";

/// The speed of the rims forwards, m/s: each 10 s it turns round within 1 s.
fn rims(time_s: f64) -> f64 {
    let phase = time_s % 20.0;
    let ramp = |from: f64| (2.0 * (phase - from) - 1.0).clamp(-1.0, 1.0);
    let forwards = if phase < 10.0 { 1.0 } else { -ramp(10.0) };
    0.5 * if phase > 19.0 { ramp(19.0) } else { forwards }
}

/// Wheels at 50 Hz that slip by 0.2, a gyro that shows no turn, and the size of the speed at 5 Hz.
fn log(meaning: &str) -> Log {
    let mut table = String::from("t,left,right,gyro,speed\n");
    let mut way = 0.0;
    for row in 0..3000 {
        let time = f64::from(row) * 0.02;
        let ticks = way / (0.1 * std::f64::consts::TAU) * 500.0;
        let (left, right) = (1e5 + ticks, 1e5 - ticks);
        let speed = if row % 10 == 0 {
            format!("{}", 0.8 * rims(time).abs())
        } else {
            String::new()
        };
        writeln!(table, "{time},{left:.0},{right:.0},0.0,{speed}").unwrap();
        way += 0.02 * rims(time + 0.01);
    }
    let map = format!(
        "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n\
         {{ column = \"left\", meaning = \"wheel_count\", wheel = \"left\", unit = \"tick\" }},\n\
         {{ column = \"right\", meaning = \"wheel_count\", wheel = \"right\", unit = \"tick\" }},\n\
         {{ column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" }},\n\
         {{ column = \"speed\", meaning = \"{meaning}\", unit = \"m/s\" }},\n]\n"
    );
    let map = columns::parse(&Document::from_text("map.toml", map).unwrap()).unwrap();
    let bytes = Cursor::new(table);
    Log::over("log.csv".as_ref(), bytes, Some(map), &Topics::default()).unwrap()
}

/// The summary, and the root mean square of the slips' errors while the rims run at their full speed.
fn summary(meaning: &str, options: &Options) -> (Summary, f64) {
    let robot = robot::parse(&Document::from_text("robot.toml", ROBOT.into()).unwrap()).unwrap();
    let (mut squares, mut count) = (0.0, 0.0);
    let take = |row: &Row<'_>| {
        let is_steady = [1.0, 0.5, 0.0]
            .iter()
            .all(|ago| rims(row.time_s - ago).abs() == 0.5);
        if let Some(slip) = row.slip.filter(|_| row.time_s > 3.0 && is_steady) {
            squares += (slip - 0.2).powi(2);
            count += 1.0;
        }
        Ok(())
    };
    let summary = run(&log(meaning), &robot, options, take).unwrap();
    assert!(count > 1000.0);
    (summary, f64::sqrt(squares / count))
}

#[test]
fn a_size_of_the_speed_has_the_sign_of_the_wheels() {
    let (summary, rmse) = summary("speed_size", &Options::default());
    assert!(rmse < 0.02, "{rmse}");
    assert!(summary.doubts().is_empty(), "{:?}", summary.doubts());
    let slip = summary.along.overall.unwrap();
    assert!((slip - 0.2).abs() < 0.02, "{slip}");
}

#[test]
fn a_speed_that_is_never_negative_is_doubtful_where_wheels_run_backwards() {
    let (found, _) = summary("speed_forward", &Options::default());
    let doubts = found.doubts();
    // 3 spans of 9 to 10 s at 0.5 m/s
    assert!(
        matches!(doubts[0], Doubt::Description(Mistake::SpeedWithoutSign(way)) if (way - 14.0).abs() < 1.5),
        "{doubts:?}"
    );
    assert!(doubts[0].to_string().contains("`meaning = \"speed_size\"`"));
    let robot = robot::parse(&Document::from_text("robot.toml", ROBOT.into()).unwrap()).unwrap();
    let log = log("speed_forward");
    let start = check_start(&log, &robot, &Options::default()).unwrap();
    let beside = start.beside(&found.findings);
    assert!(
        matches!(
            beside,
            StartOutcome::Contradicted(Mistake::SpeedWithoutSign(_))
                | StartOutcome::Implausible { .. }
        ),
        "{beside:?}"
    );
}
