//! The estimator over modes on a robot whose slips are known, and on samples that no sensor makes.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test fails by panicking and may say what it measured; counts are small"
)]

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{Measurement, Robot, Sample, Wheel};
use proptest::prelude::*;

use crate::wild;
use crate::world;
use crate::world::{Truth, World};

/// Root mean square error of the powered wheels' slips from 2 s on, and the mean squared error over variance.
fn errors(world: &World) -> [f64; 2] {
    let mut estimator = SlipFilter::new(&world.robot(), FilterSettings::default()).unwrap();
    let mut truths: Vec<Truth> = Vec::new();
    let (mut squares, mut scaled, mut count) = (0.0, 0.0, 0.0);
    world.run(|truth, samples| {
        truths.push(truth.clone());
        for sample in samples {
            let _ = estimator.update(*sample);
        }
        let known = estimator.latest();
        let row = (known.time_ns / world::STEP_NS) as usize;
        let then = &truths[row.min(truths.len() - 1)];
        for (estimate, truth) in known.wheels.iter().zip(&then.slips).take(world.powered) {
            let (Some(slip), Some(sigma), Some(truth)) = (estimate.slip, estimate.sigma, truth)
            else {
                continue;
            };
            if then.time >= 2.0 && then.speed > 0.05 {
                let error = slip.value() - truth;
                squares += error * error;
                scaled += (error / sigma).powi(2);
                count += 1.0;
            }
        }
    });
    assert!(count > 1000.0, "{count} estimates");
    [(squares / count).sqrt(), scaled / count]
}

#[test]
fn slips_of_a_five_wheeled_robot_are_found_by_modes() {
    for (camera, accelerometer) in [(0, false), (0, true), (25, false), (25, true)] {
        let world = World {
            accelerometer,
            camera,
            ..World::default()
        };
        let [rms, scaled] = errors(&world);
        println!("camera {camera} Hz, accelerometer {accelerometer}: {rms:.4}, {scaled:.2}");
        assert!(
            rms < 0.025 && scaled < 2.0,
            "{camera} {accelerometer}: {rms} {scaled}"
        );
    }
}

/// A robot that is stuck: its wheels spin, and the free one stands.
#[test]
fn full_slip_is_within_its_sigmas() {
    let wheels = vec![
        Wheel::powered("left").at(0.1, 0.2).radius(0.1),
        Wheel::powered("right").at(0.1, -0.2).radius(0.1),
        Wheel::free("fifth").at(-0.3, 0.0).radius(0.1),
    ];
    let robot = Robot::new("cart".into(), wheels).unwrap();
    let mut estimator = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
    for step in 0..2000_i64 {
        let time_s = 0.01 * step as f64;
        let (turned, spun) = (4.0 * time_s.min(5.0), 5.0 * time_s);
        for (wheel, angle) in [spun, spun, turned].into_iter().enumerate() {
            let measurement = Measurement::WheelAngle { wheel, angle };
            let time_ns = 10_000_000 * step;
            estimator
                .update(Sample {
                    time_ns,
                    measurement,
                })
                .map(|_| ())
                .unwrap();
        }
        let time_ns = 10_000_000 * step;
        let measurement = Measurement::YawRate { rate: 0.0 };
        let _ = estimator.update(Sample {
            time_ns,
            measurement,
        });
        if time_s > 6.0 {
            let known = estimator.latest().wheels[0];
            let (slip, sigma) = (known.slip.unwrap().value(), known.sigma.unwrap());
            assert!(
                1.0 - slip < 1.5 * sigma && sigma < 0.1,
                "{time_s}: {slip} {sigma}"
            );
        }
    }
}

/// Motion capture that loses a robot shows one place, metres away, for seconds: what is believed then is wrong, and is given up once
/// most places contradict it.
#[test]
fn two_seconds_after_a_place_that_was_lost_the_slip_is_as_before() {
    let wheels = [("right", -0.2), ("left", 0.2)]
        .map(|(name, y)| Wheel::powered(name).at(0.0, y).radius(0.1));
    let robot = Robot::new("cart".into(), wheels.to_vec()).unwrap();
    let mut estimator = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
    let (speed, turn, slip) = (1.0, 0.5, 0.1);
    let mut worst = 0.0_f64;
    for step in 0..2500_i64 {
        let time_s = 0.01 * step as f64;
        let mut take = |measurement| {
            let time_ns = 10_000_000 * step;
            estimator
                .update(Sample {
                    time_ns,
                    measurement,
                })
                .map(|_| ())
                .unwrap();
        };
        let yaw = turn * time_s;
        for (wheel, lever) in [0.2, -0.2].into_iter().enumerate() {
            let angle = (speed + lever * turn) * time_s / (1.0 - slip) / 0.1;
            take(Measurement::WheelAngle { wheel, angle });
        }
        take(Measurement::YawRate { rate: turn });
        let (sin, cos) = yaw.sin_cos();
        let radius = speed / turn;
        take(if (8.0..15.0).contains(&time_s) {
            let [x, y, yaw] = [-6.0, 1.2, 0.4];
            Measurement::Pose { x, y, yaw }
        } else {
            let [x, y] = [radius * sin, radius * (1.0 - cos)];
            Measurement::Pose { x, y, yaw }
        });
        if (5.0..8.0).contains(&time_s) || time_s > 17.0 {
            let known = estimator.latest().wheels[0].slip.unwrap();
            worst = worst.max((known.value() - slip).abs());
        }
    }
    assert!(worst < 0.02, "{worst}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_samples_leave_finite_estimates(
        samples in prop::collection::vec((0..50_000_000_i64, wild::measurement()), 1..300),
    ) {
        let wheels = vec![
            Wheel::powered("left").at(0.1, 0.2).radius(0.1).ticks_per_turn(1000),
            Wheel::powered("right").at(0.1, -0.2).radius(0.1).ticks_per_turn(1000),
            Wheel::free("fifth").at(-0.3, 0.0).radius(0.1).ticks_per_turn(1000),
        ];
        let robot = Robot::new("cart".into(), wheels).unwrap();
        let mut estimator = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
        let mut time_ns = 0;
        for (step, measurement) in samples {
            time_ns += step;
            let _ = estimator.update(Sample { time_ns, measurement });
            let measurement = Measurement::WheelCount { wheel: 0, raw: 3 };
            let _ = estimator.update(Sample { time_ns, measurement });
            let known = estimator.latest();
            for wheel in known.wheels {
                prop_assert!(wheel.slip.is_none_or(|slip| slip.value().abs() <= 1.0));
                prop_assert!(wheel.sigma.is_none_or(|sigma| sigma.is_finite() && sigma > 0.0));
            }
            let body = known.body;
            for speed in [body.forward, body.left, body.yaw_rate, body.common_slip] {
                prop_assert!(speed.value.is_finite() && speed.variance >= 0.0);
            }
            prop_assert!(body.odometry.covariance.iter().flatten().all(|v| v.is_finite()));
        }
    }
}
