//! Slips of robots without a free wheel beside an absolute reference, where a plain mean of the same readings does well.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts and steps are small"
)]

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{Health, Measurement, Robot, Sample, Wheel};

use crate::noise::Noise;

const STEP_S: f64 = 0.01;
const RADIUS_M: f64 = 0.1;
/// Slips of the four wheels beside the common one.
const OWN: [f64; 4] = [0.02, -0.01, 0.0, -0.01];

/// A straight drive with known slip.
struct Drive<'a> {
    seconds: f64,
    /// The robot's speed (m/s) and the common slip, by time (s).
    speed: &'a dyn Fn(f64) -> f64,
    slip: &'a dyn Fn(f64) -> f64,
    ticks_per_turn: f64,
    /// Steps between rows of the wheels, and between readings of the reference.
    row_steps: i64,
    reference_steps: i64,
    /// Does a row have rates in the place of counts? And the time without a row after which the wheels have dropped out, s.
    has_rates: bool,
    dropout: f64,
    /// Is a reading a pose, or a speed? Its noise, m or m/s, and how late it arrives, s.
    has_poses: bool,
    sigma: f64,
    late_s: f64,
    has_accelerometer: bool,
    seed: u64,
}

impl Drive<'_> {
    /// Of a wheel with a slip of its own, rad/s.
    fn rate(&self, time_s: f64, own: f64) -> f64 {
        (self.speed)(time_s) / (1.0 - (self.slip)(time_s) - own) / RADIUS_M
    }

    /// Calls `each` after each row with the time and the errors of the slips of the wheels that have one.
    fn run(&self, mut each: impl FnMut(f64, &[f64])) {
        let places = [(0.3, 0.3), (0.3, -0.3), (-0.3, 0.3), (-0.3, -0.3)];
        let wheels = places.into_iter().enumerate().map(|(i, (x, y))| {
            Wheel::powered(format!("w{i}"))
                .at(x, y)
                .radius(RADIUS_M)
                .ticks_per_turn(self.ticks_per_turn)
        });
        let robot = Robot::new("four".into(), wheels.collect()).unwrap();
        let settings = FilterSettings {
            horizon: 0.0,
            position_sigma: self.sigma,
            speed_sigma: self.sigma,
            reference_latency: self.late_s,
            dropout: self.dropout,
            ..FilterSettings::default()
        };
        let mut filter = SlipFilter::new(&robot, settings).unwrap();
        let mut noise = Noise::new(self.seed);
        let mut angles = [0.13, 0.37, 0.61, 0.89];
        let mut place = 0.0;
        let mut sent = Vec::new();
        let steps = (self.seconds / STEP_S).round() as i64;
        for step in 0..steps {
            let time_s = step as f64 * STEP_S;
            let time_ns = step * 10_000_000;
            let speed = (self.speed)(time_s);
            place += speed * STEP_S;
            for (angle, own) in angles.iter_mut().zip(OWN) {
                *angle += self.rate(time_s, own) * STEP_S;
            }
            if step % self.reference_steps == 0 {
                let error = self.sigma * noise.normal();
                let measurement = if self.has_poses {
                    let [x, y] = [place + error, self.sigma * noise.normal()];
                    Measurement::Pose { x, y, yaw: 0.0 }
                } else {
                    Measurement::Speed {
                        forward: speed + error,
                        left: None,
                    }
                };
                let late_ns = (self.late_s * 1e9).round() as i64;
                sent.push((time_ns + late_ns, measurement));
            }
            let mut send = |measurement| {
                filter
                    .update(Sample {
                        time_ns,
                        measurement,
                    })
                    .map(|_| ())
            };
            if step % self.row_steps == 0 {
                if self.has_accelerometer {
                    let gained = (self.speed)(time_s + STEP_S) - (self.speed)(time_s - STEP_S);
                    let forward = gained / (2.0 * STEP_S) + 0.03 + 0.1 * noise.normal();
                    send(Measurement::Acceleration { forward, left: 0.0 }).unwrap();
                }
                let rate = 0.002 * noise.normal();
                send(Measurement::YawRate { rate }).unwrap();
                for (wheel, angle) in angles.iter().enumerate() {
                    let turns = angle / core::f64::consts::TAU;
                    let raw = (turns * self.ticks_per_turn).floor() as u64;
                    let count = Measurement::WheelCount { wheel, raw };
                    let rate = self.rate(time_s, OWN[wheel]);
                    let rate = Measurement::WheelRate { wheel, rate };
                    send(if self.has_rates { rate } else { count }).unwrap();
                }
            }
            if sent.first().is_some_and(|(due, _)| *due <= time_ns) {
                send(sent.remove(0).1).unwrap();
            }
            if step % self.row_steps == 0 {
                let known = filter.latest();
                let truth = OWN.iter().map(|own| (self.slip)(time_s) + own);
                let slips = known.wheels.iter().map(|wheel| wheel.slip);
                let errors: Vec<f64> = slips
                    .zip(truth)
                    .filter_map(|(slip, truth)| Some(slip?.value() - truth))
                    .collect();
                each(time_s, &errors);
            }
        }
    }

    /// Root mean square error of all wheels' slips, and of their mean over the wheels, from `from_s` to `to_s`.
    fn rmse(&self, from_s: f64, to_s: f64) -> [f64; 2] {
        let (mut squares, mut count) = ([0.0; 2], 0.0);
        self.run(|time_s, errors| {
            if (from_s..to_s).contains(&time_s) && errors.len() == OWN.len() {
                let mean = errors.iter().sum::<f64>() / 4.0;
                squares[0] += errors.iter().map(|error| error * error).sum::<f64>() / 4.0;
                squares[1] += mean * mean;
                count += 1.0;
            }
        });
        assert!(count > 0.0);
        squares.map(|square| (square / count).sqrt())
    }
}

