//! Robots without a file, and what a doctor finds of them.

use std::fmt::Write as _;

use grouser_doctor::{Doctor, Findings, KnownStep, Uses};
use grouser_files::Document;
use grouser_files::robot::{self, WheelSensor};
use grouser_slip::motion::{CommonMotion, Step, WheelStep, start};
use grouser_slip::{Reference, SensorSettings};

/// A doctor for a cart whose wheels have these places, m, and headings, degrees.
pub(crate) fn doctor(wheels: &[[f64; 3]], low_speed: f64) -> Doctor {
    let mut text = "format = 1\nname = \"cart\"\n".to_owned();
    for (index, [x, y, heading]) in wheels.iter().enumerate() {
        write!(
            text,
            "[[wheel]]\nname = \"wheel {index}\"\nx_m = {x}\ny_m = {y}\nheading_deg = {heading}\nradius_m = 0.1\n\
             drive = \"powered\"\n"
        )
        .unwrap();
    }
    let file = robot::parse(&Document::from_text("cart.toml", text).unwrap()).unwrap();
    let settings = SensorSettings {
        reference: Reference::Pose,
        low_speed,
        position_sigma: 0.01,
        ..file.settings
    };
    Doctor::new(&file, &settings, WheelSensor::Rate)
}

/// What it finds where everything is used.
pub(crate) fn findings(doctor: &mut Doctor) -> Findings {
    doctor.findings(Uses {
        reference: Reference::Pose,
        has_heading: true,
        has_acceleration: true,
    })
}

/// A step of `dt` s, in which wheels that point ahead, each at its arm (m to the left), run at these speeds (m/s) and the gyro
/// measures this yaw rate (rad/s).
pub(crate) fn step(
    doctor: &mut Doctor,
    (end_ns, dt): (i64, f64),
    wheels: &[[f64; 2]],
    yaw_rate: Option<f64>,
) {
    let wheel = |[arm, speed]: &[f64; 2]| WheelStep {
        distance: Some(speed * dt),
        variance: 1e-8,
        row: [1.0, 0.0, -arm],
        across: [0.0, 1.0, 0.0],
        ..WheelStep::default()
    };
    let step = Step {
        time: end_ns as f64 * 1e-9,
        dt,
        wheels: wheels.iter().map(wheel).collect(),
        turn: yaw_rate.map(|rate| rate * dt),
        ..Step::default()
    };
    let known = KnownStep {
        step: &step,
        belief: &start([0.0; 2], 0.0, true),
        common: &CommonMotion::default(),
    };
    doctor.step((end_ns, step.time), &known, 0);
}
