//! Wheels that are steered, by means over a window and by the filter: a body with any twist, whose wheels roll along their
//! headings.

use std::f64::consts::TAU;

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::window::{WindowEstimator, WindowMeans, WindowSettings};
use grouser_slip::{Fault, Measurement, Reference, Robot, Sample, Wheel, WheelRole};

use crate::cart::{TICKS, encoder, wheel};
use crate::noise::Noise;

const ROW_NS: i64 = 20_000_000;
const ROW_S: f64 = 0.02;
const RADIUS_M: f64 = 0.1;

fn robot() -> Robot {
    let corners = [
        ("fl", 0.3, 0.25),
        ("fr", 0.3, -0.25),
        ("rl", -0.3, 0.25),
        ("rr", -0.3, -0.25),
    ];
    let wheels = corners
        .map(|(name, x, y)| wheel(name, (x, y), WheelRole::Powered, 32).encoder(encoder(32)));
    Robot::new("swerve".into(), wheels.to_vec()).unwrap()
}

/// Speed (m/s) and heading (rad) of the wheel at (x, y) of a body with a twist: forwards, to the left, turning.
fn motion_at([forward, left, turn]: [f64; 3], (x, y): (f64, f64)) -> (f64, f64) {
    let (ahead, aside) = (forward - turn * y, left + turn * x);
    (ahead.hypot(aside), aside.atan2(ahead))
}

/// The samples of one row; a wheel that is steered beyond a quarter turn is not turned round.
fn row(robot: &Robot, twist: [f64; 3], slip: f64, row: i64) -> Vec<Sample> {
    let time_ns = row * ROW_NS;
    let mut measurements = Vec::new();
    for (index, wheel) in robot.wheels().iter().enumerate() {
        let (speed, angle) = motion_at(twist, (wheel.x, wheel.y));
        measurements.push(Measurement::SteeringAngle {
            wheel: index,
            angle,
        });
        let way = speed / (1.0 - slip) * ROW_S * row as f64;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few thousand ticks"
        )]
        let raw = (way / (TAU * RADIUS_M) * TICKS) as u64;
        measurements.push(Measurement::WheelCount { wheel: index, raw });
    }
    let [forward, left, turn] = twist;
    measurements.push(Measurement::Displacement {
        forward: ROW_S * forward,
        left: ROW_S * left,
        turn: Some(ROW_S * turn),
    });
    let stamped = measurements.into_iter().map(|measurement| Sample {
        time_ns,
        measurement,
    });
    stamped.collect()
}

fn settings() -> WindowSettings {
    WindowSettings {
        reference: Reference::Displacement,
        max_speed: 5.0,
        ..WindowSettings::default()
    }
}

#[test]
fn each_steered_wheel_has_its_slip_along_its_heading() {
    let robot = robot();
    let mut noise = Noise::new(1);
    for case in 0..40 {
        let mut between = |low: f64, high: f64| low + (high - low) * noise.uniform();
        // crab-wise, on an arc, and all about
        let (speed, aside) = (between(0.2, 0.5), between(-3.1, 3.1));
        let turn = [0.0, between(-0.4, 0.4)][case % 2];
        let twist = [speed * aside.cos(), speed * aside.sin(), turn];
        let slip = between(0.0, 0.6);
        let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
        let mut means = WindowMeans::new(&robot, settings()).unwrap();
        assert_eq!((means.latest(), *means.settings()), (None, settings()));
        for index in 0..60 {
            for sample in row(&robot, twist, slip, index) {
                estimator.update(sample).unwrap();
                means.update(sample).unwrap();
            }
        }
        let found = estimator.latest().unwrap();
        for (index, wheel) in robot.wheels().iter().enumerate() {
            let (speed, _) = motion_at(twist, (wheel.x, wheel.y));
            let estimate = &found.wheels[index];
            let forward = estimate.forward_speed.unwrap().value;
            assert!((forward - speed).abs() < 2e-3, "{case}: {forward} {speed}");
            let rim = means.rim_speed(index).unwrap().value;
            assert!((rim - speed / (1.0 - slip)).abs() < 3e-3, "{case}: {rim}");
            // slower wheels slip no number
            if speed > 0.1 {
                let found = estimate.slip.unwrap().value();
                assert!(
                    (found - slip).abs() < 0.02,
                    "{case} {index}: {found} {slip}"
                );
            }
        }
        assert_eq!(means.rim_speed(4), None);
        let along = means.latest().unwrap().along.unwrap().value();
        assert!((along - slip).abs() < 0.02, "{case}: {along} {slip}");
    }
}

