//! The delay of a reference, found from a log: generated logs whose delay is known, and a measured one whose reference is shifted.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of steps"
)]

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_doctor::ReferenceDelay;
use grouser_files::robot::RobotFile;
use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Doubt, Options, calibrate_reference_delay, run};
use grouser_slip::Measurement;
use grouser_synthetic::Noise;

use crate::shipped::data;

const STEP_S: f64 = 0.005;
const HALF_TRACK_M: f64 = 0.2;
const RADIUS_M: f64 = 0.1;
const GYRO_BIAS: f64 = 0.01;

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Pose,
    Displacement,
    Speed,
}

/// A drive and its sensors.
#[derive(Clone, Copy)]
struct Case {
    kind: Kind,
    /// Rate of the reference, Hz, and its noise, m or m/s.
    rate_hz: f64,
    sigma: f64,
    /// How much later than wheels the reference and the gyro are stamped, s.
    delay_s: f64,
    gyro_delay_s: f64,
    has_gyro: bool,
    top_m_per_s: f64,
    /// Is the robot driven at one speed, straight on?
    is_steady: bool,
    /// Or at a speed that repeats itself after this time, s?
    period_s: Option<f64>,
    /// Slip beside the constant one: by the gain in speed, s²/m, and in jumps.
    slip_by_gain: f64,
    has_jumps: bool,
    seed: u64,
}

const CASE: Case = Case {
    kind: Kind::Pose,
    rate_hz: 5.0,
    sigma: 0.01,
    delay_s: 0.0,
    gyro_delay_s: 0.0,
    has_gyro: true,
    top_m_per_s: 0.8,
    is_steady: false,
    period_s: None,
    slip_by_gain: 0.0,
    has_jumps: false,
    seed: 1,
};

/// Followed levels: of the speed, the turn rate and the slip.
fn levels(noise: &mut Noise, hold_s: f64, lag_s: f64, level: impl Fn(f64) -> f64) -> Vec<f64> {
    let (mut now, mut target, mut left_s) = (level(0.0), level(0.0), 2.0);
    let steps = (120.0 / STEP_S) as usize;
    let mut out = Vec::with_capacity(steps);
    for _ in 0..steps {
        left_s -= STEP_S;
        if left_s < 0.0 {
            left_s = hold_s * (0.5 + noise.uniform());
            target = level(noise.uniform());
        }
        now += (target - now) * STEP_S / lag_s;
        out.push(now);
    }
    out
}

