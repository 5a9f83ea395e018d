//! A robot of two bodies with a vertical joint: its wheels' slips against a world made of positions alone.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Options, Summary, run};

const DT_S: f64 = 0.02;
const ROWS: i32 = 3000;
const RADIUS_M: f64 = 0.25;
/// From the rear axle to the joint, from the joint to the front axle, and half of the track, m.
const REAR_M: f64 = 0.7;
const FRONT_M: f64 = 0.5;
const HALF_TRACK_M: f64 = 0.45;
const SPEED_M_PER_S: f64 = 0.8;
/// Wheels: name, on the front body?, side; and true slip.
const WHEELS: [(&str, bool, f64, f64); 4] = [
    ("rear_left", false, 1.0, 0.1),
    ("rear_right", false, -1.0, 0.1),
    ("front_left", true, 1.0, 0.25),
    ("front_right", true, -1.0, 0.1),
];

/// The joint's angle, rad: it weaves with up to 0.15 rad/s.
fn joint(time: f64) -> f64 {
    0.5 * (0.3 * time).sin()
}

/// Place and heading of the rear axle.
type Pose = [f64; 3];

/// The place of a wheel in the world and its heading.
fn wheel_at([x, y, yaw]: Pose, angle: f64, is_front: bool, side: f64) -> Pose {
    let ahead = |[x, y, yaw]: Pose, by: f64| [x + by * yaw.cos(), y + by * yaw.sin(), yaw];
    let axle = if is_front {
        let [x, y, yaw] = ahead([x, y, yaw], REAR_M);
        ahead([x, y, yaw + angle], FRONT_M)
    } else {
        [x, y, yaw]
    };
    let (sin, cos) = axle[2].sin_cos();
    [
        axle[0] - side * HALF_TRACK_M * sin,
        axle[1] + side * HALF_TRACK_M * cos,
        axle[2],
    ]
}

/// The next pose: the rear axle moves along its heading, the front axle along its own. The yaw for which the front axle does not
/// move sideways is found by halving.
fn step(pose: Pose, time: f64) -> Pose {
    let next = |turn: f64| {
        let yaw = pose[2] + 0.5 * turn;
        let way = SPEED_M_PER_S * DT_S;
        [
            pose[0] + way * yaw.cos(),
            pose[1] + way * yaw.sin(),
            pose[2] + turn,
        ]
    };
    let middle = |pose: Pose, time: f64| wheel_at(pose, joint(time), true, 0.0);
    let sideways = |turn: f64| {
        let (from, to) = (middle(pose, time), middle(next(turn), time + DT_S));
        let (sin, cos) = (0.5 * (from[2] + to[2])).sin_cos();
        cos * (to[1] - from[1]) - sin * (to[0] - from[0])
    };
    let (mut low, mut high) = (-0.1, 0.1);
    for _ in 0..60 {
        let turn = 0.5 * (low + high);
        if sideways(turn) > 0.0 {
            high = turn;
        } else {
            low = turn;
        }
    }
    next(low)
}

fn log() -> Log {
    let mut table = String::from("t,joint,gyro,dx,dy,dyaw");
    for (name, ..) in WHEELS {
        write!(table, ",{name}").unwrap();
    }
    let mut pose = [0.0; 3];
    for row in 0..ROWS {
        let time = f64::from(row) * DT_S;
        let next = step(pose, time);
        let turn = next[2] - pose[2];
        let (dx, dy) = (next[0] - pose[0], next[1] - pose[1]);
        let (sin, cos) = pose[2].sin_cos();
        write!(
            table,
            "\n{:.4},{:.6},{:.6},{:.8},{:.8},{turn:.8}",
            time + DT_S,
            joint(time + DT_S),
            turn / DT_S,
            cos * dx + sin * dy,
            cos * dy - sin * dx
        )
        .unwrap();
        for (_, is_front, side, slip) in WHEELS {
            let from = wheel_at(pose, joint(time), is_front, side);
            let to = wheel_at(next, joint(time + DT_S), is_front, side);
            let (sin, cos) = (0.5 * (from[2] + to[2])).sin_cos();
            let way = cos * (to[0] - from[0]) + sin * (to[1] - from[1]);
            write!(table, ",{:.6}", way / DT_S / (1.0 - slip) / RADIUS_M).unwrap();
        }
        pose = next;
    }
    let rates = WHEELS.map(|(name, ..)| {
        format!("{{ column = \"{name}\", meaning = \"wheel_rate\", wheel = \"{name}\", unit = \"rad/s\" }},\n")
    });
    let map = format!(
        "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n{}\
         {{ column = \"joint\", meaning = \"steering_angle\", unit = \"rad\" }},\n\
         {{ column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" }},\n\
         {{ column = \"dx\", meaning = \"displacement_forward\", unit = \"m\" }},\n\
         {{ column = \"dy\", meaning = \"displacement_left\", unit = \"m\" }},\n\
         {{ column = \"dyaw\", meaning = \"displacement_turn\", unit = \"rad\" }},\n]\n",
        rates.concat()
    );
    let map = columns::parse(&Document::from_text("map.toml", map).unwrap()).unwrap();
    let bytes = Cursor::new(table);
    Log::over("log.csv".as_ref(), bytes, Some(map), &Topics::default()).unwrap()
}

