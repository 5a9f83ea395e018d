//! The robot's computer: it allocates nothing, remembers across a restart, and refuses to drive on a wrong description.

use grouser_slip::control::{Action, Decides, Ending, Mode, Request};
use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::onboard::{
    CarrierLink, OnBoard, OnBoardSettings, SoilFamily, SoilLearnSettings, SoilTables, StartPolicy,
    WheelCarrier,
};
use grouser_slip::prior::{SlipDemand, SoilDoubt};
use grouser_slip::{Health, Invalid, Measured, Measurement, Motion, Robot, Sample, Wheel};
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

/// Rows and ticks come this often, ns.
const PERIOD_NS: i64 = 10_000_000;

fn robot() -> Robot {
    let powered = |name: &str, x, y| {
        let wheel = Wheel::powered(name).at(x, y).radius(0.1);
        wheel.ticks_per_turn(1000).width(0.08).load(40.0)
    };
    let free = Wheel::free("fifth").at(-0.4, 0.0).radius(0.1);
    let wheels = vec![
        powered("left", 0.2, 0.2),
        powered("right", 0.2, -0.2),
        free.ticks_per_turn(1000).width(0.04).load(3.0),
    ];
    Robot::new("tricycle".into(), wheels).unwrap()
}

fn settings(robot: &Robot) -> OnBoardSettings {
    let mut settings = OnBoardSettings::new(robot);
    for setup in &mut settings.wheels[..2] {
        setup.max_torque = Some(8.0);
    }
    settings
}

/// What every sensor sends at `row`: powered rims run at 0.31 m/s, the free one at 0.25 m/s once two seconds have passed.
fn samples(row: i64, force: [f64; 3], yaw_rate: f64) -> Vec<Sample> {
    let time_ns = row * PERIOD_NS;
    let driven = (row - 200).max(0).cast_unsigned();
    let counts = [5 * driven, 5 * driven, 4 * driven];
    let mut measurements = vec![
        Measurement::JointAngle {
            joint: 0,
            angle: 0.0,
        },
        Measurement::Inertial {
            force,
            rate: [0.0, 0.0, yaw_rate],
        },
        Measurement::MotorCurrent {
            wheel: 0,
            share: 0.2,
        },
    ];
    for (wheel, raw) in counts.into_iter().enumerate() {
        measurements.push(Measurement::WheelCount { wheel, raw });
    }
    let stamped = measurements.into_iter().map(|measurement| Sample {
        time_ns,
        measurement,
    });
    stamped.collect()
}

fn row(on_board: &mut OnBoard, row: i64, force: [f64; 3], yaw_rate: f64) {
    for sample in samples(row, force, yaw_rate) {
        on_board.update(sample);
    }
}

fn request() -> Request {
    Request {
        speed: 0.3,
        heading: 0.0,
        yaw_rate: None,
    }
}

#[test]
fn it_estimates_and_commands() {
    let robot = robot();
    let mut on_board = OnBoard::new(&robot, settings(&robot)).unwrap();
    let mut rim_speed = 0.0;
    for index in 0..800 {
        row(
            &mut on_board,
            index,
            [0.0, 0.0, EARTH_GRAVITY_M_PER_S2],
            0.0,
        );
        rim_speed = on_board.tick(index * PERIOD_NS, request())[0].rim_speed;
    }
    let slip = on_board.observations()[0].slip.unwrap();
    assert!((slip - 0.2).abs() < 0.03, "{slip}");
    assert!(rim_speed > 0.1, "{rim_speed}");
    assert!(on_board.start_fault().is_none());
    // six seconds at 0.25 m/s
    let body = on_board.body();
    assert!((body.distance - 1.5).abs() < 0.05, "{body:?}");
    assert_eq!(on_board.estimate().body, body);
}

