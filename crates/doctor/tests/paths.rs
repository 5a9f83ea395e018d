//! Distances by the reference beside those of the wheels.

use grouser_doctor::{Mistake, PoseFault};
use grouser_slip::{Measurement, Sample};

use crate::carts::{doctor, findings, step};

/// Straight ahead at a multiple of the wheels' speed, as a robot with omni wheels may drive; the median of the multiples.
fn scale(headings_deg: [f64; 3], multiple: f64, noise_m: f64) -> (Option<f64>, Vec<Mistake>) {
    let mut index = 0.0;
    let wheels = headings_deg.map(|heading| {
        index += 1.0;
        [0.1 * index, 0.0, heading]
    });
    let mut doctor = doctor(&wheels, 0.01);
    for step in 0..400 {
        let mut take = |measurement| {
            doctor.take(&Sample {
                time_ns: i64::from(step) * 100_000_000,
                measurement,
            });
        };
        for wheel in 0..3 {
            take(Measurement::WheelRate { wheel, rate: 2.0 });
        }
        let noise = noise_m * (7.0 * f64::from(step)).sin();
        take(Measurement::Pose {
            x: multiple * 0.02 * f64::from(step) + noise,
            y: 0.0,
            yaw: 0.0,
        });
    }
    let found = findings(&mut doctor);
    (found.distance.map(|of| of.scales[1]), found.mistakes)
}

#[test]
fn distances_are_compared_with_wheels_that_point_one_way() {
    let (found, mistakes) = scale([0.0; 3], 10.0, 0.001);
    assert!((found.unwrap() - 10.0).abs() < 1e-2, "{found:?}");
    assert!(
        matches!(mistakes[..], [Mistake::Pose(PoseFault::Unit(_))]),
        "{mistakes:?}"
    );
    assert_eq!(scale([0.0, 120.0, 240.0], 10.0, 0.001), (None, Vec::new()));
}

/// A multiple that is the same to the last digit is no measurement of the ground.
#[test]
fn a_reference_without_noise_is_derived_from_the_wheels() {
    for (noise_m, is_derived) in [(0.0, true), (0.001, false)] {
        let (_, mistakes) = scale([0.0; 3], 0.98, noise_m);
        assert_eq!(
            mistakes.contains(&Mistake::Derived),
            is_derived,
            "{mistakes:?}"
        );
    }
}

/// A robot drives straight ahead on each of these headings (degrees) in turn, while its pose moves 10° to the left of its yaw.
fn offset_deg(headings_deg: &[f64]) -> Option<f64> {
    let mut doctor = doctor(&[[0.0, 0.25, 0.0], [0.0, -0.25, 0.0]], 0.01);
    let (mut place, mut index) = ([0.0, 0.0], 0);
    for heading in headings_deg
        .iter()
        .map(|heading: &f64| heading.to_radians())
    {
        for _ in 0..200 {
            let now_ns = i64::from(index) * 100_000_000;
            let wheels = [[0.25, 0.3], [-0.25, 0.3]];
            step(&mut doctor, (now_ns, 0.1), &wheels, None);
            let (sin, cos) = (heading + 10.0_f64.to_radians()).sin_cos();
            place = [place[0] + 0.03 * cos, place[1] + 0.03 * sin];
            index += 1;
            let [x, y] = place;
            let measurement = Measurement::Pose { x, y, yaw: heading };
            doctor.take(&Sample {
                time_ns: now_ns,
                measurement,
            });
        }
    }
    findings(&mut doctor)
        .mistakes
        .iter()
        .find_map(|of| match of {
            Mistake::ReferenceTurned([angle, _]) => Some(angle.to_degrees()),
            _ => None,
        })
}

/// On one heading a drift on a side slope looks the same: the angle is within five of its standard deviations.
#[test]
fn an_offset_of_the_yaw_is_reported_beyond_its_standard_deviation() {
    let found = offset_deg(&[0.0, 90.0, 180.0, -90.0]).unwrap();
    assert!((found - 10.0).abs() < 1.0, "{found}");
    assert_eq!(offset_deg(&[0.0; 4]), None);
}
