//! The estimator on drives whose slip is known.

use grouser_slip::window::{WindowEstimator, WindowSettings};
use grouser_slip::{
    Degraded, Fault, Health, Invalid, Measurement, Motion, Reference, Robot, Sample, Slip,
    WheelRole,
};
use proptest::prelude::*;

use crate::cart;
use crate::cart::{Drivers, FREE, robot, settings};

const ROW: i64 = 20_000_000;

fn drive(
    estimator: &mut WindowEstimator,
    robot: &Robot,
    drivers: Drivers,
    rows: std::ops::Range<i64>,
) {
    for row in rows {
        for sample in drivers.row(robot, row * ROW, 0) {
            estimator.update(sample).unwrap();
        }
    }
}

fn update(
    estimator: &mut WindowEstimator,
    time_ns: i64,
    measurement: Measurement,
) -> Result<(), Fault> {
    estimator
        .update(Sample {
            time_ns,
            measurement,
        })
        .map(|_| ())
}

fn slip_of(estimator: &WindowEstimator, wheel: usize) -> Option<f64> {
    estimator.latest().unwrap().wheels[wheel]
        .slip
        .map(Slip::value)
}

#[test]
fn a_turn_is_taken_out_of_every_wheel() {
    // The free wheel stands off the middle: v_body = v_f + Ω y_f, v_i = v_body − Ω y_i.
    let robot = robot(32);
    for (slip, yaw_rate) in [(0.2, 0.5), (0.4, -0.8), (-0.3, 0.5), (0.0, 0.7)] {
        let drivers = Drivers {
            speed: 0.5,
            yaw_rate,
            slip,
        };
        let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
        drive(&mut estimator, &robot, drivers, 0..60);
        let estimate = estimator.latest().unwrap();
        for (index, wheel) in estimate.wheels.iter().enumerate().take(4) {
            let (found, sigma) = (wheel.slip.unwrap().value(), wheel.sigma.unwrap());
            // One tick at each end of both counters is 4 q/(v T) at most: 0.0025 of 0.3 m/s.
            assert!((found - slip).abs() < 0.0042, "{found} {slip}");
            assert!(sigma > 1e-4 && sigma < 0.05, "{sigma}");
            assert_eq!(wheel.health, Health::Ok);
            let forward = 0.5 - yaw_rate * robot.wheels()[index].y;
            assert!((wheel.forward_speed.unwrap().value - forward).abs() < 2e-3);
        }
        assert_eq!(estimate.wheels[FREE].slip, None);
        let along = estimate.body.along.unwrap().value();
        assert!((along - slip).abs() < 0.003, "{along} {slip}");
    }
}

#[test]
fn motions_are_named() {
    let robot = robot(32);
    for (speed, slip, motion) in [
        (0.3, 0.2, Motion::Driving),
        (0.3, -0.2, Motion::Braking),
        (0.0, 0.0, Motion::Standstill),
        (-0.3, 0.2, Motion::Driving),
    ] {
        let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
        let drivers = Drivers {
            speed,
            yaw_rate: 0.0,
            slip,
        };
        drive(&mut estimator, &robot, drivers, 0..60);
        let wheel = estimator.latest().unwrap().wheels[0];
        assert_eq!(wheel.motion, Some(motion), "{speed} {slip}");
        assert_eq!(wheel.slip.is_some(), motion != Motion::Standstill);
    }
}

#[test]
fn roll_back_is_a_state_and_no_number() {
    let robot = robot(32);
    let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
    let back = Drivers {
        speed: -0.2,
        yaw_rate: 0.0,
        slip: 0.0,
    };
    let forward = Drivers {
        speed: 0.2,
        yaw_rate: 0.0,
        slip: 0.0,
    };
    for row in 0..60 {
        for (index, sample) in back.row(&robot, row * ROW, 0).into_iter().enumerate() {
            // Wheel 0 turns forwards while the robot slides back.
            let sample = if index == 0 {
                forward.row(&robot, row * ROW, 0)[0]
            } else {
                sample
            };
            estimator.update(sample).unwrap();
        }
    }
    let wheel = estimator.latest().unwrap().wheels[0];
    assert_eq!((wheel.motion, wheel.slip), (Some(Motion::RollBack), None));
}

