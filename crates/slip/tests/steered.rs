//! Wheels that are steered: a body with any twist, whose wheels roll along their headings.

use std::f64::consts::TAU;

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{Fault, Measurement, Robot, Sample, Wheel};

use crate::noise::Noise;

const ROW_NS: i64 = 20_000_000;
const ROW_S: f64 = 0.02;
const RADIUS_M: f64 = 0.1;
const TICKS: u32 = 4000;

fn robot() -> Robot {
    let corners = [
        ("fl", 0.3, 0.25),
        ("fr", 0.3, -0.25),
        ("rl", -0.3, 0.25),
        ("rr", -0.3, -0.25),
    ];
    let wheel = |(name, x, y)| {
        let wheel = Wheel::powered(name).at(x, y);
        wheel.radius(RADIUS_M).ticks_per_turn(TICKS)
    };
    let wheels = corners.map(wheel);
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
        let raw = (way / (TAU * RADIUS_M) * f64::from(TICKS)) as u64;
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

#[test]
fn angles_of_no_wheel_and_beyond_a_turn_are_refused() {
    let robot = robot();
    let settings = FilterSettings {
        horizon: 0.0,
        ..FilterSettings::default()
    };
    let mut filter = SlipFilter::new(&robot, settings).unwrap();
    let mut steer = |wheel, angle| {
        filter
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
    assert_eq!(filter.latest().rejected.total(), 4);
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
