//! Prints what a table of two wheels, a gyro and a pose has wrong: `cargo run -p grouser-doctor --example mistakes`.
//!
//! Here the table is computed: a cart drives bends to both sides, and its left and right encoders are exchanged.

use std::io::Write as _;

use grouser_doctor::{Doctor, KnownStep, Uses};
use grouser_files::Document;
use grouser_files::robot::{self, WheelSensor};
use grouser_slip::filter::SlipFilter;
use grouser_slip::{Measurement, Reference, Sample, SensorSettings};

const CART: &str = r#"
format = 1
name = "cart"
[[wheel]]
name = "left"
x_m = 0.0
y_m = 0.2
radius_m = 0.1
drive = "powered"
[[wheel]]
name = "right"
x_m = 0.0
y_m = -0.2
radius_m = 0.1
drive = "powered"
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = robot::parse(&Document::from_text("cart.toml", CART.into())?)?;
    let settings = SensorSettings {
        reference: Reference::Pose,
        ..file.settings
    };
    let mut filter = SlipFilter::new(&file.robot, file.filter)?;
    let mut doctor = Doctor::new(&file, &settings, WheelSensor::Rate);
    let (mut x, mut y, mut yaw) = (0.0, 0.0, 0.0_f64);
    for step in 0..1200_i32 {
        let (now_ns, time_s) = (50_000_000 * i64::from(step), 0.05 * f64::from(step));
        let turn = 0.3 * (0.2 * time_s).sin();
        x += 0.05 * 0.3 * yaw.cos();
        y += 0.05 * 0.3 * yaw.sin();
        yaw += 0.05 * turn;
        let wheel_rate = |wheel, y: f64| Measurement::WheelRate {
            wheel,
            rate: (0.3 - y * turn) / 0.1,
        };
        for measurement in [
            wheel_rate(1, 0.2),
            wheel_rate(0, -0.2),
            Measurement::YawRate { rate: turn },
            Measurement::Pose { x, y, yaw },
        ] {
            let sample = Sample {
                time_ns: now_ns,
                measurement,
            };
            doctor.take(&sample);
            let _refused = filter.update_recorded(sample, &mut |end_ns, step, filter| {
                let known = KnownStep::online(step, filter);
                doctor.step((end_ns, 1e-9 * end_ns as f64), &known, 0);
            });
        }
    }
    let found = doctor.findings(Uses {
        reference: Reference::Pose,
        has_heading: true,
        has_acceleration: false,
    });
    let mut out = std::io::stdout().lock();
    for mistake in found.mistakes {
        writeln!(out, "{mistake}")?;
    }
    Ok(())
}
