//! The whole way by places that have no heading: after an outage, of a robot that begins in reverse, and of one that drives in
//! every direction.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};
use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Options, Summary, run};
use grouser_synthetic::Noise;

/// 50 Hz.
const DT_S: f64 = 0.02;
const RADIUS_M: f64 = 0.1;
/// Of a place, m.
const SIGMA_M: f64 = 0.015;
/// Of the gyro, rad/s.
const BIAS_RAD_PER_S: f64 = 0.005;

/// Name, place (m) and heading (rad) of a wheel.
type Wheel = (&'static str, [f64; 2], f64);

const SKID: [Wheel; 4] = [
    ("front_left", [0.25, 0.3], 0.0),
    ("front_right", [0.25, -0.3], 0.0),
    ("rear_left", [-0.25, 0.3], 0.0),
    ("rear_right", [-0.25, -0.3], 0.0),
];
/// Three omni wheels.
const OMNI: [Wheel; 3] = [
    ("a", [0.0625, 0.108_253_2], 5.0 * FRAC_PI_6),
    ("b", [-0.125, 0.0], -FRAC_PI_2),
    ("c", [0.0625, -0.108_253_2], FRAC_PI_6),
];

/// Speed (m/s), course beside the heading (rad) and yaw rate (rad/s) to which the robot is driven.
type Motion = [f64; 3];

fn robot_text(wheels: &[Wheel]) -> String {
    let mut text =
        format!("format = 1\nname = \"cart\"\n[estimator]\nposition_sigma_m = {SIGMA_M}\n");
    for (name, [x, y], heading) in wheels {
        let heading_deg = heading.to_degrees();
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = {x}\ny_m = {y}\nradius_m = {RADIUS_M}\nheading_deg = {heading_deg:.6}\n\
             drive = \"powered\"\nticks_per_turn = 1000"
        )
        .unwrap();
    }
    text
}

fn map_text(wheels: &[Wheel], has_yaw: bool) -> String {
    let mut text = String::from(
        "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
         { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n\
         { column = \"x\", meaning = \"pose_x\", unit = \"m\" },\n\
         { column = \"y\", meaning = \"pose_y\", unit = \"m\" },\n",
    );
    if has_yaw {
        text += "{ column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" },\n";
    }
    for (name, ..) in wheels {
        writeln!(
            text,
            "{{ column = \"{name}\", meaning = \"wheel_count\", wheel = \"{name}\", unit = \"tick\" }},"
        )
        .unwrap();
    }
    text + "]\n"
}

/// The value at a time, where each holds for `each_s`.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "times are positive and short"
)]
fn in_turn(values: &[f64], each_s: f64, time_s: f64) -> f64 {
    values[(time_s / each_s) as usize % values.len()]
}

/// The slip of all wheels: it changes every 9 s.
fn slip(time_s: f64) -> f64 {
    in_turn(&[0.05, 0.3, 0.1, 0.5, 0.15], 9.0, time_s)
}

/// What is found of a drive, and the true slip of its whole way, without that of the outage.
fn drive(
    wheels: &[Wheel],
    seconds: u32,
    outage_s: [f64; 2],
    (rows, has_yaw): (u32, bool),
    motion: impl Fn(f64) -> Motion,
) -> (Summary, f64) {
    let (table, expected) = recorded(wheels, seconds, outage_s, rows, motion);
    (replayed(wheels, has_yaw, table), expected)
}

/// The table of a drive, and the true slip of its whole way.
fn recorded(
    wheels: &[Wheel],
    seconds: u32,
    outage_s: [f64; 2],
    rows: u32,
    motion: impl Fn(f64) -> Motion,
) -> (String, f64) {
    let mut noise = Noise::new(11);
    let mut table = String::from("t,gyro,x,y,yaw");
    for (name, ..) in wheels {
        write!(table, ",{name}").unwrap();
    }
    let (mut place, mut yaw, mut angles) = ([3.0, -2.0], 1.0_f64, vec![0.0; wheels.len()]);
    let [mut v_x, mut v_y, mut turn] = [0.0; 3];
    let (mut way, mut rims) = (0.0, 0.0);
    for row in 0..50 * seconds {
        let time_s = f64::from(row) * DT_S;
        let [speed, course, bend] = motion(time_s);
        for (now, wanted) in [
            (&mut v_x, speed * course.cos()),
            (&mut v_y, speed * course.sin()),
            (&mut turn, bend),
        ] {
            *now += (wanted - *now) * DT_S / 0.4;
        }
        let is_out = (outage_s[0]..outage_s[1]).contains(&time_s);
        let at = if row % rows == 0 && !is_out {
            let [x, y] = place.map(|part| part + SIGMA_M * noise.normal());
            format!("{x:.5},{y:.5},{:.5}", yaw + 0.01 * noise.normal())
        } else {
            ",,".to_owned()
        };
        let gyro = turn + BIAS_RAD_PER_S + 0.003 * noise.normal();
        write!(table, "\n{time_s:.3},{gyro:.5},{at}").unwrap();
        for angle in &angles {
            let ticks: f64 = angle / std::f64::consts::TAU * 1000.0;
            write!(table, ",{}", ticks.floor()).unwrap();
        }
        let share = 1.0 - slip(time_s);
        for (angle, (_, [x, y], heading)) in angles.iter_mut().zip(wheels) {
            let (sin, cos) = heading.sin_cos();
            let along = cos * (v_x - turn * y) + sin * (v_y + turn * x);
            *angle += along / share * DT_S / RADIUS_M;
        }
        let (sin, cos) = yaw.sin_cos();
        place[0] += (cos * v_x - sin * v_y) * DT_S;
        place[1] += (sin * v_x + cos * v_y) * DT_S;
        yaw += turn * DT_S;
        if !is_out {
            let passed = v_x.hypot(v_y) * DT_S;
            way += passed;
            rims += passed / share;
        }
    }
    (table, 1.0 - way / rims)
}