#[test]
fn a_stream_that_wraps_gives_the_same_bits() {
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.3,
        slip: 0.25,
    };
    for (bits, start) in [
        (16, 65_500),
        (16, 30),
        (32, u64::from(u32::MAX) - 500),
        (64, u64::MAX - 9),
    ] {
        let narrow = robot(bits);
        let mut wrapped = WindowEstimator::new(&narrow, settings()).unwrap();
        let mut plain = WindowEstimator::new(&narrow, settings()).unwrap();
        for row in 0..200 {
            // Backwards for start = 30: the counters go below zero.
            let drivers = if start == 30 {
                Drivers {
                    speed: -0.4,
                    ..drivers
                }
            } else {
                drivers
            };
            let there = drivers.row(&narrow, row * ROW, start);
            let here = drivers.row(&narrow, row * ROW, 1 << 15);
            for (mut a, b) in there.into_iter().zip(here) {
                if let Measurement::WheelCount { raw, .. } = &mut a.measurement {
                    *raw &= u64::MAX >> (64 - bits);
                }
                let (a, b) = (
                    wrapped.update(a).unwrap().body,
                    plain.update(b).unwrap().body,
                );
                assert_eq!(a, b);
            }
            assert_eq!(
                wrapped.latest().unwrap().wheels,
                plain.latest().unwrap().wheels
            );
        }
    }
}

#[test]
fn a_reset_counter_costs_one_sample_and_a_window() {
    let robot = robot(32);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.0,
        slip: 0.2,
    };
    let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
    drive(&mut estimator, &robot, drivers, 0..100);
    let mut refused = 0;
    for row in 100..160 {
        for mut sample in drivers.row(&robot, row * ROW, 0) {
            if let Measurement::WheelCount { wheel: 1, raw } = &mut sample.measurement {
                // 8.5 turns back at once: no robot does that.
                *raw -= 3000;
            }
            refused += u64::from(estimator.update(sample).is_err());
        }
    }
    assert_eq!(refused, 1);
    assert_eq!(estimator.rejected().jump, 1);
    let found = slip_of(&estimator, 1).unwrap();
    assert!((found - 0.2).abs() < 0.004, "{found}");
}

#[test]
fn one_outlier_changes_nothing() {
    let robot = robot(32);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.0,
        slip: 0.2,
    };
    let mut with = WindowEstimator::new(&robot, settings()).unwrap();
    let mut without = WindowEstimator::new(&robot, settings()).unwrap();
    for row in 0..150 {
        for sample in drivers.row(&robot, row * ROW, 0) {
            let Measurement::WheelCount { wheel: 2, raw } = sample.measurement else {
                with.update(sample).unwrap();
                without.update(sample).unwrap();
                continue;
            };
            if row == 100 {
                let measurement = Measurement::WheelCount {
                    wheel: 2,
                    raw: raw + 1_000_000,
                };
                assert!(matches!(
                    with.update(Sample {
                        measurement,
                        ..sample
                    }),
                    Err(Fault::Jump { .. })
                ));
            } else {
                with.update(sample).unwrap();
                without.update(sample).unwrap();
            }
        }
        // Without: the sample is simply not there. The same bits from then on.
        assert_eq!(
            with.latest().unwrap().wheels[2],
            without.latest().unwrap().wheels[2]
        );
    }
}

#[test]
fn at_a_tick_or_two_a_window_there_is_no_slip_to_flicker() {
    let robot = robot(32);
    // 1 tick is 0.157 mm: 3 mm/s is 9.5 ticks a window.
    let drivers = Drivers {
        speed: 0.003,
        yaw_rate: 0.0,
        slip: 0.1,
    };
    let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
    drive(&mut estimator, &robot, drivers, 0..200);
    let wheel = estimator.latest().unwrap().wheels[0];
    assert_eq!(wheel.slip, None);
    assert_eq!(wheel.health, Health::Degraded(Degraded::LowSpeed));
}