/// Rows of time, wheels, gyro and reference, of which each has one part; and the true slip at each step.
fn drive(case: &Case) -> (Log, Vec<f64>) {
    let mut noise = Noise::new(case.seed);
    let mut speed = levels(&mut noise, 6.0, 0.3, |draw| {
        let level = [0.0, 1.0, 0.5, 0.25, -0.4][(draw * 4.99) as usize];
        case.top_m_per_s * if case.is_steady { 1.0 } else { level }
    });
    if let Some(period_s) = case.period_s {
        for (step, speed) in speed.iter_mut().enumerate() {
            let phase = std::f64::consts::TAU * step as f64 * STEP_S / period_s;
            *speed = case.top_m_per_s * (1.0 + 0.6 * phase.sin());
        }
    }
    let turn = levels(&mut noise, 5.0, 0.5, |draw| {
        if case.is_steady {
            0.0
        } else {
            0.4 * (draw - 0.5)
        }
    });
    let slip = levels(&mut noise, 8.0, 0.15, |draw| {
        if case.has_jumps {
            0.05 + 0.5 * draw
        } else {
            0.15
        }
    });
    let mut rows: Vec<(f64, String)> = Vec::new();
    let (mut x, mut y, mut yaw, mut angles) = (0.0, 0.0, 0.0_f64, [0.0; 2]);
    let mut last = (0.0, 0.0, 0.0);
    let mut slips = Vec::new();
    let each = (1.0 / (case.rate_hz * STEP_S)).round() as usize;
    for (step, ((v, w), s)) in speed.iter().zip(&turn).zip(&slip).enumerate() {
        let time_s = step as f64 * STEP_S;
        let gain = (speed.get(step + 1).unwrap_or(v) - v) / STEP_S;
        // the body is as fast as the rims less the slip; slip by c times the gain, on the side of the motion
        let rim = |side: f64| {
            let ground = v - side * HALF_TRACK_M * w;
            (ground + case.slip_by_gain * ground.abs() * gain) / (1.0 - s)
        };
        if step % 4 == 0 {
            let [left, right] = angles;
            rows.push((time_s, format!("{left:.5},{right:.5},,,,")));
            if case.has_gyro {
                let rate = w + GYRO_BIAS + 0.003 * noise.normal();
                rows.push((time_s + case.gyro_delay_s, format!(",,{rate:.5},,,")));
            }
        }
        if step % each == each / 2 {
            let [e, f] = [noise.normal(), noise.normal()].map(|draw| case.sigma * draw);
            let turn_error = 0.005 * noise.normal();
            let (sin, cos) = f64::sin_cos(0.5 * (yaw + last.2));
            let (dx, dy) = (x - last.0, y - last.1);
            let row = match case.kind {
                Kind::Pose => [x + e, y + f, yaw + turn_error],
                Kind::Displacement => [
                    cos * dx + sin * dy + e,
                    cos * dy - sin * dx + f,
                    yaw - last.2 + turn_error,
                ],
                Kind::Speed => [v + e, 0.0, 0.0],
            };
            last = (x, y, yaw);
            let [a, b, c] = row;
            rows.push((time_s + case.delay_s, format!(",,,{a:.5},{b:.5},{c:.5}")));
        }
        slips.push(*s);
        for (angle, side) in angles.iter_mut().zip([1.0, -1.0]) {
            *angle += rim(side) * STEP_S / RADIUS_M;
        }
        x += v * yaw.cos() * STEP_S;
        y += v * yaw.sin() * STEP_S;
        yaw += w * STEP_S;
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut table = String::from("t,left,right,gyro,a,b,c");
    for (time_s, row) in rows {
        write!(table, "\n{:.4},{row}", time_s + 1.0).unwrap();
    }
    let map = column_map(case.kind);
    let map = columns::parse(&Document::from_text("map.toml", map).unwrap()).unwrap();
    let bytes = Cursor::new(table);
    let log = Log::over("log.csv".as_ref(), bytes, Some(map), &Topics::default()).unwrap();
    (log, slips)
}

fn column_map(kind: Kind) -> String {
    let (names, unit) = match kind {
        Kind::Pose => (["pose_x", "pose_y", "pose_yaw"], "m"),
        Kind::Displacement => (
            [
                "displacement_forward",
                "displacement_left",
                "displacement_turn",
            ],
            "m",
        ),
        Kind::Speed => (["speed_forward", "speed_left", ""], "m/s"),
    };
    let mut map = String::from(
        "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
        { column = \"left\", meaning = \"wheel_angle\", wheel = \"left\", unit = \"rad\" },\n\
        { column = \"right\", meaning = \"wheel_angle\", wheel = \"right\", unit = \"rad\" },\n\
        { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n",
    );
    for (column, (meaning, unit)) in
        ["a", "b", "c"]
            .iter()
            .zip([(names[0], unit), (names[1], unit), (names[2], "rad")])
    {
        if !meaning.is_empty() {
            writeln!(
                map,
                "{{ column = \"{column}\", meaning = \"{meaning}\", unit = \"{unit}\" }},"
            )
            .unwrap();
        }
    }
    map.push_str("]\n");
    map
}

fn cart(case: &Case, filter: &str) -> RobotFile {
    let mut text = format!(
        "format = 1\nname = \"cart\"\n[estimator]\nposition_sigma_m = {}\nspeed_sigma_m_per_s = {}\n[filter]\n{filter}\n",
        case.sigma, case.sigma
    );
    for (name, y) in [("left", HALF_TRACK_M), ("right", -HALF_TRACK_M)] {
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = 0.0\ny_m = {y}\nradius_m = {RADIUS_M}\ndrive = \"powered\""
        )
        .unwrap();
    }
    robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap()
}

fn found(case: &Case, filter: &str) -> Option<ReferenceDelay> {
    let logs = [drive(case).0];
    calibrate_reference_delay(&logs, &cart(case, filter), &Options::default()).unwrap()
}

fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for (kind, rate_hz, sigma) in [
        (Kind::Pose, 1.0, 0.005),
        (Kind::Pose, 5.0, 0.01),
        (Kind::Displacement, 20.0, 0.002),
        (Kind::Speed, 2.0, 0.01),
        (Kind::Speed, 10.0, 0.03),
    ] {
        for has_gyro in [true, false] {
            for has_jumps in [true, false] {
                all.push(Case {
                    kind,
                    rate_hz,
                    sigma,
                    has_gyro,
                    has_jumps,
                    seed: all.len() as u64,
                    ..CASE
                });
            }
        }
    }
    all
}