#[test]
fn neither_samples_nor_ticks_allocate() {
    let robot = robot();
    let mut with_soil = settings(&robot);
    let soil = grouser_terra::catalogue::find("dry-sand")
        .unwrap()
        .soil()
        .unwrap();
    let tables = SoilTables::solve(&robot, &with_soil.wheels, &soil, SoilDoubt::default());
    with_soil.soil = tables.unwrap();
    let family = SoilFamily::solve(&robot, &with_soil.wheels, &soil);
    with_soil.soil.family = Some(family.unwrap());
    with_soil.learn = Some(SoilLearnSettings::default());
    let mut on_board = OnBoard::new(&robot, with_soil).unwrap();
    let samples = [
        Measurement::Inertial {
            force: [0.1, 0.0, EARTH_GRAVITY_M_PER_S2],
            rate: [0.0, 0.01, 0.02],
        },
        Measurement::JointAngle {
            joint: 1,
            angle: 0.1,
        },
        Measurement::MotorCurrent {
            wheel: 1,
            share: 0.3,
        },
        Measurement::Displacement {
            forward: 0.003,
            left: 0.0,
            turn: None,
        },
    ];
    let info = allocation_counter::measure(|| {
        for index in 0..1000 {
            let time_ns = index * PERIOD_NS;
            for measurement in samples {
                on_board.update(Sample {
                    time_ns,
                    measurement,
                });
            }
            for wheel in 0..3 {
                let raw = 5 * index.cast_unsigned();
                on_board.update(Sample {
                    time_ns,
                    measurement: Measurement::WheelCount { wheel, raw },
                });
            }
            on_board.tick(time_ns, request());
        }
        let state = on_board.state();
        on_board.restore(&state).unwrap();
    });
    assert_eq!(info.count_total, 0);
}

#[test]
fn what_it_has_learnt_outlasts_a_restart() {
    let robot = robot();
    let mut before = OnBoard::new(&robot, settings(&robot)).unwrap();
    for index in 0..3000 {
        row(&mut before, index, [0.0, 0.0, EARTH_GRAVITY_M_PER_S2], 0.01);
        before.tick(index * PERIOD_NS, request());
    }
    let state = before.state();
    let bias = state.learnt.gyro_bias.unwrap();
    assert!((bias.value - 0.01).abs() < 0.004, "{bias:?}");
    let mut after = OnBoard::new(&robot, settings(&robot)).unwrap();
    let at_first = after.state().learnt.gyro_bias.unwrap();
    assert!(at_first.value.abs() < 1e-12);
    after.restore(&state).unwrap();
    let restored = after.state();
    assert_eq!(restored.learnt.gyro_bias, Some(bias));
    assert_eq!(restored.learnt.log_slip, state.learnt.log_slip);
    assert_eq!(restored.heading, state.heading);
    let mut broken = state;
    broken.learnt.gyro_bias = Some(Measured {
        value: f64::NAN,
        ..bias
    });
    assert!(after.restore(&broken).is_err());
    assert_eq!(after.state(), restored);
}

/// A sensor's fault must not be what a robot fails to start with after it was repaired.
#[test]
fn the_bias_of_a_broken_sensor_is_not_kept() {
    let robot = robot();
    let mut filter = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
    for index in 0..6000 {
        let time_ns = index * PERIOD_NS;
        let acceleration = Measurement::Acceleration {
            forward: 9.0,
            left: 0.0,
        };
        for wheel in 0..3 {
            let measurement = Measurement::WheelCount { wheel, raw: 0 };
            let _ = filter.update(Sample {
                time_ns,
                measurement,
            });
        }
        let _ = filter.update(Sample {
            time_ns,
            measurement: acceleration,
        });
    }
    let learnt = filter.learnt();
    let kept = learnt.accelerometer_bias;
    assert!(kept.is_none_or(|of| of.value.abs() < 1.0), "{learnt:?}");
    let mut after = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
    after.restore(&learnt).unwrap();
    assert!(after.learnt().accelerometer_bias.is_some());
}

/// The sensor's forward axis points up: every later number would be wrong.
#[test]
fn it_does_not_drive_where_gravity_lies_along_another_axis() {
    let robot = robot();
    for (policy, drives) in [
        (StartPolicy::Refuse, false),
        (StartPolicy::Report, true),
        (StartPolicy::Off, true),
    ] {
        let mut settings = settings(&robot);
        settings.start_policy = policy;
        let mut on_board = OnBoard::new(&robot, settings).unwrap();
        let mut fastest = 0.0_f64;
        for index in 0..400 {
            row(
                &mut on_board,
                index,
                [EARTH_GRAVITY_M_PER_S2, 0.0, 0.1],
                0.0,
            );
            for command in on_board.tick(index * PERIOD_NS, request()) {
                fastest = fastest.max(command.rim_speed.abs());
            }
        }
        assert_eq!(fastest > 0.0, drives, "{policy:?}");
        let fault = on_board.start_fault().map(|fault| fault.to_string());
        let is_named = fault.is_some_and(|fault| fault.contains("acceleration forward"));
        assert_eq!(is_named, policy != StartPolicy::Off);
    }
}

