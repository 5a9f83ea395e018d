//! Directions of accelerometer and reference.

use grouser_doctor::AxisCheck;
use grouser_slip::{Measurement, Sample};

use crate::carts::{doctor, findings, step};

/// A cart that speeds up and brakes in turn, on a slope, with sensors turned by `turned` rad.
fn check(turned: f64) -> AxisCheck {
    let mut doctor = doctor(&[[0.0, 0.2, 0.0], [0.0, -0.2, 0.0]], 0.01);
    let (sin, cos) = turned.sin_cos();
    let (mut speed, mut x) = (0.0, 0.0);
    for index in 0..2000 {
        let force = if (index / 200) % 2 == 0 { 0.2 } else { -0.2 };
        speed += 0.02 * force;
        x += 0.02 * speed;
        let now_ns = i64::from(index) * 20_000_000;
        let along = force + 0.3;
        for measurement in [
            Measurement::Acceleration {
                forward: cos * along,
                left: sin * along,
            },
            Measurement::Pose {
                x,
                y: 0.0,
                yaw: -turned,
            },
        ] {
            doctor.take(&Sample {
                time_ns: now_ns,
                measurement,
            });
        }
        let rims = speed / 0.8;
        let wheels = [[0.2, rims], [-0.2, rims]];
        step(&mut doctor, (now_ns, 0.02), &wheels, None);
    }
    findings(&mut doctor).axes
}

#[test]
fn the_angle_of_turned_sensors_is_found_and_right_ones_are_not_reported() {
    assert_eq!(check(0.0), AxisCheck::default());
    assert_eq!(check(0.3), AxisCheck::default());
    for turned in [1.0, -1.6, 3.1] {
        let found = check(turned);
        let [acceleration, reference] = [found.acceleration, found.reference].map(Option::unwrap);
        assert!((acceleration - turned).abs() < 0.01, "{found:?}");
        assert!((reference - turned).abs() < 0.01, "{found:?}");
    }
}
