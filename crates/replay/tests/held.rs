//! A logger that repeats a reference in the rows between its updates, against the same log with empty fields there.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::columns::{self, ColumnMap};
use grouser_files::robot::{self, RobotFile};
use grouser_files::{Document, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Options, Summary, run};
use grouser_synthetic::Noise;

const STEP_S: f64 = 0.02;
const ROWS: usize = 4500;
const HALF_TRACK_M: f64 = 0.2;
const RADIUS_M: f64 = 0.1;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Pose,
    Displacement,
    Speed,
}

/// Rows between updates of the reference, what stands there, and its noise, m or m/s, and last digit.
#[derive(Clone, Copy, Debug)]
struct Case {
    kind: Kind,
    rows: usize,
    is_held: bool,
    sigma: f64,
    digits: usize,
}

/// The columns of the table, and the robot.
fn description(case: Case) -> (ColumnMap, RobotFile) {
    let mut map = String::from(
        "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
        { column = \"left\", meaning = \"wheel_angle\", wheel = \"left\", unit = \"rad\" },\n\
        { column = \"right\", meaning = \"wheel_angle\", wheel = \"right\", unit = \"rad\" },\n\
        { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n",
    );
    let columns: &[(&str, &str, &str)] = match case.kind {
        Kind::Pose => &[
            ("a", "pose_x", "m"),
            ("b", "pose_y", "m"),
            ("c", "pose_yaw", "rad"),
        ],
        Kind::Displacement => &[
            ("a", "displacement_forward", "m"),
            ("b", "displacement_left", "m"),
            ("c", "displacement_turn", "rad"),
        ],
        Kind::Speed => &[("a", "speed_forward", "m/s")],
    };
    for (column, meaning, unit) in columns {
        writeln!(
            map,
            "{{ column = \"{column}\", meaning = \"{meaning}\", unit = \"{unit}\" }},"
        )
        .unwrap();
    }
    map.push_str("]\n");
    let map = columns::parse(&Document::from_text("map.toml", map).unwrap()).unwrap();
    let sigma = case.sigma.max(0.001);
    let mut text = format!(
        "format = 1\nname = \"cart\"\n[estimator]\nposition_sigma_m = {sigma}\nspeed_sigma_m_per_s = {sigma}\n"
    );
    for (name, y) in [("left", HALF_TRACK_M), ("right", -HALF_TRACK_M)] {
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = 0.0\ny_m = {y}\nradius_m = {RADIUS_M}\ndrive = \"powered\""
        )
        .unwrap();
    }
    let file = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    (map, file)
}

/// The root mean square error of the slips, and the summary, of a drive that stops and goes on ground whose slip changes.
fn drive(case: Case) -> (f64, Summary) {
    let mut noise = Noise::new(3);
    let mut rows = String::from("t,left,right,gyro,a,b,c");
    let (mut speed, mut slip, mut yaw, mut place, mut angles) =
        (0.0, 0.1, 0.0_f64, [0.0; 2], [0.0; 2]);
    let mut passed = [0.0; 3];
    let mut held = String::from(",,");
    let mut slips = Vec::new();
    for row in 0..ROWS {
        let time_s = row as f64 * STEP_S;
        let level = [0.0, 0.5, 0.25, 0.5][row / 350 % 4];
        let turn = if level > 0.0 {
            [0.15, -0.2, 0.0][row / 250 % 3]
        } else {
            0.0
        };
        speed += (level - speed) * STEP_S / 0.3;
        slip += ([0.1, 0.3][row / 600 % 2] - slip) * STEP_S / 0.2;
        if row % case.rows == 0 {
            let [a, b, c] = match case.kind {
                Kind::Pose => [place[0], place[1], yaw],
                Kind::Displacement => std::mem::take(&mut passed),
                Kind::Speed => [speed, 0.0, 0.0],
            }
            .map(|value| value + case.sigma * noise.normal());
            let digits = case.digits;
            held = format!("{a:.digits$},{b:.digits$},{c:.digits$}");
        }
        let is_written = case.is_held || row % case.rows == 0;
        let reference = if is_written { held.as_str() } else { ",," };
        let gyro = turn + 0.002 + 0.003 * noise.normal();
        let [left, right] = angles;
        write!(
            rows,
            "\n{time_s:.3},{left:.5},{right:.5},{gyro:.5},{reference}"
        )
        .unwrap();
        slips.push((time_s, slip));
        for (angle, side) in angles.iter_mut().zip([1.0, -1.0]) {
            *angle += (speed - side * HALF_TRACK_M * turn) / (1.0 - slip) * STEP_S / RADIUS_M;
        }
        passed[0] += speed * STEP_S;
        passed[2] += turn * STEP_S;
        place[0] += speed * yaw.cos() * STEP_S;
        place[1] += speed * yaw.sin() * STEP_S;
        yaw += turn * STEP_S;
    }
    let (map, file) = description(case);
    let log = Log::over(
        "log.csv".as_ref(),
        Cursor::new(rows),
        Some(map),
        &Topics::default(),
    )
    .unwrap();
    let (mut square, mut count) = (0.0, 0.0);
    let summary = run(&log, &file, &Options::default(), |row| {
        let same = slips.partition_point(|(time_s, _)| *time_s < row.time_s - 0.5 * STEP_S);
        if let (Some(found), true, Some((_, truth))) =
            (row.slip, row.time_s > 10.0, slips.get(same))
        {
            square += (found - truth).powi(2);
            count += 1.0;
        }
        Ok(())
    })
    .unwrap();
    (f64::sqrt(square / count), summary)
}