fn replayed(wheels: &[Wheel], has_yaw: bool, table: String) -> Summary {
    let document = |name: &str, text: String| Document::from_text(name, text).unwrap();
    let map = columns::parse(&document("map.toml", map_text(wheels, has_yaw))).unwrap();
    let robot = robot::parse(&document("robot.toml", robot_text(wheels))).unwrap();
    let bytes = Cursor::new(table);
    let log = Log::over("log.csv".as_ref(), bytes, Some(map), &Topics::default()).unwrap();
    run(&log, &robot, &Options::default(), |_| Ok(())).unwrap()
}

fn assert_known(situation: &str, (summary, expected): (Summary, f64)) {
    let ways = summary.fused.ways;
    let along = summary.along;
    println!(
        "{situation}: {expected:.3}, {ways:?} {along:?} {:?}",
        summary.doubts()
    );
    assert!(
        summary.doubts().is_empty(),
        "{situation}: {:?}",
        summary.doubts()
    );
    for found in [ways.slip_by_reference(), along.overall] {
        let off = found.unwrap() - expected;
        assert!(off.abs() < 0.03, "{situation}: {found:?}, {expected:.3}");
    }
}

/// Rows between places, which have no yaw.
const FIVE_A_SECOND: (u32, bool) = (10, false);

/// Bends to both sides.
fn bends(time_s: f64) -> f64 {
    in_turn(&[0.0, 0.3, 0.0, -0.3, 0.3], 7.0, time_s)
}

#[test]
fn the_whole_way_is_known_after_an_outage_in_which_the_heading_is_lost() {
    let found = drive(&SKID, 580, [90.0, 490.0], FIVE_A_SECOND, |time_s| {
        [0.5, 0.0, bends(time_s)]
    });
    assert_known("outage", found);
}

#[test]
fn the_whole_way_of_a_robot_that_begins_in_reverse_is_known() {
    let found = drive(&SKID, 120, [0.0; 2], FIVE_A_SECOND, |time_s| {
        let back = time_s < 25.0 || (60.0..75.0).contains(&time_s);
        let speed = if back { -0.4 } else { 0.5 };
        [if time_s < 3.0 { 0.0 } else { speed }, 0.0, bends(time_s)]
    });
    assert_known("reverse", found);
}

#[test]
fn the_whole_way_of_a_robot_that_drives_in_every_direction_is_known() {
    let found = drive(&OMNI, 120, [0.0; 2], FIVE_A_SECOND, |time_s| {
        let course = in_turn(&[0.0, 1.57, -0.7, 0.35, -1.57, 3.0], 8.0, time_s);
        [if time_s < 3.0 { 0.0 } else { 0.5 }, course, bends(time_s)]
    });
    assert_known("every direction", found);
}

/// Places and poses that come more seldom than the window of the estimates.
#[test]
fn the_whole_way_beside_a_seldom_reference_is_known() {
    for rows in [65, 80, 100] {
        for has_yaw in [true, false] {
            let found = drive(&SKID, 120, [0.0; 2], (rows, has_yaw), |time_s| {
                [if time_s < 3.0 { 0.0 } else { 0.5 }, 0.0, bends(time_s)]
            });
            assert_known("seldom", found);
        }
    }
}

/// A recorder that writes nothing for 0.9 s of every 4 s: the slip of the whole way is that of the rest.
#[test]
fn the_whole_way_of_a_log_with_gaps_is_known() {
    for has_yaw in [true, false] {
        let (table, expected) = recorded(&SKID, 120, [0.0; 2], 10, |time_s| {
            [if time_s < 3.0 { 0.0 } else { 0.5 }, 0.0, bends(time_s)]
        });
        let is_kept = |line: &&str| {
            let time_s = line.split(',').next().and_then(|time| time.parse().ok());
            time_s.is_none_or(|time: f64| time % 4.0 > 0.9)
        };
        let kept: Vec<&str> = table.lines().filter(is_kept).collect();
        let found = replayed(&SKID, has_yaw, kept.join("\n"));
        assert_known("gaps", (found, expected));
    }
}
