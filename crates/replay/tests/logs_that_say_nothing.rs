//! Logs and robots that do not fit, and logs in which nothing happens.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use grouser_files::robot::WheelSensor;
use grouser_replay::{Doubt, Error, Options, Status, run};
use grouser_slip::{Reference, Robot, WheelRole};

use crate::shipped;
use crate::shipped::{Example, example};

struct File(PathBuf);

impl File {
    fn new(name: &str, text: &str) -> Self {
        let folder =
            std::env::temp_dir().join(format!("grouser-replay-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("log.csv");
        fs::write(&path, text).unwrap();
        Self(path)
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(self.0.parent().unwrap());
    }
}

const HEADER: &str = "time_ms,front_left_ticks,front_right_ticks,rear_left_ticks,rear_right_ticks,\
                      fifth_ticks,gyro_z_rad_per_s\n";

fn fails(five: &Example, options: &Options) -> Error {
    let log = five.log(shipped::root().join("examples/five-wheel/log.csv"));
    run(&log, &five.robot, options, |_| Ok(())).unwrap_err()
}

#[test]
fn a_log_in_which_nothing_moves_has_a_status() {
    let mut text = HEADER.to_owned();
    for row in 0..200 {
        writeln!(text, "{},5,5,5,5,5,0.001", row * 20).unwrap();
    }
    let file = File::new("still", &text);
    let summary = example("five-wheel").summary(file.0.clone(), &Options::default());
    assert_eq!(summary.status, Status::NoSlip);
    assert!(
        summary
            .wheels
            .iter()
            .all(|wheel| wheel.slip.median.is_none())
    );
    assert_eq!(summary.along.overall, None);
    assert!(
        summary.wheels[0]
            .states
            .iter()
            .any(|(name, share)| *name == "Standstill" && *share > 0.8)
    );
}

#[test]
fn a_log_of_one_row_or_of_one_time_has_a_status() {
    for rows in [
        "0,1,2,3,4,5,0\n",
        "7,1,2,3,4,5,0\n7,9,9,9,9,9,0\n7,1,1,1,1,1,0\n",
    ] {
        let file = File::new("one", &format!("{HEADER}{rows}"));
        let summary = example("five-wheel").summary(file.0.clone(), &Options::default());
        assert_eq!(summary.status, Status::NoSlip);
        assert!(summary.duration_s.abs() < 1e-12);
    }
}

#[test]
fn times_of_the_next_centuries_and_wild_counts_do_no_harm() {
    let mut text = HEADER.to_owned();
    let mut count: u64 = 1;
    for row in 0..2000_u64 {
        // A multiplicative walk through all that 16 bits hold, and gaps up to a year.
        count = count * 48_271 % 2_147_483_647;
        let time = row * 20 + (row / 500) * 31_536_000_000;
        let c = count % 65_536;
        writeln!(
            text,
            "{time},{c},{},{},{},{c},{}",
            c / 2,
            c / 3,
            c / 5,
            c % 200
        )
        .unwrap();
    }
    let file = File::new("wild", &text);
    let five = example("five-wheel");
    let summary = run(
        &five.log(file.0.clone()),
        &five.robot,
        &Options::default(),
        |row| {
            assert!(row.slip.is_none_or(|slip| slip.abs() <= 1.0));
            assert!(row.slip_sigma.is_none_or(f64::is_finite));
            Ok(())
        },
    )
    .unwrap();
    assert!(summary.rejected.total() > 0);
    // the year between its parts is said
    let jump = |doubt: &Doubt| matches!(doubt, Doubt::ClockJump(gap_s) if *gap_s > 3e7);
    assert!(summary.doubts().iter().any(jump), "{:?}", summary.doubts());
}

#[test]
fn what_does_not_fit_is_named() {
    let five = || example("five-wheel");
    let default = Options::default();
    let pose = Options {
        reference: Some(Reference::Pose),
        ..default
    };
    assert!(matches!(
        fails(&five(), &pose),
        Error::NoReference {
            reference: "pose",
            ..
        }
    ));
    let angle = Options {
        wheel_sensor: Some(WheelSensor::Angle),
        ..default
    };
    assert!(matches!(
        fails(&five(), &angle),
        Error::WheelNotMeasured {
            sensor: "angle",
            ..
        }
    ));
    // A robot without the wheels of the map.
    let mut other = five();
    let mut wheels = other.robot.robot.wheels().to_vec();
    wheels[0].name = "front_lift".into();
    other.robot.robot = Robot::new("other".into(), wheels).unwrap();
    let error = fails(&other, &default);
    assert!(
        matches!(&error, Error::UnknownWheel { meant: Some(meant), .. } if meant == "front_lift")
    );
    // Counts without ticks per turn.
    let mut other = five();
    let mut wheels = other.robot.robot.wheels().to_vec();
    wheels[3].encoder.ticks_per_turn = None;
    other.robot.robot = Robot::new("other".into(), wheels).unwrap();
    assert!(matches!(fails(&other, &default), Error::NoTicks { .. }));
    // All wheels powered: the robot file names a free wheel that the log lacks.
    let mut other = five();
    let mut wheels = other.robot.robot.wheels().to_vec();
    wheels[4].role = WheelRole::Powered;
    other.robot.robot = Robot::new("other".into(), wheels).unwrap();
    assert!(matches!(
        fails(&other, &default),
        Error::NoReference {
            reference: "free-wheel",
            ..
        }
    ));
}

#[test]
fn an_error_in_the_middle_of_the_log_is_an_error_of_the_whole() {
    let whole = fs::read_to_string(shipped::root().join("examples/five-wheel/log.csv")).unwrap();
    let file = File::new("broken", &whole.replacen("\n39000,", "\n39000,x", 1));
    let five = example("five-wheel");
    let mut rows = 0;
    let ended = run(
        &five.log(file.0.clone()),
        &five.robot,
        &Options::default(),
        |_| {
            rows += 1;
            Ok(())
        },
    );
    assert!(rows > 100);
    assert!(matches!(ended, Err(Error::Log(_))));
}

#[test]
fn whoever_takes_the_rows_may_refuse_them() {
    let five = example("five-wheel");
    let log = five.log(shipped::root().join("examples/five-wheel/log.csv"));
    let ended = run(&log, &five.robot, &Options::default(), |_| {
        Err(std::io::Error::other("disk full"))
    });
    assert!(matches!(ended, Err(Error::Sink(_))));
}