#[test]
fn a_delay_is_found_at_every_rate_and_of_both_signs() {
    let (mut missed, mut outside, mut count) = (0, 0, 0);
    for case in cases() {
        for delay_s in [-0.2, -0.06, 0.06, 0.1, 0.3, 0.7] {
            let case = Case { delay_s, ..case };
            count += 1;
            let Some(delay) = found(&case, "").filter(|delay| delay.is_clear) else {
                missed += 1;
                continue;
            };
            let error_s = (delay.delay_s - delay_s).abs();
            outside += i32::from(error_s > delay.half_width_s);
            assert!(error_s < 0.03, "{delay_s}: {delay:?}");
        }
    }
    println!("{missed} of {count} delays missed, {outside} outside of their interval");
    assert!(10 * missed < 2 * count && 10 * outside < count);
}

#[test]
fn where_there_is_no_delay_none_is_found() {
    for case in cases() {
        for slip_by_gain in [0.0, 0.06] {
            let case = Case {
                slip_by_gain,
                top_m_per_s: 1.5,
                ..case
            };
            let delay = found(&case, "");
            assert!(!delay.is_some_and(|delay| delay.is_clear), "{delay:?}");
        }
    }
    let steady = Case {
        is_steady: true,
        delay_s: 0.2,
        ..CASE
    };
    assert_eq!(found(&steady, ""), None);
}

/// The reference turns as the gyro does 0.15 s before, and drives as the wheels do: nothing to be said of one delay.
/// A delay by whole periods fits a drive that repeats itself as well: one of −5 s was found, and the result was doubtful.
#[test]
fn a_drive_that_repeats_itself_shows_no_delay_of_whole_periods() {
    for seed in 0..6 {
        for (kind, sigma) in [(Kind::Speed, 0.01), (Kind::Pose, 0.005)] {
            for period_s in [0.5, 1.0, 2.0] {
                let case = Case {
                    kind,
                    sigma,
                    rate_hz: 10.0,
                    is_steady: true,
                    period_s: Some(period_s),
                    has_gyro: false,
                    top_m_per_s: 0.5,
                    seed,
                    ..CASE
                };
                let found = found(&case, "");
                println!("{seed} {period_s}: {found:?}");
                assert!(!found.is_some_and(|found| found.is_clear), "{found:?}");
            }
        }
    }
}

#[test]
fn wheels_and_gyro_have_delays_of_their_own() {
    for (delay_s, gyro_delay_s) in [(0.0, 0.15), (0.2, 0.1), (-0.15, -0.12)] {
        let case = Case {
            delay_s,
            gyro_delay_s,
            ..CASE
        };
        let of = found(&case, "").unwrap();
        let gyro_s = of.gyro_delay_s.unwrap();
        assert!((of.delay_s - delay_s).abs() < 0.02, "{of:?}");
        assert!((gyro_s - gyro_delay_s).abs() < 0.03, "{of:?}");
        // what is corrected no longer errs
        let (wrong, right) = (error(&case, ""), error(&CASE, ""));
        assert!(wrong < 1.2 * right, "{wrong} {right}");
    }
}

#[test]
fn a_stated_delay_is_used_as_stated_and_compared() {
    let case = Case {
        delay_s: 0.2,
        ..CASE
    };
    let right = found(&case, "reference_latency_s = 0.2").unwrap();
    assert!(right.is_stated && !right.is_clear && (right.delay_s - 0.2).abs() < 0.02);
    for stated in ["0.0", "0.1"] {
        let file = cart(&case, &format!("reference_latency_s = {stated}"));
        let summary = run(&drive(&case).0, &file, &Options::default(), |_| Ok(())).unwrap();
        let wrong = summary.reference_delay.unwrap();
        assert!(wrong.is_clear && wrong.is_stated && !wrong.is_applied);
        assert!((wrong.delay_s - 0.2).abs() < 0.02, "{wrong}");
        assert!(wrong.to_string().contains("not applied"), "{wrong}");
    }
}

/// Root mean square error of slip.
fn error(case: &Case, filter: &str) -> f64 {
    let (log, slips) = drive(case);
    let (mut square, mut count) = (0.0, 0.0);
    run(&log, &cart(case, filter), &Options::default(), |row| {
        let step = (row.time_s / STEP_S).round() as usize;
        if let (Some(slip), true, Some(truth)) = (row.slip, row.time_s > 10.0, slips.get(step)) {
            square += (slip - truth).powi(2);
            count += 1.0;
        }
        Ok(())
    })
    .unwrap();
    f64::sqrt(square / count)
}