#[test]
fn gravity_is_a_setting() {
    let robot = robot();
    let mut lunar = settings(&robot);
    lunar.gravity = 1.62;
    lunar.start_policy = StartPolicy::Refuse;
    let mut on_board = OnBoard::new(&robot, lunar).unwrap();
    let tilt = 0.1_f64;
    let force = [1.62 * tilt.sin(), 0.0, 1.62 * tilt.cos()];
    for index in 0..300 {
        row(&mut on_board, index, force, 0.0);
        on_board.tick(index * PERIOD_NS, request());
    }
    assert!(on_board.start_fault().is_none());
    // nose up is negative
    assert!((on_board.attitude().pitch() + tilt).abs() < 1e-6);
}

/// It is put down and rocks on its wheels for as long as the attitude is found.
#[test]
fn a_robot_that_is_put_down_has_not_tipped() {
    let tips = |rocks_s: f64| {
        let robot = robot();
        let mut on_board = OnBoard::new(&robot, settings(&robot)).unwrap();
        for index in 0..200 {
            let lean = if (index as f64) * 0.01 < rocks_s {
                0.9_f64
            } else {
                0.0
            };
            let force = [0.0, lean.sin(), lean.cos()].map(|part| part * EARTH_GRAVITY_M_PER_S2);
            row(&mut on_board, index, force, 0.0);
            on_board.tick(index * PERIOD_NS, request());
            if let Some(decision) = on_board.decision()
                && decision.action == Action::End(Ending::Tipping)
            {
                return true;
            }
        }
        false
    };
    // the mean of what gravity shows is below 0.61 rad by half a second; a robot that goes on leaning tips
    assert!(!tips(0.3));
    assert!(tips(2.0));
}

#[test]
fn what_does_not_exist_changes_nothing() {
    let robot = robot();
    let mut on_board = OnBoard::new(&robot, settings(&robot)).unwrap();
    for measurement in [
        Measurement::JointAngle {
            joint: 99,
            angle: 1.0,
        },
        Measurement::MotorCurrent {
            wheel: 99,
            share: 1.0,
        },
        Measurement::WheelCount { wheel: 99, raw: 1 },
    ] {
        for time_ns in [i64::MIN, 0, i64::MAX] {
            on_board.update_at(
                time_ns,
                Sample {
                    time_ns,
                    measurement,
                },
            );
            on_board.tick(time_ns, request());
        }
    }
    assert!(on_board.set_steering_angle(99, 0.1).is_err());
    let mut short = settings(&robot);
    short.wheels.pop();
    assert!(OnBoard::new(&robot, short).is_err());
}

/// Rows from `from` to `to` with an upright robot and a tick after each.
fn drive(on_board: &mut OnBoard, (from, to): (i64, i64), mut after: impl FnMut(&mut OnBoard, i64)) {
    for index in from..to {
        row(on_board, index, [0.0, 0.0, EARTH_GRAVITY_M_PER_S2], 0.0);
        after(on_board, index * PERIOD_NS);
        on_board.tick(index * PERIOD_NS, request());
    }
}

#[test]
fn poses_reach_the_filter_where_they_are_used_and_nowhere_else() {
    for uses_poses in [true, false] {
        let robot = robot();
        let mut settings = settings(&robot);
        settings.uses_poses = uses_poses;
        let mut on_board = OnBoard::new(&robot, settings).unwrap();
        drive(&mut on_board, (0, 400), |_, _| ());
        let before = on_board.estimate().rejected.total();
        // the filter refuses it and counts that
        let (x, y, yaw) = (f64::NAN, 0.0, 0.0);
        on_board.update(Sample {
            time_ns: 400 * PERIOD_NS,
            measurement: Measurement::Pose { x, y, yaw },
        });
        let refused = on_board.estimate().rejected.total() - before;
        assert_eq!(refused, u64::from(uses_poses));
        on_board.update(Sample {
            time_ns: 401 * PERIOD_NS,
            measurement: Measurement::Pose { x, y, yaw },
        });
        assert_eq!(on_board.estimate().rejected.total(), on_board.refused());
        assert_eq!(on_board.refused() - before, 2 * refused);
    }
}

#[test]
fn a_decision_is_that_of_the_last_tick() {
    let robot = robot();
    let mut on_board = OnBoard::new(&robot, settings(&robot)).unwrap();
    drive(&mut on_board, (0, 300), |_, _| ());
    assert_eq!(on_board.decision(), None);
    // it falls on its side
    let mut ends = Vec::new();
    for index in 300..1500 {
        row(
            &mut on_board,
            index,
            [0.0, EARTH_GRAVITY_M_PER_S2, 0.0],
            0.0,
        );
        on_board.tick(index * PERIOD_NS, request());
        ends.extend(
            on_board
                .decision()
                .map(|decision| (decision.time_ns, decision.action)),
        );
    }
    let tipping = Action::End(Ending::Tipping);
    let end = ends.iter().find(|(_, action)| *action == tipping).unwrap();
    assert_eq!(on_board.mode(), Mode::Stopped);
    assert_eq!(on_board.decision(), None);
    assert!(end.0 > 300 * PERIOD_NS && ends.last().unwrap().1 == tipping);
}

