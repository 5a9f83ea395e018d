//! The output as messages of ROS 2: what `grouser estimate -o OUT.mcap` writes, and a live node publishes.

use grouser_log::message::{CdrWriter, Header, MessageError, Value, build};
use grouser_real::Real;
use grouser_slip::detect::{Change, Event};
use grouser_slip::onboard::{SoilEstimate, SoilInterval};
use grouser_slip::{Health, Slip, WheelEstimate};

pub use crate::markers::{DrawnWheel, RutMarkers, WayMarkers, robot_markers};
use crate::odometry::Odometry;
pub use crate::wheel_points::WheelPoints;

/// What is not estimated has this variance: so little is known of it that it does not count.
const UNKNOWN_VARIANCE: f64 = 1e6;

/// Writes a `grouser_msgs/WheelSlip`.
///
/// # Errors
/// [`MessageError::Unfit`] for a time that a stamp does not hold, as of every message here.
pub fn write_wheel_slip(
    bytes: &mut Vec<u8>,
    header: Header<'_>,
    names: &[String],
    wheels: &[WheelEstimate],
) -> Result<(), MessageError> {
    let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let wheels = wheels.iter();
    let mut out = CdrWriter::new(bytes);
    out.header(header)?;
    out.texts(names.iter())?;
    out.numbers((wheels.clone()).map(|wheel| or_nan(wheel.slip.map(Slip::value))))?;
    out.numbers(wheels.clone().map(|wheel| or_nan(wheel.sigma)))?;
    out.texts(wheels.clone().map(motion))?;
    out.texts(wheels.map(|wheel| wheel.health))
}

fn motion(wheel: &WheelEstimate) -> &'static str {
    wheel.motion.map_or("", grouser_slip::Motion::name)
}

/// `grouser_msgs/Soil`: what is learnt of the soil.
#[must_use]
pub fn soil_message(header: Value, soil: &SoilEstimate) -> Value {
    let interval = |of: SoilInterval| build::numbers(&[of.mean, of.low, of.high]);
    build::message([
        ("header", header),
        ("strength", interval(soil.strength)),
        ("stiffness", interval(soil.stiffness)),
        ("friction_angle", interval(soil.friction_angle)),
        ("readings", Value::UInt(soil.readings.into())),
        ("changes", Value::UInt(soil.changes.into())),
    ])
}

/// Writes a `nav_msgs/Odometry` of the robot's frame `child_frame` in the frame of the header, the doubt of slip in its
/// covariance.
///
/// # Errors
/// As [`write_wheel_slip`].
pub fn write_odometry(
    bytes: &mut Vec<u8>,
    header: Header<'_>,
    child_frame: &str,
    odometry: &Odometry,
) -> Result<(), MessageError> {
    let mut out = CdrWriter::new(bytes);
    out.header(header)?;
    out.text(child_frame)?;
    put_pose(&mut out, odometry);
    out.float64s(covariance(&odometry.pose_covariance));
    put_twist(&mut out, odometry);
    Ok(())
}

/// Writes a `geometry_msgs/TwistWithCovarianceStamped` in the robot's frame, that of the header.
///
/// # Errors
/// As [`write_wheel_slip`].
pub fn write_twist(
    bytes: &mut Vec<u8>,
    header: Header<'_>,
    odometry: &Odometry,
) -> Result<(), MessageError> {
    let mut out = CdrWriter::new(bytes);
    out.header(header)?;
    put_twist(&mut out, odometry);
    Ok(())
}

/// Writes a `tf2_msgs/TFMessage`: the robot's frame `child_frame` in the frame of the header.
///
/// # Errors
/// As [`write_wheel_slip`].
pub fn write_transform(
    bytes: &mut Vec<u8>,
    header: Header<'_>,
    child_frame: &str,
    odometry: &Odometry,
) -> Result<(), MessageError> {
    let mut out = CdrWriter::new(bytes);
    out.length(1)?;
    out.header(header)?;
    out.text(child_frame)?;
    put_pose(&mut out, odometry);
    Ok(())
}