#[test]
fn a_spinning_wheel_reads_one_and_never_more() {
    let robot = robot(32);
    let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
    let spin = Drivers {
        speed: 0.3,
        yaw_rate: 0.0,
        slip: 0.0,
    };
    let still = Drivers {
        speed: 0.0,
        yaw_rate: 0.0,
        slip: 0.0,
    };
    for row in 0..3000 {
        let rows = spin
            .row(&robot, row * ROW, 0)
            .into_iter()
            .zip(still.row(&robot, row * ROW, 0));
        for (index, (spinning, still)) in rows.enumerate() {
            estimator
                .update(if index < 4 { spinning } else { still })
                .unwrap();
        }
        if row > 30 {
            let found = slip_of(&estimator, 0).unwrap();
            assert!((1.0 - found).abs() <= 0.03 && found <= 1.0, "{found}");
        }
    }
}

#[test]
fn times_that_do_not_go_on() {
    let robot = robot(32);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.0,
        slip: 0.2,
    };
    let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
    drive(&mut estimator, &robot, drivers, 0..100);
    let before = slip_of(&estimator, 0);
    let last = drivers.row(&robot, 99 * ROW, 0);
    // The same time again, a microsecond, a second and a year back: refused, counted, nothing moves.
    for (refused, back) in [
        (1, 0),
        (2, 1_000),
        (3, 1_000_000_000),
        (4, 31_536_000_000_000_000),
    ] {
        let sample = Sample {
            time_ns: last[0].time_ns - back,
            ..last[0]
        };
        assert!(matches!(
            estimator.update(sample),
            Err(Fault::NotLater { .. })
        ));
        assert_eq!(estimator.rejected().not_later, refused);
        assert_eq!(slip_of(&estimator, 0), before);
    }
    // Fifty years ahead: one update's cost, a new start, and the slip again a window later.
    let years = 50 * 31_536_000_000_000_000;
    for row in 0..60 {
        for mut sample in drivers.row(&robot, (100 + row) * ROW, 0) {
            sample.time_ns += years;
            estimator.update(sample).unwrap();
        }
    }
    assert!((slip_of(&estimator, 0).unwrap() - 0.2).abs() < 0.004);
    // And the clock set back for good: the second sample of the new series is believed.
    let refused = estimator.rejected().not_later;
    for row in 0..60 {
        for sample in drivers.row(&robot, (200 + row) * ROW, 0) {
            let _ = estimator.update(sample);
        }
    }
    assert_eq!(estimator.rejected().not_later - refused, 6);
    assert!((slip_of(&estimator, 0).unwrap() - 0.2).abs() < 0.004);
}

#[test]
fn silent_sensors_are_named() {
    let robot = robot(32);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.0,
        slip: 0.2,
    };
    let mut estimator = WindowEstimator::new(&robot, settings()).unwrap();
    drive(&mut estimator, &robot, drivers, 0..100);
    for row in 100..140 {
        for (index, sample) in drivers.row(&robot, row * ROW, 0).into_iter().enumerate() {
            if index != 1 {
                estimator.update(sample).unwrap();
            }
        }
    }
    let estimate = estimator.latest().unwrap();
    assert_eq!(estimate.wheels[1].health, Health::Invalid(Invalid::Dropout));
    assert!(estimate.wheels[1].last_good_age.unwrap() > 0.2);
    assert_eq!(estimate.wheels[0].health, Health::Ok);
    // Now the free wheel falls silent.
    for row in 140..180 {
        for sample in drivers.row(&robot, row * ROW, 0).into_iter().take(4) {
            estimator.update(sample).unwrap();
        }
    }
    let health = estimator.latest().unwrap().wheels[0].health;
    assert_eq!(health, Health::Degraded(Degraded::ReferenceLost));
}