/// Starts at `at_s` (s) and reaches `top` (m/s) with a lag of 0.3 s.
fn start(time_s: f64, at_s: f64, top: f64) -> f64 {
    top * (1.0 - (-(time_s - at_s).max(0.0) / 0.3).exp())
}

/// A wheel's own slip is beside the rims' way of the same row. Where the first wheel of a row was compared with the others' ways of
/// the row before, carried on, a tick of 1.7 mm made 1.3 % of slip that all four wheels had in common.
#[test]
fn wheels_are_compared_with_the_rims_of_their_own_row() {
    for seed in 0..4 {
        let drive = Drive {
            seconds: 40.0,
            speed: &|time| start(time, 1.0, 0.8),
            slip: &|_| 0.05,
            ticks_per_turn: 360.0,
            row_steps: 5,
            reference_steps: 20,
            has_rates: false,
            dropout: 0.5,
            has_poses: false,
            sigma: 0.01,
            late_s: 0.0,
            has_accelerometer: false,
            seed,
        };
        let [all, mean] = drive.rmse(10.0, 40.0);
        println!("row by row: {all:.4} {mean:.4}");
        assert!(mean < 0.006, "{mean}");
    }
}

/// Root mean square error of the mean slip over twelve drives.
fn rmse_of_drives(drive: impl Fn(u64) -> [f64; 2]) -> f64 {
    let squares = (0..12).map(|seed| drive(seed)[1].powi(2));
    (squares.sum::<f64>() / 12.0).sqrt()
}

/// Speeds of a robot that stands say nothing of its slip: models whose speed is the rims' predict them best, and were alone at the
/// start.
#[test]
fn a_rest_does_not_decide_between_the_models() {
    let rmse = rmse_of_drives(|seed| {
        Drive {
            seconds: 22.0,
            speed: &|time| start(time, 20.0, 1.0),
            slip: &|_| 0.3,
            ticks_per_turn: 1000.0,
            row_steps: 1,
            reference_steps: 20,
            has_rates: false,
            dropout: 0.5,
            has_poses: false,
            sigma: 0.03,
            late_s: 0.0,
            has_accelerometer: true,
            seed,
        }
        .rmse(20.2, 21.0)
    });
    println!("after a rest: {rmse:.4}");
    assert!(rmse < 0.025, "{rmse}");
}

