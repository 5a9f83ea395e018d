//! What a part of a log looks like to the check of units, signs and axes, and what the whole log shows.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_doctor::StartOutcome;
use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Options, check_start, run};
use grouser_synthetic::Noise;

const ROBOT: &str = "format = 1\nname = \"cart\"\n[estimator]\nposition_sigma_m = 0.01\n\
    [[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.3\nradius_m = 0.1\ndrive = \"powered\"\n\
    [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.3\nradius_m = 0.1\ndrive = \"powered\"\n";
const MAP: &str = "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
    { column = \"left\", meaning = \"wheel_rate\", wheel = \"left\", unit = \"rad/s\" },\n\
    { column = \"right\", meaning = \"wheel_rate\", wheel = \"right\", unit = \"rad/s\" },\n\
    { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n\
    { column = \"ahead\", meaning = \"acceleration_forward\", unit = \"m/s2\" },\n\
    { column = \"aside\", meaning = \"acceleration_left\", unit = \"m/s2\" },\n\
    { column = \"x\", meaning = \"pose_x\", unit = \"m\" },\n\
    { column = \"y\", meaning = \"pose_y\", unit = \"m\" },\n\
    { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" },\n]\n";

/// What is special of a drive.
#[derive(Clone, Copy)]
struct Drive {
    /// The slope, rad: from 7 to 9 s, while the robot speeds up, and then now and again.
    slope: f64,
    /// The slip of the right wheel in bends to the right, which ask least of it.
    spin: f64,
    /// What the sensors show of the truth.
    gyro: f64,
    acceleration: f64,
    pose: f64,
    slip: f64,
}

const PLAIN: Drive = Drive {
    slope: 0.0,
    spin: 0.1,
    gyro: 1.0,
    acceleration: 1.0,
    pose: 1.0,
    slip: 0.1,
};

/// What the beginning and what the whole log says.
fn outcomes(drive: Drive) -> (StartOutcome, StartOutcome) {
    let mut table = String::from("t,left,right,gyro,ahead,aside,x,y,yaw\n");
    let mut noise = Noise::new(5);
    let (mut speed, mut turn, mut pitch) = (0.0, 0.0, 0.0_f64);
    let (mut x, mut y, mut yaw) = (0.0, 0.0, 0.0_f64);
    let dt = 0.02;
    for row in 0..5000_u32 {
        let time = f64::from(row) * dt;
        let level = match time {
            ..4.0 => 0.0,
            ..7.0 => 0.1,
            _ => [0.3, 0.5, 0.2, 0.4][(row / 350 % 4) as usize],
        };
        let bend = match time {
            ..8.0 => 0.0,
            _ => [0.0, -0.3, 0.0, 0.4][(row / 250 % 4) as usize],
        };
        let steep = match time {
            ..7.0 => 0.0,
            ..9.0 => drive.slope,
            _ => [0.0, -drive.slope, 0.5 * drive.slope][(row / 275 % 3) as usize],
        };
        let gained = (level - speed) / 0.5;
        speed += gained * dt;
        turn += (bend - turn) * dt / 0.3;
        pitch += (steep - pitch) * dt / 0.4;
        let rim = |side: f64, slip: f64| (speed + side * 0.3 * turn) / (1.0 - slip) / 0.1;
        let left = rim(-1.0, drive.slip);
        let right = rim(1.0, if turn < -0.05 { drive.spin } else { drive.slip });
        let ahead = gained + 9.81 * pitch.sin() + 0.05 * noise.normal();
        let aside = speed * turn + 0.05 * noise.normal();
        let place = [x, y].map(|place: f64| drive.pose * (place + 0.005 * noise.normal()));
        writeln!(
            table,
            "{time},{left},{right},{},{},{},{},{},{}",
            drive.gyro * (turn + 0.003 * noise.normal()),
            drive.acceleration * ahead,
            drive.acceleration * aside,
            place[0],
            place[1],
            yaw + 0.005 * noise.normal(),
        )
        .unwrap();
        x += speed * yaw.cos() * dt;
        y += speed * yaw.sin() * dt;
        yaw += turn * dt;
    }
    let document = |name: &str, text: &str| Document::from_text(name, text.into()).unwrap();
    let robot = robot::parse(&document("robot.toml", ROBOT)).unwrap();
    let map = columns::parse(&document("map.toml", MAP)).unwrap();
    let bytes = Cursor::new(table);
    let log = Log::over("log.csv".as_ref(), bytes, Some(map), &Topics::default()).unwrap();
    let summary = run(&log, &robot, &Options::default(), |_| Ok(())).unwrap();
    let first = check_start(&log, &robot, &Options::default()).unwrap();
    println!("{first:?} {:?}", summary.doubts());
    (first, first.beside(&summary.findings))
}

#[test]
fn slopes_a_spinning_wheel_and_slip_are_no_unit_and_no_sign() {
    assert_eq!(outcomes(PLAIN).1, StartOutcome::Plausible);
    let (first, whole) = outcomes(Drive {
        slope: 0.45,
        ..PLAIN
    });
    assert!(
        matches!(first, StartOutcome::Implausible { .. }),
        "{first:?}"
    );
    assert_eq!(whole, StartOutcome::Plausible);
    let (first, whole) = outcomes(Drive { spin: 0.9, ..PLAIN });
    assert!(
        matches!(first, StartOutcome::Implausible { .. }),
        "{first:?}"
    );
    assert_eq!(whole, StartOutcome::Plausible);
    // digging all the time
    let (_, whole) = outcomes(Drive {
        slip: 0.75,
        spin: 0.75,
        ..PLAIN
    });
    assert_eq!(whole, StartOutcome::Plausible);
}

#[test]
fn a_unit_or_a_sign_is_wrong_over_the_whole_log() {
    for wrong in [
        Drive {
            acceleration: 1000.0,
            ..PLAIN
        },
        Drive {
            acceleration: 0.102,
            ..PLAIN
        },
        Drive {
            acceleration: -1.0,
            ..PLAIN
        },
        Drive {
            gyro: -1.0,
            ..PLAIN
        },
        Drive {
            gyro: 57.3,
            ..PLAIN
        },
        Drive {
            pose: 0.01,
            ..PLAIN
        },
        Drive {
            pose: 100.0,
            ..PLAIN
        },
    ] {
        let (_, whole) = outcomes(wrong);
        assert!(
            matches!(
                whole,
                StartOutcome::Implausible { .. } | StartOutcome::Contradicted(_)
            ),
            "{whole:?}"
        );
    }
}