#[test]
fn a_delay_that_is_found_is_used() {
    for delay_s in [0.2, -0.2] {
        let case = Case { delay_s, ..CASE };
        let (with, without) = (error(&case, ""), error(&case, "reference_latency_s = 0.0"));
        println!("{delay_s} s: error of slip {with:.4}, without the delay {without:.4}");
        assert!(with < 0.7 * without, "{delay_s}: {with} {without}");
    }
}

/// Beyond the latency that the filter has, and of clocks of two computers: reported, not applied, and the run goes on.
#[test]
fn clocks_that_are_apart_are_reported_and_not_corrected() {
    for (delay_s, seed) in [
        (1.04, 1),
        (1.2, 2),
        (1.5, 3),
        (3.0, 4),
        (-0.8, 5),
        (-4.0, 6),
    ] {
        for kind in [Kind::Pose, Kind::Displacement, Kind::Speed] {
            let case = Case {
                kind,
                delay_s,
                seed,
                ..CASE
            };
            let case = if kind == Kind::Displacement {
                Case {
                    sigma: 0.002,
                    ..case
                }
            } else {
                case
            };
            let summary = run(
                &drive(&case).0,
                &cart(&case, ""),
                &Options::default(),
                |_| Ok(()),
            );
            let summary = summary.unwrap();
            let delay = summary.reference_delay.unwrap();
            assert!((delay.delay_s - delay_s).abs() < 0.03, "{delay_s}: {delay}");
            assert!(!delay.is_applied && delay.is_clear);
            let doubts = summary.doubts();
            let is_named = |doubt: &Doubt| matches!(doubt, Doubt::ClocksApart(_));
            assert!(doubts.iter().any(is_named), "{doubts:?}");
        }
    }
}

/// A mower whose positions and wheels are stamped alike: each shift of its positions is found.
#[test]
fn shifts_of_measured_positions_are_found() {
    let Some(folder) = data("plaza") else {
        return;
    };
    let columns = [
        ("distance_m", "wheel_angle\", wheel = \"wheels", "rad"),
        ("yaw_rate_rad_s", "yaw_rate", "rad/s"),
        ("x_m", "pose_x", "m"),
        ("y_m", "pose_y", "m"),
        ("yaw_rad", "pose_yaw", "rad"),
    ];
    let mut map = String::from(
        "format = 1\n[[table]]\ntime = { column = \"time_s\", unit = \"s\" }\ncolumns = [\n",
    );
    for (column, meaning, unit) in columns {
        let _ = writeln!(
            map,
            "{{ column = \"{column}\", meaning = \"{meaning}\", unit = \"{unit}\" }},"
        );
    }
    map.push_str("]\n");
    let map = columns::parse(&Document::from_text("map.toml", map).unwrap()).unwrap();
    let measured = Log::find(&[folder.join("plaza1.csv.gz")], map.clone()).unwrap();
    let text = "format = 1\nname = \"mower\"\n[[wheel]]\nname = \"wheels\"\nx_m = 0.0\ny_m = 0.0\n\
        radius_m = 1.0\ndrive = \"powered\"\n";
    let file = robot::parse(&Document::from_text("robot.toml", text.into()).unwrap()).unwrap();
    for shift_s in [-0.3, -0.1, 0.0, 0.1, 0.2, 0.7] {
        let mut rows: Vec<(f64, String)> = Vec::new();
        for sample in measured.samples(&[]).unwrap() {
            let sample = sample.unwrap();
            let time_s = sample.time_ns as f64 * 1e-9;
            rows.push(match sample.measurement {
                Measurement::WheelAngle { angle, .. } => (time_s, format!("{angle},,,,")),
                Measurement::YawRate { rate } => (time_s, format!(",{rate},,,")),
                Measurement::Pose { x, y, yaw } => (time_s + shift_s, format!(",,{x},{y},{yaw}")),
                _ => continue,
            });
        }
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut table = String::from("time_s,distance_m,yaw_rate_rad_s,x_m,y_m,yaw_rad");
        for (time_s, row) in rows {
            write!(table, "\n{:.4},{row}", time_s + 1.0).unwrap();
        }
        let bytes = Cursor::new(table);
        let map = Some(map.clone());
        let log = Log::over("log.csv".as_ref(), bytes, map, &Topics::default()).unwrap();
        let found = calibrate_reference_delay(&[log], &file, &Options::default()).unwrap();
        let found = found.unwrap();
        println!("shifted by {shift_s} s: {found}");
        assert!((found.delay_s - shift_s).abs() < 0.01);
        assert_eq!(found.is_clear, shift_s != 0.0);
    }
}
