//! Messages that are written field by field have the bytes of the same fields, encoded by the type's definition.

use std::io;

use grouser_files::robot;
use grouser_log::Log;
use grouser_log::message::{Definition, Header, MessageError, Value, build, known};
use grouser_replay::messages::{write_odometry, write_transform, write_twist, write_wheel_slip};
use grouser_replay::{Odometry, Options, Row, Sink, Step, run_into};
use grouser_slip::WheelEstimate;

use crate::shipped::root;

/// Compares the messages of every step.
struct Compare {
    names: Vec<String>,
    definitions: [Definition; 4],
    bytes: Vec<u8>,
    odometries: usize,
    /// What the texts of health and motion were.
    seen: std::collections::BTreeSet<String>,
}

fn planar(covariance: [[f64; 3]; 3]) -> Value {
    // x, y and the turn about z; of z and the other turns nothing is known
    let mut full = [0.0; 36];
    for unknown in [14, 21, 28] {
        full[unknown] = 1e6;
    }
    for (row, values) in [0, 6, 30].iter().zip(covariance) {
        for (column, value) in [0, 1, 5].iter().zip(values) {
            full[row + column] = value;
        }
    }
    build::numbers(&full)
}

fn slip_fields(header: Value, names: &[String], wheels: &[WheelEstimate]) -> Value {
    let numbers = |of: fn(&WheelEstimate) -> Option<f64>| {
        let values: Vec<f64> = wheels.iter().map(|w| of(w).unwrap_or(f64::NAN)).collect();
        build::numbers(&values)
    };
    let texts = |of: fn(&WheelEstimate) -> String| {
        let texts: Vec<String> = wheels.iter().map(of).collect();
        build::texts(&texts)
    };
    build::message([
        ("header", header),
        ("name", build::texts(names)),
        ("slip", numbers(|w| w.slip.map(grouser_slip::Slip::value))),
        ("slip_sigma", numbers(|w| w.sigma)),
        (
            "motion",
            texts(|w| w.motion.map_or(String::new(), |m| m.name().to_owned())),
        ),
        ("health", texts(|w| w.health.to_string())),
    ])
}

fn twist_fields(odometry: &Odometry) -> Value {
    let [forward, left, yaw_rate] = odometry.velocity;
    build::message([
        (
            "twist",
            build::twist([forward, left, 0.0], [0.0, 0.0, yaw_rate]),
        ),
        ("covariance", planar(odometry.velocity_covariance)),
    ])
}

fn odometry_fields(time_ns: i64, odometry: &Odometry) -> [Value; 3] {
    let [x, y, yaw] = odometry.pose;
    let header = |frame| build::header(time_ns, frame);
    let child = || Value::Text("base_link".into());
    let pose = build::message([
        ("pose", build::pose(x, y, yaw)),
        ("covariance", planar(odometry.pose_covariance)),
    ]);
    let transform = build::message([
        ("translation", build::vector([x, y, 0.0])),
        ("rotation", build::turn(yaw)),
    ]);
    let transform = build::message([
        ("header", header("odom")),
        ("child_frame_id", child()),
        ("transform", transform),
    ]);
    [
        build::message([
            ("header", header("odom")),
            ("child_frame_id", child()),
            ("pose", pose),
            ("twist", twist_fields(odometry)),
        ]),
        build::message([
            ("header", header("base_link")),
            ("twist", twist_fields(odometry)),
        ]),
        build::message([("transforms", Value::Array(vec![transform]))]),
    ]
}

impl Sink for Compare {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        let motion = row.motion.map_or("none", grouser_slip::Motion::name);
        self.seen.insert(format!("{} {motion}", row.health));
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let time_ns = step.time_ns;
        let header = |frame| Header { time_ns, frame };
        let bytes = &mut self.bytes;
        let [slip, odom, twist, tf] = &self.definitions;
        write_wheel_slip(bytes, header("base_link"), &self.names, step.wheels).unwrap();
        let fields = slip_fields(
            build::header(time_ns, "base_link"),
            &self.names,
            step.wheels,
        );
        assert_eq!(*bytes, slip.encode(&fields).unwrap());
        if let Some(mut odometry) = step.odometry {
            // no field is equal to another
            odometry.velocity[1] = 0.125;
            let entries = odometry.velocity_covariance.iter_mut().flatten();
            for (number, entry) in entries.enumerate() {
                *entry += 0.5 * number as f64;
            }
            let odometry = &odometry;
            let fields = odometry_fields(time_ns, odometry);
            write_odometry(bytes, header("odom"), "base_link", odometry).unwrap();
            assert_eq!(*bytes, odom.encode(&fields[0]).unwrap());
            write_twist(bytes, header("base_link"), odometry).unwrap();
            assert_eq!(*bytes, twist.encode(&fields[1]).unwrap());
            write_transform(bytes, header("odom"), "base_link", odometry).unwrap();
            assert_eq!(*bytes, tf.encode(&fields[2]).unwrap());
            self.odometries += 1;
        }
        Ok(())
    }
}

#[test]
fn bytes_are_those_of_the_definition() {
    let folder = root().join("examples/five-wheel");
    let robot = robot::read(&folder.join("robot.toml")).unwrap();
    let log = Log::find_any(&[folder.join("log.mcap")], None, &robot.topics).unwrap();
    let types = [
        known::WHEEL_SLIP,
        "nav_msgs/Odometry",
        "geometry_msgs/TwistWithCovarianceStamped",
        "tf2_msgs/TFMessage",
    ];
    let wheels = robot.robot.wheels().iter();
    let mut compare = Compare {
        // texts of all lengths: what follows is aligned
        names: wheels.enumerate().map(|(n, _)| "x".repeat(n)).collect(),
        definitions: types
            .map(|name| Definition::parse(name, &known::definition(name).unwrap()).unwrap()),
        bytes: Vec::new(),
        odometries: 0,
        seen: std::collections::BTreeSet::new(),
    };
    run_into(&log, &robot, &Options::default(), &mut compare).unwrap();
    assert!(compare.odometries > 1900, "{}", compare.odometries);
    assert!(compare.seen.len() > 2, "{:?}", compare.seen);
}

#[test]
fn a_time_that_a_stamp_does_not_hold_is_refused() {
    let header = Header {
        time_ns: i64::MAX,
        frame: "base_link",
    };
    let written = write_wheel_slip(&mut Vec::new(), header, &[], &[]);
    assert!(matches!(written, Err(MessageError::Unfit { field, .. }) if field == "sec"));
}
