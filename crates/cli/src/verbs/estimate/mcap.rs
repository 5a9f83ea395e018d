//! `estimate -o OUT.mcap`: slip, odometry and diagnostics as messages of ROS 2.
//!
//! | topic | type | when |
//! |---|---|---|
//! | `/grouser/slip` | `grouser_msgs/WheelSlip` | whenever a wheel was read |
//! | `/grouser/odom` | `nav_msgs/Odometry`, the slip in its covariance | likewise |
//! | `/diagnostics` | `diagnostic_msgs/DiagnosticArray` | every second |

use std::io;
use std::path::Path;

use grouser_log::message::{Value, build, known};
use grouser_log::write::{McapWriter, Topic};
use grouser_replay::{Odometry, Step};
use grouser_slip::{Health, Wheel, WheelEstimate};

use crate::error::{Error, Result, shown};
use crate::output::OutputFile;

/// Between two messages of diagnostics, ns.
const DIAGNOSTICS_NS: i64 = 1_000_000_000;
/// What is not estimated has this variance: so little is known of it that it does not count.
const UNKNOWN_VARIANCE: f64 = 1e6;

/// The file in the making.
pub(super) struct Recording {
    writer: McapWriter<OutputFile>,
    slip: Topic,
    odometry: Topic,
    diagnostics: Topic,
    names: Vec<String>,
    told_ns: Option<i64>,
    path: std::path::PathBuf,
}

impl Recording {
    /// Begins the file.
    pub(super) fn begin(path: &Path, wheels: &[Wheel]) -> Result<Self> {
        let refused = |error: io::Error| Error::file("write", path, &error);
        let output = OutputFile::create(path)?;
        let mut writer = McapWriter::new(output, "ros2").map_err(refused)?;
        let mut topic = |name, type_name| writer.topic(name, type_name).map_err(refused);
        Ok(Self {
            slip: topic("/grouser/slip", known::WHEEL_SLIP)?,
            odometry: topic("/grouser/odom", "nav_msgs/Odometry")?,
            diagnostics: topic("/diagnostics", "diagnostic_msgs/DiagnosticArray")?,
            writer,
            names: wheels.iter().map(|wheel| wheel.name.clone()).collect(),
            told_ns: None,
            path: path.to_owned(),
        })
    }

    /// What is known after the records of one time.
    pub(super) fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let time_ns = step.time_ns;
        let wheels = step.wheels;
        let header = |frame| build::header(time_ns, frame);
        let slip = wheel_slip(header("base_link"), &self.names, wheels);
        self.writer.send(&mut self.slip, time_ns, &slip)?;
        if let Some(odometry) = step.odometry {
            let message = odometry_message(header("odom"), &odometry);
            self.writer.send(&mut self.odometry, time_ns, &message)?;
        }
        let due = |told: i64| time_ns.saturating_sub(told) >= DIAGNOSTICS_NS;
        if self.told_ns.is_none_or(due) {
            self.told_ns = Some(time_ns);
            let message = diagnostics(header(""), &self.names, wheels);
            self.writer.send(&mut self.diagnostics, time_ns, &message)?;
        }
        Ok(())
    }

    /// Where it will stand.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the complete file in its place; gives a line that says so.
    pub(super) fn finish(self) -> Result<String> {
        let output = self.writer.finish();
        let output = output.map_err(|error| Error::file("write", &self.path, &error))?;
        output.finish()?;
        Ok(format!("wrote {}\n", shown(&self.path)))
    }
}

fn wheel_slip(header: Value, names: &[String], wheels: &[WheelEstimate]) -> Value {
    let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let slips: Vec<f64> = wheels
        .iter()
        .map(|wheel| or_nan(wheel.slip.map(grouser_slip::Slip::value)))
        .collect();
    let sigmas: Vec<f64> = wheels.iter().map(|wheel| or_nan(wheel.sigma)).collect();
    let motions: Vec<&str> = wheels.iter().map(motion).collect();
    let healths: Vec<String> = wheels
        .iter()
        .map(|wheel| wheel.health.to_string())
        .collect();
    build::message([
        ("header", header),
        ("name", build::texts(names)),
        ("slip", build::numbers(&slips)),
        ("slip_sigma", build::numbers(&sigmas)),
        ("motion", build::texts(&motions)),
        ("health", build::texts(&healths)),
    ])
}

fn motion(wheel: &WheelEstimate) -> &'static str {
    wheel.motion.map_or("", grouser_slip::Motion::name)
}

fn odometry_message(header: Value, odometry: &Odometry) -> Value {
    let [x, y, yaw] = odometry.pose;
    let [forward, left, turn] = odometry.velocity;
    let pose = build::message([
        ("pose", build::pose(x, y, yaw)),
        ("covariance", covariance(&odometry.pose_covariance)),
    ]);
    let linear = [forward, left, 0.0];
    let twist = build::message([
        ("twist", build::twist(linear, [0.0, 0.0, turn])),
        ("covariance", covariance(&odometry.velocity_covariance)),
    ]);
    build::message([
        ("header", header),
        ("child_frame_id", Value::Text("base_link".into())),
        ("pose", pose),
        ("twist", twist),
    ])
}

/// The 6 × 6 covariance of x, y, z and the turns about them, by rows, of one of x, y and yaw.
fn covariance(planar: &[[f64; 3]; 3]) -> Value {
    let mut full = [0.0; 36];
    for unknown in [2, 3, 4] {
        full[7 * unknown] = UNKNOWN_VARIANCE;
    }
    let places = [0, 1, 5];
    for (row, line) in places.iter().zip(planar) {
        for (column, value) in places.iter().zip(line) {
            full[6 * row + column] = *value;
        }
    }
    build::numbers(&full)
}

fn diagnostics(header: Value, names: &[String], wheels: &[WheelEstimate]) -> Value {
    let status = names.iter().zip(wheels).map(|(name, wheel)| {
        let number =
            |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
        let values = [
            ("slip", number(wheel.slip.map(grouser_slip::Slip::value))),
            ("slip_sigma", number(wheel.sigma)),
            ("motion", motion(wheel).to_owned()),
        ];
        let value = |(key, value): (&str, String)| {
            build::message([
                ("key", Value::Text(key.into())),
                ("value", Value::Text(value)),
            ])
        };
        build::message([
            ("level", Value::UInt(level(wheel.health))),
            ("name", Value::Text(format!("grouser: slip of {name}"))),
            ("message", Value::Text(wheel.health.to_string())),
            ("hardware_id", Value::Text(name.clone())),
            (
                "values",
                Value::Array(values.into_iter().map(value).collect()),
            ),
        ])
    });
    build::message([
        ("header", header),
        ("status", Value::Array(status.collect())),
    ])
}

/// OK, WARN, ERROR or STALE of `diagnostic_msgs/DiagnosticStatus`.
const fn level(health: Health) -> u64 {
    match health {
        Health::Ok => 0,
        Health::Degraded(_) => 1,
        Health::Uninitialised => 3,
        _ => 2,
    }
}
