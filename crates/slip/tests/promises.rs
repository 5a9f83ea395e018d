//! What is promised of everything that runs online: total, finite, without allocation, deterministic.

use grouser_real::OutOfRange;
use grouser_slip::window::{WindowEstimator, WindowSettings};
use grouser_slip::{Error, Health, Measurement, Reference, Robot, Sample};
use proptest::prelude::*;

use crate::cart::{Drivers, robot, settings};
use crate::wild::measurement;

fn time() -> impl Strategy<Value = i64> {
    prop_oneof![
        any::<i64>(),
        0..2_000_000_000_i64,
        prop::sample::select(vec![i64::MIN, i64::MAX, i64::MAX - 1, 0, -1, 1]),
    ]
}

fn is_sane(estimator: &WindowEstimator) -> Result<(), TestCaseError> {
    let Some(estimate) = estimator.latest() else {
        return Ok(());
    };
    for wheel in estimate.wheels {
        if let Some(slip) = wheel.slip {
            prop_assert!(slip.value() >= -1.0 && slip.value() <= 1.0);
            prop_assert!(
                wheel
                    .sigma
                    .is_some_and(|sigma| sigma.is_finite() && sigma >= 0.0)
            );
            prop_assert!(!matches!(
                wheel.health,
                Health::Uninitialised | Health::Invalid(_)
            ));
        }
        for speed in [wheel.forward_speed, wheel.rim_speed].into_iter().flatten() {
            prop_assert!(speed.value.is_finite() && speed.variance.is_finite());
            prop_assert!(speed.variance >= 0.0);
        }
    }
    let body = estimate.body;
    prop_assert!(body.travel_wheels.is_finite() && body.travel_reference.is_finite());
    if let Some(motion) = body.motion {
        prop_assert!(motion.velocity.iter().all(|v| v.is_finite()));
        prop_assert!(motion.covariance.iter().flatten().all(|v| v.is_finite()));
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn r1_r2_any_bits_are_survived(
        samples in prop::collection::vec((time(), measurement()), 1..120),
        reference in 0..Reference::ALL.len(),
        bits in prop::sample::select(vec![8_u32, 16, 32, 64]),
    ) {
        let settings = WindowSettings { reference: Reference::ALL[reference], ..settings() };
        let mut estimator = WindowEstimator::new(&robot(bits), settings).unwrap();
        for (time_ns, measurement) in samples {
            let before = estimator.rejected().total();
            let refused = estimator.update(Sample { time_ns, measurement }).is_err();
            prop_assert_eq!(estimator.rejected().total() - before, u64::from(refused));
            is_sane(&estimator)?;
        }
    }

    #[test]
    fn r1_r2_in_order_but_wild(
        steps in prop::collection::vec((1..40_000_000_i64, measurement()), 1..200),
        reference in 0..Reference::ALL.len(),
    ) {
        let settings = WindowSettings { reference: Reference::ALL[reference], ..settings() };
        let mut estimator = WindowEstimator::new(&robot(16), settings).unwrap();
        let mut time_ns = -1_000_000_000;
        for (step, measurement) in steps {
            time_ns += step;
            let _ = estimator.update(Sample { time_ns, measurement });
            is_sane(&estimator)?;
        }
    }
}

#[test]
fn a_bad_number_changes_no_bit() {
    let robot = robot(32);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.1,
        slip: 0.2,
    };
    for reference in Reference::ALL {
        let settings = WindowSettings {
            reference,
            ..settings()
        };
        let mut estimator = WindowEstimator::new(&robot, settings).unwrap();
        for row in 0..60 {
            for sample in drivers.row(&robot, row * 20_000_000, 0) {
                estimator.update(sample).unwrap();
            }
        }
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
            let measurements = [
                Measurement::WheelAngle {
                    wheel: 0,
                    angle: bad,
                },
                Measurement::WheelRate {
                    wheel: 0,
                    rate: bad,
                },
                Measurement::YawRate { rate: bad },
                Measurement::Displacement {
                    forward: bad,
                    left: 0.0,
                    turn: None,
                },
                Measurement::Displacement {
                    forward: 0.0,
                    left: bad,
                    turn: None,
                },
                Measurement::Displacement {
                    forward: 0.0,
                    left: 0.0,
                    turn: Some(bad),
                },
                Measurement::Pose {
                    x: bad,
                    y: 0.0,
                    yaw: 0.0,
                },
                Measurement::Pose {
                    x: 0.0,
                    y: bad,
                    yaw: 0.0,
                },
                Measurement::Pose {
                    x: 0.0,
                    y: 0.0,
                    yaw: bad,
                },
                Measurement::Speed {
                    forward: bad,
                    left: None,
                },
                Measurement::Speed {
                    forward: 0.0,
                    left: Some(bad),
                },
                Measurement::Command {
                    forward: bad,
                    left: 0.0,
                },
                Measurement::Command {
                    forward: 0.0,
                    left: bad,
                },
            ];
            for measurement in measurements {
                let state = |estimator: &WindowEstimator| {
                    let estimate = estimator.latest().unwrap();
                    (estimate.wheels.to_vec(), estimate.body)
                };
                let before = state(&estimator);
                let refused = estimator.update(Sample {
                    time_ns: 1_190_000_000,
                    measurement,
                });
                // A sensor that this reference does not use is not looked at.
                let unused = refused.is_ok();
                assert!(
                    !unused
                        || matches!(
                            measurement,
                            Measurement::Displacement { .. }
                                | Measurement::Pose { .. }
                                | Measurement::Speed { .. }
                        ),
                    "{measurement:?}"
                );
                assert_eq!(before, state(&estimator), "{measurement:?}");
            }
        }
    }
}