#[test]
fn a_joint_that_turns_a_rocker_turns_its_wheel() {
    // the rocker turns nose down at 0.25 rad/s: its wheel of 0.1 m rolls 0.025 m/s faster than its encoder counts
    let rim_speed = |rate: f64| {
        let robot = robot();
        let mut settings = settings(&robot);
        let link = CarrierLink {
            joint: 1,
            sign: 1.0,
            pivot: [0.2, 0.1],
        };
        settings.wheels[0].carrier = WheelCarrier::on_chassis([0.2, 0.1]).with_link(link);
        let mut on_board = OnBoard::new(&robot, settings).unwrap();
        drive(&mut on_board, (0, 600), |on_board, time_ns| {
            let measurement = Measurement::JointAngle {
                joint: 1,
                angle: rate * time_ns as f64 * 1e-9,
            };
            on_board.update(Sample {
                time_ns,
                measurement,
            });
        });
        on_board.estimate().wheels[0].rim_speed.unwrap().value
    };
    let faster = rim_speed(0.25) - rim_speed(0.0);
    assert!((faster - 0.025).abs() < 0.003, "{faster}");
}

#[test]
fn a_standing_wheel_with_four_fifths_of_its_greatest_torque_has_stalled() {
    for (share, stalls) in [(0.85, true), (0.75, false)] {
        let robot = robot();
        let mut on_board = OnBoard::new(&robot, settings(&robot)).unwrap();
        // all stand; the left wheel pushes
        for index in 0..200 {
            let time_ns = index * PERIOD_NS;
            let current = Measurement::MotorCurrent { wheel: 0, share };
            let force = [0.0, 0.0, EARTH_GRAVITY_M_PER_S2];
            let inertial = Measurement::Inertial {
                force,
                rate: [0.0; 3],
            };
            let counts = [0, 1, 2].map(|wheel| Measurement::WheelCount { wheel, raw: 0 });
            for measurement in counts.into_iter().chain([current, inertial]) {
                on_board.update(Sample {
                    time_ns,
                    measurement,
                });
            }
            on_board.tick(time_ns, request());
        }
        let motion = on_board.observations()[0].motion;
        assert_eq!(motion == Some(Motion::Stall), stalls, "{share}: {motion:?}");
        assert_eq!(on_board.observations()[0].torque_share, Some(share));
    }
}

#[test]
fn without_wheels_it_knows_no_speed() {
    let robot = robot();
    let mut on_board = OnBoard::new(&robot, settings(&robot)).unwrap();
    assert_eq!(on_board.speed(), None);
    drive(&mut on_board, (0, 500), |_, _| ());
    assert!((on_board.speed().unwrap() - 0.25).abs() < 0.03);
    for index in 500..800 {
        let force = [0.0, 0.0, EARTH_GRAVITY_M_PER_S2];
        let measurement = Measurement::Inertial {
            force,
            rate: [0.0; 3],
        };
        on_board.update(Sample {
            time_ns: index * PERIOD_NS,
            measurement,
        });
        on_board.tick(index * PERIOD_NS, request());
    }
    assert_eq!(on_board.speed(), None);
}

#[test]
fn sensors_are_silent_once_none_of_them_was_accepted_for_half_a_second() {
    // an inertial unit alone, a part of whose readings may be refused; the wheels have never sent
    let gravity = [0.0, 0.0, EARTH_GRAVITY_M_PER_S2];
    for (force, rate) in [
        (gravity, [0.0; 3]),
        (gravity, [0.0, 0.0, f64::NAN]),
        ([f64::NAN; 3], [0.0; 3]),
    ] {
        let robot = robot();
        let mut on_board = OnBoard::new(&robot, settings(&robot)).unwrap();
        for index in 0..200 {
            on_board.tick(index * PERIOD_NS, request());
            on_board.update(Sample {
                time_ns: index * PERIOD_NS,
                measurement: Measurement::Inertial { force, rate },
            });
            let health = on_board.observations()[0].health;
            assert_eq!(health, Health::Uninitialised, "{index}");
        }
        // a step of the loop counts as a tenth of a second at most: five of them are not more than half a second
        for step in 1..=8 {
            on_board.tick(1_990_000_000 + step * 200_000_000, request());
            let expected = if step <= 5 {
                Health::Uninitialised
            } else {
                Health::Invalid(Invalid::Dropout)
            };
            assert_eq!(on_board.observations()[0].health, expected, "{step}");
        }
    }
}