#[test]
fn displacement_pose_and_speed_agree() {
    // One drive along a circle, reported by three references.
    let robot = robot(32);
    let (speed, yaw_rate, slip) = (0.4, 0.5, 0.3);
    let drivers = Drivers {
        speed,
        yaw_rate,
        slip,
    };
    let seconds = ROW as f64 * 1e-9;
    for reference in [Reference::Displacement, Reference::Pose, Reference::Speed] {
        let settings = WindowSettings {
            reference,
            ..settings()
        };
        let mut estimator = WindowEstimator::new(&robot, settings).unwrap();
        for row in 0..80 {
            let time_ns = row * ROW;
            let yaw = yaw_rate * row as f64 * seconds;
            let measurement = match reference {
                Reference::Displacement => {
                    let turn = yaw_rate * seconds;
                    let chord = 2.0 * speed / yaw_rate * (0.5 * turn).sin();
                    Measurement::Displacement {
                        forward: chord,
                        left: 0.0,
                        turn: Some(turn),
                    }
                }
                Reference::Pose => {
                    let radius = speed / yaw_rate;
                    // Many turns: the yaw is wrapped, as poses are.
                    let wrapped = (yaw + 3.0).rem_euclid(std::f64::consts::TAU) - 3.0;
                    Measurement::Pose {
                        x: radius * yaw.sin(),
                        y: -radius * yaw.cos(),
                        yaw: wrapped,
                    }
                }
                _ => Measurement::Speed {
                    forward: speed,
                    left: None,
                },
            };
            update(&mut estimator, time_ns, measurement).unwrap();
            for sample in drivers.row(&robot, time_ns, 0) {
                estimator.update(sample).unwrap();
            }
        }
        for index in 0..5 {
            let truth = if index == FREE { 0.0 } else { slip };
            let found = slip_of(&estimator, index).unwrap();
            // Chords are shorter than arcs by (Ω dt)²/24 = 4e-6; one tick at each end 1e-3.
            assert!(
                (found - truth).abs() < 2e-3,
                "{reference:?} {index} {found}"
            );
        }
    }
}

#[test]
fn the_way_of_a_poor_reference_is_its_own() {
    let robot = robot(32);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.0,
        slip: 0.3,
    };
    let way_by = |position_sigma: f64| {
        let settings = WindowSettings {
            reference: Reference::Displacement,
            position_sigma,
            ..settings()
        };
        let mut estimator = WindowEstimator::new(&robot, settings).unwrap();
        for row in 0..200 {
            let displacement = Measurement::Displacement {
                forward: 0.4 * ROW as f64 * 1e-9,
                left: 0.0,
                turn: None,
            };
            update(&mut estimator, row * ROW, displacement).unwrap();
            for sample in drivers.row(&robot, row * ROW, 0) {
                estimator.update(sample).unwrap();
            }
        }
        estimator.latest().unwrap().body.travel_reference
    };
    let expected = way_by(0.001);
    assert!(expected > 1.0);
    for sigma in [0.5, 2.5, 10.0] {
        let found = way_by(sigma) / expected;
        // drawn to 0 by a speed unknown to 100 σ over the window, beside √2 σ over the quarter of it in which ways are
        // summed: by 32 / 100²
        assert!((found - 1.0).abs() < 0.005, "{sigma}: {found}");
    }
}

#[test]
fn a_refused_displacement_leaves_no_wrong_slip_and_a_pose_that_jumps_is_followed() {
    let robot = robot(32);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.0,
        slip: 0.3,
    };
    for (reference, bad) in [
        (Reference::Displacement, f64::NAN),
        (Reference::Displacement, 50.0),
        (Reference::Pose, f64::NAN),
        (Reference::Pose, 50.0),
    ] {
        let settings = WindowSettings {
            reference,
            ..settings()
        };
        let mut estimator = WindowEstimator::new(&robot, settings).unwrap();
        let mut found = 0;
        for row in 0..200 {
            // From row 100 on the pose is off by `bad` for good; of displacements only one is bad.
            let forward = 0.008;
            let measurement = match reference {
                Reference::Pose if bad.is_nan() && row == 100 => Measurement::Pose {
                    x: bad,
                    y: 0.0,
                    yaw: 0.0,
                },
                Reference::Pose => Measurement::Pose {
                    x: forward * row as f64
                        + if row >= 100 && !bad.is_nan() {
                            bad
                        } else {
                            0.0
                        },
                    y: 0.0,
                    yaw: 0.0,
                },
                _ => Measurement::Displacement {
                    forward: if row == 100 { bad } else { forward },
                    left: 0.0,
                    turn: None,
                },
            };
            let time_ns = row * ROW;
            let refused = update(&mut estimator, time_ns, measurement).is_err();
            assert_eq!(refused, row == 100, "{reference:?} {bad} {row}");
            for sample in drivers.row(&robot, time_ns, 0) {
                estimator.update(sample).unwrap();
            }
            if let Some(slip) = slip_of(&estimator, 0) {
                found += 1;
                assert!(
                    (slip - 0.3).abs() < 2e-3,
                    "{reference:?} {bad} {row} {slip}"
                );
            }
        }
        // Two windows of 25 rows each are lost at most.
        assert!(found >= 148, "{reference:?} {bad} {found}");
    }
}