#[test]
fn rows_that_repeat_the_last_update_are_no_readings() {
    for (kind, rows, sigma) in [
        (Kind::Pose, 50, 0.01),
        (Kind::Pose, 10, 0.01),
        (Kind::Pose, 5, 0.01),
        (Kind::Displacement, 10, 0.003),
        (Kind::Speed, 50, 0.03),
        (Kind::Speed, 10, 0.03),
        (Kind::Speed, 3, 0.03),
    ] {
        let of = |is_held| {
            drive(Case {
                kind,
                rows,
                is_held,
                sigma,
                digits: 6,
            })
        };
        let ((with, summary), (without, empty)) = (of(true), of(false));
        println!("{kind:?} each {rows} rows: error {with:.4}, with empty fields {without:.4}");
        assert!(with < 1.02 * without, "{kind:?} {rows}: {with} {without}");
        let held = summary.held_reference.unwrap();
        let updates = ROWS.div_ceil(rows) as u64;
        assert_eq!((held.rows, held.updates), (ROWS as u64, updates));
        assert!((held.interval_s - rows as f64 * STEP_S).abs() < 1e-9);
        let readings = |summary: &Summary| summary.fused.reference;
        assert_eq!(readings(&summary), readings(&empty));
        assert_eq!(empty.held_reference, None);
    }
}

/// What repeats by itself: a simulated pose or speed without noise at rest and at a constant speed, and displacements of few
/// digits.
#[test]
fn readings_that_are_equal_are_readings() {
    for (kind, sigma, digits) in [
        (Kind::Pose, 0.0, 6),
        (Kind::Speed, 0.0, 6),
        (Kind::Displacement, 0.0, 6),
        (Kind::Speed, 0.01, 2),
        (Kind::Displacement, 0.0004, 3),
        (Kind::Displacement, 0.0002, 3),
    ] {
        let case = Case {
            kind,
            rows: 1,
            is_held: true,
            sigma,
            digits,
        };
        assert_eq!(drive(case).1.held_reference, None, "{case:?}");
    }
}

/// A speed each second is not lost between two readings; one each 8 s is.
#[test]
fn a_speed_is_silent_after_more_than_its_period() {
    for (rows, is_held) in [(50, false), (50, true), (400, false)] {
        let (_, summary) = drive(Case {
            kind: Kind::Speed,
            rows,
            is_held,
            sigma: 0.03,
            digits: 6,
        });
        for wheel in &summary.wheels {
            let share = |health| wheel.healths.get(health).copied().unwrap_or(0.0);
            let (ok, lost) = (share("Ok"), share("Degraded(ReferenceLost)"));
            println!("each {rows} rows: Ok {ok:.3}, lost {lost:.3}");
            if rows == 50 {
                assert!(ok > 0.85 && lost < 0.02, "{rows} {is_held}: {ok} {lost}");
            } else {
                assert!(lost > 0.01, "{lost}"); // 2 s of 8 s, less the rests
            }
        }
    }
}
