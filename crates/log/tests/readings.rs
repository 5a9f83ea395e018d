//! Every meaning of a column as the reading that it becomes, and back from the messages that are written of it.

use std::fmt::Write as _;
use std::io::{self, Cursor, Read, Seek, SeekFrom};

use grouser_files::columns::{self, Meaning};
use grouser_files::topics::Topics;
use grouser_files::{Document, robot};
use grouser_log::Log;
use grouser_log::write::SampleWriter;
use grouser_slip::{Measurement as M, Sample};

fn map(columns: &str) -> columns::ColumnMap {
    let text = format!(
        "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n{columns}\n]\n"
    );
    columns::parse(&Document::from_text("map.toml", text).unwrap()).unwrap()
}

fn readings(log: &Log) -> Vec<M> {
    let samples = log.samples(&[]).unwrap();
    samples.map(|sample| sample.unwrap().measurement).collect()
}

/// The readings of one row whose fields are 1, 2, 3 and so on; a wheel's name stands behind its meaning.
fn of(meanings: &[(&str, &str)]) -> Vec<M> {
    let (mut names, mut row, mut columns) = (String::from("t"), String::from("0"), String::new());
    for (number, (meaning, unit)) in (1..).zip(meanings) {
        let (meaning, wheel) = meaning
            .split_once('@')
            .map_or((*meaning, None), |(meaning, wheel)| (meaning, Some(wheel)));
        let wheel_key = wheel.map_or_else(String::new, |wheel| format!("wheel = \"{wheel}\", "));
        writeln!(
            columns,
            "{{ column = \"c{number}\", meaning = \"{meaning}\", {wheel_key}unit = \"{unit}\" }},"
        )
        .unwrap();
        write!(names, ",c{number}").unwrap();
        write!(row, ",{number}").unwrap();
    }
    let table = Cursor::new(format!("{names}\n{row}\n"));
    let log = Log::over(
        "log.csv".as_ref(),
        table,
        Some(map(&columns)),
        &Topics::default(),
    )
    .unwrap();
    readings(&log)
}

#[test]
#[allow(clippy::too_many_lines, reason = "one entry a meaning")]
fn every_meaning_is_a_reading() {
    let wheels = [
        ("wheel_count@a", "tick"),
        ("wheel_angle@b", "rad"),
        ("wheel_rate@b", "rad/s"),
        ("wheel_torque@a", "N m"),
        ("motor_current@b", "A"),
        ("sinkage@b", "mm"),
        ("entry_angle@a", "rad"),
        ("wheel_steering@b", "rad"),
    ];
    assert_eq!(
        of(&wheels),
        [
            M::WheelCount { wheel: 0, raw: 1 },
            M::WheelAngle {
                wheel: 1,
                angle: 2.0
            },
            M::WheelRate {
                wheel: 1,
                rate: 3.0
            },
            M::WheelTorque {
                wheel: 0,
                torque: 4.0
            },
            M::WheelTorque {
                wheel: 1,
                torque: 5.0
            },
            M::Sinkage {
                wheel: 1,
                depth: 0.006
            },
            M::EntryAngle {
                wheel: 0,
                angle: 7.0
            },
            M::SteeringAngle {
                wheel: 1,
                angle: 8.0
            },
        ]
    );
    for (meanings, expected) in [
        (&[("steering_angle", "rad")][..], M::Steering { angle: 1.0 }),
        (&[("yaw_rate", "rad/s")], M::YawRate { rate: 1.0 }),
        (
            &[("acceleration_forward", "m/s2")],
            M::Acceleration {
                forward: 1.0,
                left: 0.0,
            },
        ),
        (
            &[
                ("acceleration_left", "m/s2"),
                ("acceleration_forward", "m/s2"),
            ],
            M::Acceleration {
                forward: 2.0,
                left: 1.0,
            },
        ),
        (
            &[("displacement_forward", "m"), ("displacement_left", "m")],
            M::Displacement {
                forward: 1.0,
                left: 2.0,
                turn: None,
            },
        ),
        (
            &[
                ("displacement_turn", "rad"),
                ("displacement_left", "m"),
                ("displacement_forward", "m"),
            ],
            M::Displacement {
                forward: 3.0,
                left: 2.0,
                turn: Some(1.0),
            },
        ),
        (
            &[("pose_yaw", "rad"), ("pose_x", "m"), ("pose_y", "m")],
            M::Pose {
                x: 2.0,
                y: 3.0,
                yaw: 1.0,
            },
        ),
        (
            &[("speed_forward", "m/s")],
            M::Speed {
                forward: 1.0,
                left: None,
            },
        ),
        (
            &[("speed_left", "m/s"), ("speed_forward", "m/s")],
            M::Speed {
                forward: 2.0,
                left: Some(1.0),
            },
        ),
        (
            &[("command_forward", "m/s")],
            M::Command {
                forward: 1.0,
                left: 0.0,
            },
        ),
        (
            &[("command_left", "m/s"), ("command_forward", "m/s")],
            M::Command {
                forward: 2.0,
                left: 1.0,
            },
        ),
    ] {
        assert_eq!(of(meanings), [expected], "{meanings:?}");
    }
}

