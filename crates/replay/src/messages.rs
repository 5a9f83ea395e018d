//! The output as messages of ROS 2: what `grouser estimate -o OUT.mcap` writes, and a live node publishes.

use grouser_log::message::{Value, build};
use grouser_slip::detect::{Change, Event};
use grouser_slip::onboard::{SoilEstimate, SoilInterval};
use grouser_slip::{Health, WheelEstimate};

pub use crate::markers::{DrawnWheel, RutMarkers, WayMarkers, robot_markers};
use crate::odometry::Odometry;
pub use crate::wheel_points::WheelPoints;

/// What is not estimated has this variance: so little is known of it that it does not count.
const UNKNOWN_VARIANCE: f64 = 1e6;

/// `grouser_msgs/WheelSlip`.
#[must_use]
pub fn wheel_slip(header: Value, names: &[String], wheels: &[WheelEstimate]) -> Value {
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

/// `nav_msgs/Odometry` of the robot's frame `child_frame` in the frame of the header, the doubt of slip in its covariance.
#[must_use]
pub fn odometry_message(header: Value, child_frame: &str, odometry: &Odometry) -> Value {
    let [x, y, yaw] = odometry.pose;
    let pose = build::message([
        ("pose", build::pose(x, y, yaw)),
        ("covariance", covariance(&odometry.pose_covariance)),
    ]);
    build::message([
        ("header", header),
        ("child_frame_id", Value::Text(child_frame.into())),
        ("pose", pose),
        ("twist", twist_with_covariance(odometry)),
    ])
}

/// `geometry_msgs/TwistWithCovarianceStamped` in the robot's frame, that of the header.
#[must_use]
pub fn twist_message(header: Value, odometry: &Odometry) -> Value {
    build::message([
        ("header", header),
        ("twist", twist_with_covariance(odometry)),
    ])
}

fn twist_with_covariance(odometry: &Odometry) -> Value {
    let [forward, left, turn] = odometry.velocity;
    let linear = [forward, left, 0.0];
    build::message([
        ("twist", build::twist(linear, [0.0, 0.0, turn])),
        ("covariance", covariance(&odometry.velocity_covariance)),
    ])
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
