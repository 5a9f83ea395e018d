//! Robots without a file, and what a doctor finds of them.

use std::fmt::Write as _;

use grouser_doctor::{Doctor, Findings, Uses};
use grouser_files::Document;
use grouser_files::robot::{self, WheelSensor};
use grouser_slip::Reference;
use grouser_slip::window::WindowSettings;

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
    let settings = WindowSettings {
        reference: Reference::Pose,
        window: 0.5,
        low_speed,
        position_sigma: 0.01,
        ..file.settings
    };
    Doctor::new(&file, &settings, WheelSensor::Rate)
}

/// What it finds where everything is used.
pub(crate) fn findings(doctor: &Doctor) -> Findings {
    doctor.findings(Uses {
        reference: Reference::Pose,
        has_heading: true,
        has_acceleration: true,
    })
}