/// Slip changes with the ground under the rims, not while they stand: what was known before a rest holds after it.
#[test]
fn a_rest_does_not_change_the_slip() {
    let rmse = rmse_of_drives(|seed| {
        Drive {
            seconds: 63.0,
            speed: &|time| start(time, 1.0, 0.3) - start(time, 20.0, 0.3) + start(time, 60.0, 0.3),
            slip: &|_| 0.3,
            ticks_per_turn: 1000.0,
            row_steps: 1,
            reference_steps: 100,
            has_rates: false,
            dropout: 0.5,
            has_poses: true,
            sigma: 0.05,
            late_s: 0.0,
            has_accelerometer: false,
            seed,
        }
        .rmse(60.2, 62.0)
    });
    println!("after a rest of 40 s: {rmse:.4}");
    assert!(rmse < 0.03, "{rmse}");
}

/// A position that arrives late says nothing of the slip since it was taken. Carried back with a slip that had changed meanwhile,
/// it turned a jump to more slip into less slip.
#[test]
fn a_late_position_does_not_turn_a_jump_round() {
    let mut least: f64 = 1.0;
    for seed in 0..8 {
        let drive = Drive {
            seconds: 14.0,
            speed: &|time| start(time, 1.0, 1.6),
            slip: &|time| 0.05 + 0.45 * (1.0 - (-(time - 10.0).max(0.0) / 0.15).exp()),
            ticks_per_turn: 1000.0,
            row_steps: 1,
            reference_steps: 10,
            has_rates: false,
            dropout: 0.5,
            has_poses: true,
            sigma: 0.005,
            late_s: 0.1,
            has_accelerometer: false,
            seed,
        };
        drive.run(|time, errors| {
            if (10.0..12.0).contains(&time) {
                let truth = (drive.slip)(time);
                let mean = errors.iter().sum::<f64>() / 4.0;
                least = least.min(truth + mean);
            }
        });
    }
    println!("least slip after the jump: {least:.3}");
    assert!(least > -0.05, "{least}");
}

/// Wheels that are read less often than after the dropout time have slips at their rows. Their rims were led on for that time, then
/// not, and the next row was a step with the whole way since the last: the rims had run too far, and errors were 0.1 to 0.6.
#[test]
fn rows_beyond_the_dropout_time_lose_no_way() {
    let stops_and_goes = |time: f64| -> f64 {
        let speeds = [1.0, -1.0].into_iter().cycle().zip(0..8);
        speeds
            .map(|(top, i)| start(time, 5.0 * f64::from(i), top))
            .sum()
    };
    for (speed, has_rates, dropout, row_steps) in [
        (&stops_and_goes as &dyn Fn(f64) -> f64, false, 0.1, 15),
        (&stops_and_goes, false, 0.1, 30),
        (&|time| start(time, 1.0, 0.8), false, 0.5, 90),
        (&|time| start(time, 1.0, 0.8), true, 0.1, 15),
        (&|time| start(time, 1.0, 0.8), true, 0.1, 30),
        (&|time| start(time, 1.0, 0.8), true, 0.5, 90),
    ] {
        let rmse = rmse_of_drives(|seed| {
            Drive {
                seconds: 46.0,
                speed,
                slip: &|_| 0.2,
                ticks_per_turn: 1000.0,
                row_steps,
                reference_steps: 14,
                has_rates,
                dropout,
                has_poses: true,
                sigma: 0.01,
                late_s: 0.0,
                has_accelerometer: false,
                seed,
            }
            .rmse(6.0, 46.0)
        });
        println!(
            "rows after {row_steps} steps, dropout after {dropout} s, rates {has_rates}: {rmse:.4}"
        );
        assert!(rmse < 0.045, "{rmse}");
    }
}

/// Wheels that are read five times a second, and a reference between their rows. A reading was compared with rims led on at the
/// speed of the row before, which is no more where the robot starts or brakes.
#[test]
fn a_reference_between_rows_of_the_wheels_waits_for_the_next() {
    let rmse = rmse_of_drives(|seed| {
        Drive {
            seconds: 46.0,
            speed: &|time| {
                (0..8)
                    .map(|i| {
                        start(
                            time,
                            5.0 * f64::from(i),
                            if i % 2 == 0 { 1.0 } else { -1.0 },
                        )
                    })
                    .sum()
            },
            slip: &|_| 0.2,
            ticks_per_turn: 1000.0,
            row_steps: 20,
            reference_steps: 14,
            has_rates: false,
            dropout: 0.5,
            has_poses: true,
            sigma: 0.01,
            late_s: 0.0,
            has_accelerometer: false,
            seed,
        }
        .rmse(6.0, 46.0)
    });
    println!("rows at 5 Hz: {rmse:.4}");
    assert!(rmse < 0.015, "{rmse}");
}