/// Where the nose rises it drives uphill; backwards, where it falls.
#[test]
fn the_demand_of_the_slope_is_looked_up_ten_times_a_second() {
    for direction in [1, -1] {
        demand_of_the_slope(direction);
    }
}

fn demand_of_the_slope(direction: i64) {
    let sign = direction as f64;
    let demands = [(-0.35, 0.1), (0.0, 0.1), (1e-4, 0.8), (0.35, 0.8)];
    let points = demands.map(|(slope, mean)| (slope, SlipPrior { mean, sigma: 0.01 }));
    let robot = robot();
    let mut settings = settings(&robot);
    settings.soil.slip_demand = Some(SlipDemand::from_points(&points).unwrap());
    settings.control.decides = Decides::Nothing;
    settings.control.max_acceleration = 100.0;
    (settings.control.gain, settings.control.integral_gain) = (0.0, 0.0);
    settings.control.crawl = 0.0;
    let mut on_board = OnBoard::new(&robot, settings).unwrap();
    for index in 0..230 {
        let time_ns = index * PERIOD_NS;
        // after the tick at two seconds, the second one that looks, that end rises by 0.01 rad
        let slope = if index > 200 { 0.01 * sign } else { 0.0 };
        let (sin, cos) = slope.sin_cos();
        let force = [sin, 0.0, cos].map(|part| part * EARTH_GRAVITY_M_PER_S2);
        let inertial = Measurement::Inertial {
            force,
            rate: [0.0; 3],
        };
        // 0.5 mm a row, by ticks of 0.628 mm
        let raw = (1000 + direction * ((5 * index) / 6)).cast_unsigned();
        let counts = [0, 1, 2].map(|wheel| Measurement::WheelCount { wheel, raw });
        for measurement in counts.into_iter().chain([inertial]) {
            on_board.update(Sample {
                time_ns,
                measurement,
            });
        }
        if index < 190 {
            continue;
        }
        let ahead = Request {
            speed: 0.3 * sign,
            ..request()
        };
        let rim_speed = sign * on_board.tick(time_ns, ahead)[0].rim_speed;
        if index < 195 {
            continue;
        }
        // the optimum's setpoint at first, then that of the demand
        let limit = if index < 210 { 0.3 } else { 0.86 };
        let expected = f64::min(0.0524 / (1.0 - limit), 0.3);
        assert!(
            (rim_speed / expected - 1.0).abs() < 0.2,
            "{index}: {rim_speed} {expected}"
        );
    }
}

/// Samples that a radio or a driver holds back and delivers at once, with the right stamps.
#[test]
fn a_burst_leaves_no_trace_once_it_has_come() {
    let robot = robot();
    let force = [0.0, 0.0, EARTH_GRAVITY_M_PER_S2];
    for held in [1, 10, 40] {
        let mut on_time = OnBoard::new(&robot, settings(&robot)).unwrap();
        let mut in_bursts = on_time.clone();
        let mut waiting = Vec::new();
        for index in 0..900 {
            let now_ns = index * PERIOD_NS;
            row(&mut on_time, index, force, 0.0);
            on_time.tick(now_ns, request());
            waiting.extend(samples(index, force, 0.0));
            let is_held = index > 300 && index % 100 != 0 && index % 100 <= held;
            if !is_held {
                for sample in waiting.drain(..) {
                    in_bursts.update_at(now_ns, sample);
                }
            }
            let is_commanded = in_bursts.tick(now_ns, request())[0].rim_speed > 0.1;
            assert!(is_commanded || index < 300, "{held}: {index}");
            assert_eq!(in_bursts.mode(), Mode::Forward);
            for (late, usual) in in_bursts.observations().iter().zip(on_time.observations()) {
                if is_held {
                    // known from before until the wheels count as silent, after a tenth of a second
                    let is_silent = late.health == Health::Invalid(Invalid::Dropout);
                    assert_eq!(
                        is_silent,
                        index % 100 >= 9,
                        "{held}: {index} {:?}",
                        late.health
                    );
                } else {
                    assert_eq!(
                        (
                            late.slip,
                            late.sigma,
                            late.health,
                            late.forward_speed,
                            late.rim_speed
                        ),
                        (
                            usual.slip,
                            usual.sigma,
                            usual.health,
                            usual.forward_speed,
                            usual.rim_speed
                        ),
                        "{held}: {index}"
                    );
                }
            }
        }
        assert_eq!(in_bursts.estimate().rejected.total(), 0);
        assert_eq!(in_bursts.state(), on_time.state());
    }
}