/// Position and orientation on the ground.
fn put_pose(out: &mut CdrWriter<'_>, odometry: &Odometry) {
    let [x, y, yaw] = odometry.pose;
    let (sin, cos) = Real::sin_cos(0.5 * yaw);
    out.float64s([x, y, 0.0]);
    out.float64s([0.0, 0.0, sin, cos]);
}

/// Speeds, yaw rate, and their covariance.
fn put_twist(out: &mut CdrWriter<'_>, odometry: &Odometry) {
    let [forward, left, yaw_rate] = odometry.velocity;
    out.float64s([forward, left, 0.0]);
    out.float64s([0.0, 0.0, yaw_rate]);
    out.float64s(covariance(&odometry.velocity_covariance));
}

/// `grouser_msgs/SlipEvent` of an event that begins or ends; `names` are the wheels.
#[must_use]
pub fn slip_event(header: Value, names: &[String], change: &Change) -> Value {
    let (event, wheel) = match change.event {
        Event::HighSlip { wheel } => ("HighSlip", Some(wheel)),
        Event::Stall { wheel } => ("Stall", Some(wheel)),
        Event::LiftOff { wheel } => ("LiftOff", Some(wheel)),
        Event::DigIn => ("DigIn", None),
        Event::Immobilised => ("Immobilised", None),
    };
    let wheel = wheel.and_then(|wheel| names.get(wheel));
    build::message([
        ("header", header),
        ("event", Value::Text(event.into())),
        ("wheel", Value::Text(wheel.cloned().unwrap_or_default())),
        ("begins", Value::Bool(change.begins)),
        ("since", build::stamp(change.since_ns)),
    ])
}

/// The 6 × 6 covariance of x, y, z and the turns about them, by rows, of one of x, y and yaw.
fn covariance(planar: &[[f64; 3]; 3]) -> [f64; 36] {
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
    full
}

/// `diagnostic_msgs/DiagnosticArray`: a status for each wheel.
#[must_use]
pub fn diagnostics(header: Value, names: &[String], wheels: &[WheelEstimate]) -> Value {
    build::message([
        ("header", header),
        ("status", Value::Array(wheel_statuses(names, wheels))),
    ])
}

/// `diagnostic_msgs/DiagnosticStatus` of each wheel.
#[must_use]
pub fn wheel_statuses(names: &[String], wheels: &[WheelEstimate]) -> Vec<Value> {
    let status = names.iter().zip(wheels).map(|(name, wheel)| {
        let number =
            |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
        let values = [
            ("slip", number(wheel.slip.map(grouser_slip::Slip::value))),
            ("slip_sigma", number(wheel.sigma)),
            ("motion", motion(wheel).to_owned()),
        ];
        diagnostic_status(
            level(wheel.health),
            &format!("grouser: slip of {name}"),
            &wheel.health.to_string(),
            name,
            values,
        )
    });
    status.collect()
}

/// `diagnostic_msgs/DiagnosticStatus`; `level` is OK 0, WARN 1, ERROR 2 or STALE 3.
#[must_use]
pub fn diagnostic_status<'a>(
    level: u64,
    name: &str,
    message: &str,
    hardware_id: &str,
    values: impl IntoIterator<Item = (&'a str, String)>,
) -> Value {
    let value = |(key, value): (&str, String)| {
        build::message([
            ("key", Value::Text(key.into())),
            ("value", Value::Text(value)),
        ])
    };
    build::message([
        ("level", Value::UInt(level)),
        ("name", Value::Text(name.into())),
        ("message", Value::Text(message.into())),
        ("hardware_id", Value::Text(hardware_id.into())),
        (
            "values",
            Value::Array(values.into_iter().map(value).collect()),
        ),
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