#[test]
fn every_reading_is_written_and_read_again() {
    let all = [
        M::WheelCount {
            wheel: 1,
            raw: u64::MAX,
        },
        M::WheelAngle {
            wheel: 0,
            angle: 0.5,
        },
        M::WheelRate {
            wheel: 0,
            rate: 0.25,
        },
        M::WheelTorque {
            wheel: 0,
            torque: 3.0,
        },
        M::Sinkage {
            wheel: 1,
            depth: 0.01,
        },
        M::EntryAngle {
            wheel: 1,
            angle: 0.3,
        },
        M::YawRate { rate: 0.2 },
        M::Displacement {
            forward: 0.1,
            left: 0.2,
            turn: Some(0.3),
        },
        M::Displacement {
            forward: 0.1,
            left: 0.2,
            turn: None,
        },
        M::Pose {
            x: 1.0,
            y: 2.0,
            yaw: 0.0,
        },
        M::Speed {
            forward: 0.4,
            left: Some(-0.1),
        },
        M::Command {
            forward: 0.5,
            left: 0.1,
        },
    ];
    let text = "format = 1\nname = \"cart\"\n[[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
                [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";
    let robot = robot::parse(&Document::from_text("robot.toml", text.to_owned()).unwrap()).unwrap();
    let names = ["left", "right"].map(String::from);
    // a message for each time
    let again = |given: &[(i64, M)]| {
        let mut writer = SampleWriter::new(Vec::new(), &names).unwrap();
        for (time_ns, measurement) in given.iter().copied() {
            writer
                .sample(&Sample {
                    time_ns,
                    measurement,
                })
                .unwrap();
        }
        let (file, messages) = writer.finish().unwrap();
        assert_eq!(i64::try_from(messages).unwrap(), given.last().unwrap().0);
        readings(&Log::over("log.mcap".as_ref(), Cursor::new(file), None, &robot.topics).unwrap())
    };
    for measurement in all {
        assert_eq!(again(&[(1, measurement)]), [measurement]);
    }
    // what stands in one message decides how its topic is used; what comes behind is read
    let (rate, acceleration) = (
        M::YawRate { rate: 0.2 },
        M::Acceleration {
            forward: 0.4,
            left: -0.1,
        },
    );
    let given = [(1, rate), (1, acceleration), (2, acceleration), (3, rate)];
    assert_eq!(again(&given), given.map(|(_, measurement)| measurement));
    let none = M::Speed {
        forward: 0.4,
        left: None,
    };
    assert_eq!(
        again(&[(1, none)]),
        [M::Speed {
            forward: 0.4,
            left: Some(0.0)
        }]
    );
}

/// An input that is interrupted before every second reading.
struct Interrupted(Cursor<&'static [u8]>, bool);

impl Read for Interrupted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.1 = !self.1;
        if self.1 {
            return Err(io::ErrorKind::Interrupted.into());
        }
        self.0.read(buffer)
    }
}

impl Seek for Interrupted {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

#[test]
fn an_input_may_be_interrupted_and_has_its_name() {
    let columns = "{ column = \"g\", meaning = \"yaw_rate\", unit = \"rad/s\" }";
    let over = |text: &'static str| {
        let input = Interrupted(Cursor::new(text.as_bytes()), false);
        Log::over(
            "my log.csv".as_ref(),
            input,
            Some(map(columns)),
            &Topics::default(),
        )
        .unwrap()
    };
    let log = over("t,g\n0,0.5\n");
    assert_eq!(readings(&log), [M::YawRate { rate: 0.5 }]);
    assert!(format!("{log:?}").contains("my log.csv"));
    assert!(log.measures(Meaning::YawRate));
    let error = over("").samples(&[]).err().unwrap().to_string();
    assert_eq!(error, "my log.csv: holds nothing");
}