/// Of a car: its axles' and half its wheels' distance, the radius of a wheel, m, and how far its front wheels are turned, rad.
const WHEELBASE_M: f64 = 1.2;
const HALF_TRACK_M: f64 = 0.5;
const CAR_RADIUS_M: f64 = 0.2;
const STEERING_RAD: f64 = 0.65;
const CAR: [(f64, f64); 4] = [
    (WHEELBASE_M, HALF_TRACK_M),
    (WHEELBASE_M, -HALF_TRACK_M),
    (0.0, HALF_TRACK_M),
    (0.0, -HALF_TRACK_M),
];

fn car() -> Robot {
    let wheel = |(i, (x, y))| {
        Wheel::powered(format!("w{i}"))
            .at(x, y)
            .radius(CAR_RADIUS_M)
    };
    Robot::new(
        "car".into(),
        CAR.into_iter().enumerate().map(wheel).collect(),
    )
    .unwrap()
}

/// At a step of [`STEP_S`].
fn send(filter: &mut SlipFilter, step: i64, measurement: Measurement) {
    let time_ns = step * 10_000_000;
    filter
        .update(Sample {
            time_ns,
            measurement,
        })
        .unwrap();
}

/// The turn of a car that is steered and does not slide, rad/m.
fn turn_per_m() -> f64 {
    STEERING_RAD.tan() / WHEELBASE_M
}

/// The angle of the wheel at a place of a car that is steered to turn by `steered`, rad, and how far the ground under it runs along it
/// for each metre of a car that turns by `turn`, both in rad/m.
fn along(place: (f64, f64), steered: f64, turn: f64) -> (f64, f64) {
    let ground = |turn: f64| (1.0 - turn * place.1, turn * place.0);
    let (x, y) = ground(steered);
    let angle = y.atan2(x);
    let (sin, cos) = angle.sin_cos();
    let (x, y) = ground(turn);
    (angle, x * cos + y * sin)
}

/// A car that slides straight on over its front wheels turns by half of what they show: with a gyro it is the gyro that counts.
#[test]
fn a_car_turns_as_its_gyro_shows_and_not_as_it_is_steered() {
    const SPEED_M_PER_S: f64 = 0.8;
    /// Of all wheels: enough that a turn by the rims is another one.
    const SLIP_SHARE: f64 = 0.2;
    const SIGMA_M: f64 = 0.02;
    let settings = FilterSettings {
        position_sigma: SIGMA_M,
        ..FilterSettings::default()
    };
    let mut filter = SlipFilter::new(&car(), settings).unwrap();
    let mut noise = Noise::new(11);
    let [mut x, mut y, mut yaw] = [0.0_f64; 3];
    for step in 0..1500_i64 {
        let time_s = step as f64 * STEP_S;
        let mut send = |measurement| send(&mut filter, step, measurement);
        // straight for a second
        let steered = if time_s < 1.0 { 0.0 } else { turn_per_m() };
        let turn = 0.5 * steered;
        x += SPEED_M_PER_S * STEP_S * yaw.cos();
        y += SPEED_M_PER_S * STEP_S * yaw.sin();
        yaw += SPEED_M_PER_S * STEP_S * turn;
        if step % 2 == 0 {
            let rate = turn * SPEED_M_PER_S + 0.002 * noise.normal();
            send(Measurement::YawRate { rate });
            for (wheel, place) in CAR.into_iter().enumerate() {
                let (angle, along) = along(place, steered, turn);
                send(Measurement::SteeringAngle { wheel, angle });
                let rate = along * SPEED_M_PER_S / (1.0 - SLIP_SHARE) / CAR_RADIUS_M;
                send(Measurement::WheelRate { wheel, rate });
            }
        }
        if step % 10 == 5 {
            let [x, y] = [x, y].map(|place| place + SIGMA_M * noise.normal());
            send(Measurement::Position { x, y });
        }
        if time_s > 8.0 {
            for wheel in filter.latest().wheels {
                let off = wheel.slip.unwrap().value() - SLIP_SHARE;
                assert!(off.abs() < 0.05, "{time_s}: {off}");
            }
        }
    }
}