/// Rims of steered wheels that slip unlike are no motion across them: the wheels' motion goes where they point.
#[test]
fn unequal_slips_of_steered_wheels_turn_no_direction() {
    let robot = robot();
    for (slips, turn) in [
        ([0.03, 0.03, 0.25, 0.25], 0.3),
        ([0.4, 0.05, 0.05, 0.05], 0.3),
        ([0.3, 0.1, 0.3, 0.1], -0.25),
    ] {
        let twist = [0.5, 0.0, turn];
        let mut means = WindowMeans::new(&robot, settings()).unwrap();
        for index in 0..60 {
            let mut samples = row(&robot, twist, 0.0, index);
            for sample in &mut samples {
                if let Measurement::WheelCount { wheel, raw } = &mut sample.measurement {
                    #[allow(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        clippy::cast_precision_loss,
                        reason = "a few thousand ticks"
                    )]
                    let slipping = (*raw as f64 / (1.0 - slips[*wheel])) as u64;
                    *raw = slipping;
                }
                means.update(*sample).unwrap();
            }
        }
        let [forward, left, _] = means.latest().unwrap().wheels_motion.unwrap().velocity;
        let rims: f64 = (0..4)
            .map(|wheel| means.rim_speed(wheel).unwrap().value)
            .sum();
        assert!(
            left.abs() < 0.02 && (forward / (0.25 * rims) - 1.0).abs() < 0.05,
            "{slips:?}: {forward} {left}, rims {}",
            0.25 * rims
        );
    }
}

#[test]
fn angles_of_no_wheel_and_beyond_a_turn_are_refused() {
    let robot = robot();
    let mut means = WindowMeans::new(&robot, settings()).unwrap();
    let mut steer = |wheel, angle| {
        means
            .update(Sample {
                time_ns: 0,
                measurement: Measurement::SteeringAngle { wheel, angle },
            })
            .map(|_| ())
    };
    assert_eq!(
        steer(4, 0.1),
        Err(Fault::UnknownWheel {
            index: 4,
            wheels: 4
        })
    );
    for angle in [7.1, -7.1, f64::NAN] {
        assert!(steer(0, angle).is_err(), "{angle}");
    }
    assert_eq!(steer(0, -7.0), Ok(()));
    assert_eq!(means.rejected().total(), 4);
}

#[test]
fn the_filter_finds_the_slip_of_wheels_that_point_many_ways() {
    let robot = robot();
    let mut noise = Noise::new(2);
    let mut worst = 0.0_f64;
    for case in 0..20 {
        let mut between = |low: f64, high: f64| low + (high - low) * noise.uniform();
        let (speed, aside) = (between(0.25, 0.5), between(-3.1, 3.1));
        let twist = [speed * aside.cos(), speed * aside.sin(), between(-0.3, 0.3)];
        let slip = between(0.0, 0.5);
        let mut filter = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
        for index in 0..500 {
            let gyro = Sample {
                time_ns: index * ROW_NS,
                measurement: Measurement::YawRate { rate: twist[2] },
            };
            for sample in row(&robot, twist, slip, index).into_iter().chain([gyro]) {
                filter.update(sample).unwrap();
            }
        }
        for (index, wheel) in filter.latest().wheels.iter().enumerate() {
            let off = wheel.slip.unwrap().value() - slip;
            worst = worst.max(off.abs());
            assert!(off.abs() < 0.03, "{case} {index}: {off} off {slip}");
        }
    }
    println!("slips of wheels that point many ways: {worst:.3} off at most");
}

/// A tricycle: its one wheel is driven and steered, ahead of the origin, and tells a turn from a sideways motion by the gyro alone.
#[test]
fn one_steered_wheel_counts_the_whole_distance() {
    const AHEAD_M: f64 = 0.8;
    let wheel = Wheel::powered("front").at(AHEAD_M, 0.0).radius(0.1);
    let robot = Robot::new("tricycle".into(), vec![wheel]).unwrap();
    let settings = WindowSettings {
        reference: Reference::Speed,
        ..WindowSettings::default()
    };
    let mut means = WindowMeans::new(&robot, settings).unwrap();
    let (speed, dt) = (0.5, 0.05);
    let mut driven = 0.0;
    for step in 0..800 {
        let time = dt * f64::from(step);
        let angle = 0.2 * (0.5 * time).sin();
        let rate = speed / angle.cos() / 0.1;
        let measurements = [
            Measurement::SteeringAngle { wheel: 0, angle },
            Measurement::WheelRate { wheel: 0, rate },
            Measurement::YawRate {
                rate: speed * angle.tan() / AHEAD_M,
            },
            Measurement::Speed {
                forward: speed,
                left: Some(0.0),
            },
        ];
        for measurement in measurements {
            let time_ns = i64::from(step) * 50_000_000;
            means
                .update(Sample {
                    time_ns,
                    measurement,
                })
                .unwrap();
        }
        driven += speed * dt;
    }
    let body = means.latest().unwrap();
    println!(
        "{} {} of {driven}",
        body.travel_wheels, body.travel_reference
    );
    assert!((body.travel_wheels / driven - 1.0).abs() < 0.02);
    assert!((body.travel_reference / driven - 1.0).abs() < 0.02);
}
