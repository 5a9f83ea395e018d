//! Lengths of a pose's paths beside those of the wheels.

use grouser_doctor::Window;
use grouser_slip::window::WindowBody;
use grouser_slip::{Measurement, Sample};

use crate::carts::{doctor, findings};

/// Straight ahead at ten times the mean speed of the wheels, as a robot with omni wheels may drive.
fn scale(headings_deg: [f64; 3]) -> Option<f64> {
    let mut index = 0.0;
    let wheels = headings_deg.map(|heading| {
        index += 1.0;
        [0.1 * index, 0.0, heading]
    });
    let mut doctor = doctor(&wheels, 0.01);
    for step in 0..400 {
        let now_ns = i64::from(step) * 100_000_000;
        doctor.step(&Window {
            now_ns,
            time_s: 0.1 * f64::from(step),
            body: &WindowBody::default(),
            wheel_speeds: &[Some(0.2); 3],
        });
        let measurement = Measurement::Pose {
            x: 0.2 * f64::from(step),
            y: 0.0,
            yaw: 0.0,
        };
        doctor.take(&Sample {
            time_ns: now_ns,
            measurement,
        });
    }
    findings(&doctor).pose.way_scale
}

#[test]
fn paths_are_compared_with_wheels_that_point_one_way() {
    assert!((scale([0.0; 3]).unwrap() - 10.0).abs() < 1e-6);
    assert_eq!(scale([0.0, 120.0, 240.0]), None);
}