/// A car that hardly moves in a bend has rims whose turn is not the robot's over its share in their speed: by that, the rims seemed
/// to run forwards when they turned back, and the slip stayed at 1 for as long as the bend.
#[test]
fn a_car_that_dug_in_backs_out_in_the_same_bend() {
    let settings = FilterSettings {
        speed_sigma: 0.02,
        ..FilterSettings::default()
    };
    let mut filter = SlipFilter::new(&car(), settings).unwrap();
    let mut noise = Noise::new(7);
    for step in 0..4000_i64 {
        let time_s = step as f64 * STEP_S;
        let mut send = |measurement| send(&mut filter, step, measurement);
        let (rim, slip) = if time_s < 2.0 {
            (0.0, 0.0)
        } else if time_s < 15.0 {
            (0.4, 0.3)
        } else if time_s < 25.0 {
            (0.5, 0.97)
        } else {
            (-0.15, 0.35)
        };
        let speed = rim * (1.0 - slip);
        if step % 2 == 0 {
            for (wheel, place) in CAR.into_iter().enumerate() {
                let (angle, along) = along(place, turn_per_m(), turn_per_m());
                send(Measurement::SteeringAngle { wheel, angle });
                let rate = along * rim / CAR_RADIUS_M + 0.005 * noise.normal();
                send(Measurement::WheelRate { wheel, rate });
            }
        }
        if step % 10 == 5 {
            send(Measurement::Speed {
                forward: speed + 0.02 * noise.normal(),
                left: None,
            });
        }
        if time_s > 28.0 {
            for wheel in filter.latest().wheels {
                let off = wheel.slip.unwrap().value() - slip;
                assert!(off.abs() < 0.2, "{time_s}: {off}");
            }
        }
    }
}

/// Share of the rows that are `Ok` of a drive of 60 s whose poses are missing for 1.5 s
/// in every 6 s; in each gap their frame jumps aside by `jump` (m).
fn share_next_to_gaps(jump: f64) -> f64 {
    let robot = Robot::new("four".into(), crate::four_wheels::four_wheels(1000)).unwrap();
    let settings = FilterSettings {
        position_sigma: 0.01,
        ..FilterSettings::default()
    };
    let mut filter = SlipFilter::new(&robot, settings).unwrap();
    let mut noise = Noise::new(3);
    let (mut ok, mut rows) = (0.0, 0.0);
    for step in 0..6000_i64 {
        let time_s = step as f64 * STEP_S;
        let mut send = |measurement| {
            let time_ns = step * 10_000_000;
            let sample = Sample {
                time_ns,
                measurement,
            };
            filter.update(sample).map(|_| ()).unwrap();
        };
        let speed = 0.5;
        let way = speed * (time_s - 1.0).max(0.0);
        if step % 2 == 0 {
            for wheel in 0..4 {
                let turns = way / 0.8 / RADIUS_M / core::f64::consts::TAU;
                let raw = (turns * 1000.0).floor() as u64;
                send(Measurement::WheelCount { wheel, raw });
            }
            send(Measurement::YawRate {
                rate: 0.002 * noise.normal(),
            });
        }
        let in_period = step % 600;
        if step % 10 == 0 && in_period >= 150 {
            let x = way + 0.01 * noise.normal();
            let y = jump * (step / 600) as f64 + 0.01 * noise.normal();
            let yaw = 0.01 * noise.normal();
            send(Measurement::Pose { x, y, yaw });
        }
        if time_s > 12.0 {
            let health = filter.latest().wheels[0].health;
            ok += f64::from(u8::from(health == Health::Ok));
            rows += 1.0;
        }
    }
    ok / rows
}

/// A reference that returns after a second and a half, with what the filter had predicted or elsewhere, is used again.
#[test]
fn a_reference_that_returns_after_a_gap_is_used_again() {
    for jump in [0.0, 2.0] {
        let ok = share_next_to_gaps(jump);
        println!("{jump} m: {ok:.2} are Ok");
        assert!(ok > 0.65, "{jump} m: {ok}");
    }
}