fn text(steering: &str) -> String {
    let mut text = format!("format = 1\nname = \"loader\"\n{steering}\n");
    for (name, is_front, side, _) in WHEELS {
        let x = if is_front { REAR_M + FRONT_M } else { 0.0 };
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = {x:?}\ny_m = {:?}\nradius_m = {RADIUS_M:?}\ndrive = \"powered\"",
            side * HALF_TRACK_M
        )
        .unwrap();
    }
    text
}

fn file(steering: &str) -> grouser_files::Result<robot::RobotFile> {
    robot::parse(&Document::from_text("robot.toml", text(steering))?)
}

/// Root mean square error of each wheel's slip after 5 s, with the run's summary.
fn errors(steering: &str, smooth: bool) -> ([f64; 4], Summary) {
    let options = Options {
        offline: smooth,
        ..Options::default()
    };
    let mut sums = [(0.0, 0.0); 4];
    let summary = run(&log(), &file(steering).unwrap(), &options, |row| {
        if let Some(slip) = row.slip.filter(|_| row.time_s > 5.0) {
            sums[row.wheel].0 += (slip - WHEELS[row.wheel].3).powi(2);
            sums[row.wheel].1 += 1.0;
        }
        Ok(())
    })
    .unwrap();
    (
        sums.map(|(sum, count): (f64, f64)| (sum / count).sqrt()),
        summary,
    )
}

const ARTICULATED: &str = "[steering]\nkind = \"articulated\"\nwheels = [\"front_left\", \"front_right\"]\njoint_x_m = 0.7";

#[test]
fn the_slips_of_an_articulated_robot_are_those_of_the_world() {
    let (found, summary) = errors(ARTICULATED, false);
    println!("articulated: rmse {found:.4?}");
    assert!(found.iter().all(|error| *error < 0.015), "{found:?}");
    assert!(summary.findings.mistakes.is_empty());
    let (smooth, _) = errors(ARTICULATED, true);
    println!("articulated, smoothed: rmse {smooth:.4?}");
    assert!(smooth.iter().all(|error| *error < 0.015), "{smooth:?}");
    assert!(summary.findings.turns.is_none());
    // Described as another steering, the same log shows slips that are not there.
    let ackermann = ARTICULATED
        .replace("articulated", "ackermann")
        .replace("\njoint_x_m = 0.7", "");
    let (wrong, _) = errors(&ackermann, false);
    println!("as ackermann: rmse {wrong:.4?}");
    assert!(wrong[3] > 0.05, "{wrong:?}");
}

#[test]
fn an_articulated_steering_is_checked_and_written() {
    let whole = file(ARTICULATED).unwrap();
    let again = Document::from_text("again.toml", robot::to_toml(&whole)).unwrap();
    assert_eq!(robot::parse(&again).unwrap(), whole);
    for (old, new, reason) in [
        ("\njoint_x_m = 0.7", "", "joint_x_m"),
        ("= 0.7", "= 700.0", "must lie in"),
        ("= 0.7", "= \"x\"", "joint_x_m"),
        ("articulated", "ackermann", "no such key as `joint_x_m`"),
        ("front_left\"", "front_lef\"", "did you mean \"front_left\""),
    ] {
        let error = file(&ARTICULATED.replace(old, new))
            .unwrap_err()
            .to_string();
        assert!(error.contains(reason), "{error}");
    }
}