#[test]
fn r4_nothing_is_allocated_after_construction() {
    let robot = robot(16);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.1,
        slip: 0.2,
    };
    let rows: Vec<Sample> = (0..500)
        .flat_map(|row| drivers.row(&robot, row * 5_000_000, 60_000))
        .collect();
    let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
    let counted = allocation_counter::measure(|| {
        for sample in &rows {
            let _ = estimator.update(*sample);
        }
    });
    assert_eq!(counted.count_total, 0);
    assert!(estimator.latest().unwrap().wheels[0].slip.is_some());
}

#[test]
fn r5_the_same_samples_give_the_same_bits() {
    let robot = robot(16);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.1,
        slip: 0.2,
    };
    let run = || {
        let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
        for row in 0..200 {
            for sample in drivers.row(&robot, row * 7_000_000, 0) {
                estimator.update(sample).unwrap();
            }
        }
        let estimate = estimator.latest().unwrap();
        format!("{:?} {:?}", estimate.wheels, estimate.body)
    };
    assert_eq!(run(), run());
}

#[test]
fn settings_and_robots_are_checked() {
    let robot = robot(32);
    for bad in [f64::NAN, -1.0, 0.0, f64::INFINITY, 1e300] {
        let settings = WindowSettings {
            window: bad,
            ..WindowSettings::default()
        };
        assert!(matches!(
            WindowEstimator::new(&robot, settings),
            Err(Error::OutOfRange {
                range: OutOfRange {
                    field: "window",
                    ..
                },
                ..
            })
        ));
    }
    for bad in [f64::NAN, 0.0, -0.1, f64::INFINITY, 1e9] {
        let mut wheels = robot.wheels().to_vec();
        wheels[0].radius = bad;
        assert!(matches!(
            Robot::new("bad".into(), wheels),
            Err(Error::OutOfRange {
                range: OutOfRange {
                    field: "radius",
                    ..
                },
                ..
            })
        ));
    }
    let mut twice = robot.wheels().to_vec();
    twice[1].name = twice[0].name.clone();
    assert!(matches!(
        Robot::new("twice".into(), twice),
        Err(Error::WheelName { .. })
    ));
    assert!(matches!(
        Robot::new("none".into(), vec![]),
        Err(Error::WheelCount { .. })
    ));
}