#[test]
fn edges_give_the_slip_that_counts_give() {
    let robot = robot(32);
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.0,
        slip: 0.2,
    };
    let settings = WindowSettings {
        reference: Reference::Speed,
        ..settings()
    };
    let mut estimator = WindowEstimator::new(&robot, settings).unwrap();
    let tick = std::f64::consts::TAU * 0.1 / cart::TICKS;
    let edges_per_second = 0.5 / tick;
    let mut edge = 0.0;
    for row in 0..80_i64 {
        while edge < row as f64 * 0.02 * edges_per_second {
            edge += 1.0;
            #[allow(clippy::cast_possible_truncation, reason = "seconds in nanoseconds")]
            let time_ns = (edge / edges_per_second * 1e9) as i64;
            let measurement = Measurement::WheelEdge {
                wheel: 0,
                forward: true,
            };
            update(&mut estimator, time_ns, measurement).unwrap();
        }
        let measurement = Measurement::Speed {
            forward: drivers.speed,
            left: None,
        };
        update(&mut estimator, row * ROW, measurement).unwrap();
    }
    let found = slip_of(&estimator, 0).unwrap();
    // Between whole edges only the clock's 1 ns is left.
    assert!((found - 0.2).abs() < 1e-4, "{found}");
    // No more edges: the wheel has stopped while the robot goes on, and is soon known to be locked.
    for row in 80..130_i64 {
        let measurement = Measurement::Speed {
            forward: drivers.speed,
            left: None,
        };
        update(&mut estimator, row * ROW, measurement).unwrap();
    }
    let found = slip_of(&estimator, 0).unwrap();
    assert!(found < -0.99, "{found}");
}

#[test]
fn without_a_reference_nothing_is_claimed() {
    let wheels = robot(32).wheels()[..4].to_vec();
    assert!(wheels.iter().all(|wheel| wheel.role == WheelRole::Powered));
    let four = Robot::new("four".into(), wheels).unwrap();
    let mut estimator = WindowEstimator::new(&four, settings()).unwrap();
    let drivers = Drivers {
        speed: 0.4,
        yaw_rate: 0.0,
        slip: 0.2,
    };
    for row in 0..60 {
        for sample in drivers.row(&robot(32), row * ROW, 0).into_iter().take(4) {
            let estimate = estimator.update(sample).unwrap();
            assert!(estimate.wheels.iter().all(|wheel| wheel.slip.is_none()));
        }
    }
    let health = estimator.latest().unwrap().wheels[0].health;
    assert_eq!(health, Health::Invalid(Invalid::NoReference));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_left_and_the_right_are_mirror_images(
        speed in 0.1_f64..1.0, yaw_rate in -0.5_f64..0.5, slip in -0.5_f64..0.6,
    ) {
        // Mirrored wheels, mirrored turn: mirrored slips, to rounding.
        let one = robot(32);
        let mut wheels = one.wheels().to_vec();
        for wheel in &mut wheels {
            wheel.y = -wheel.y;
        }
        let other = Robot::new("mirror".into(), wheels).unwrap();
        let mut a = WindowEstimator::new(&one, settings()).unwrap();
        let mut b = WindowEstimator::new(&other, settings()).unwrap();
        drive(&mut a, &one, Drivers { speed, yaw_rate, slip }, 0..40);
        drive(&mut b, &other, Drivers { speed, yaw_rate: -yaw_rate, slip }, 0..40);
        for index in 0..4 {
            match (slip_of(&a, index), slip_of(&b, index)) {
                (Some(a), Some(b)) => prop_assert!((a - b).abs() < 1e-9),
                (a, b) => prop_assert_eq!(a, b),
            }
        }
    }
}
