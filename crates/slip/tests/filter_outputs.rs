//! What the filter says of the robot as a whole, on robots whose motion is known in closed form: side slip angles, place with
//! its covariance, way without compensation; a skid-steered robot in a bend, one with omni wheels that drives sideways.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test fails by panicking and may say what it measured; counts are small"
)]

use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::{CounterWidth, Encoder, Health, Measurement, Robot, Sample, Wheel, WheelRole};
use grouser_terra::Angle;

use crate::noise::Noise;

const STEP_NS: i64 = 10_000_000;
const STEP: f64 = 0.01;
const TICKS: f64 = 2000.0;
const RADIUS: f64 = 0.1;

fn wheel(wheel: Wheel, (x, y): (f64, f64), heading_deg: f64) -> Wheel {
    wheel
        .at(x, y)
        .heading(Angle::from_deg(heading_deg))
        .radius(RADIUS)
        .encoder(Encoder::counting(TICKS).counter(CounterWidth::new(32).unwrap()))
}

/// A robot that goes at (v_x, v_y, Ω) from one second on, its powered wheels with these slips.
struct Run {
    robot: Robot,
    velocity: [f64; 3],
    slips: Vec<f64>,
    seconds: f64,
}

/// The motion at a time: rest for a second, then up to speed within one.
fn share(time: f64) -> f64 {
    (time - 1.0).clamp(0.0, 1.0)
}

/// Place and heading of the truth.
#[derive(Clone, Copy, Debug, Default)]
struct Pose {
    x: f64,
    y: f64,
    yaw: f64,
    /// Way along its own forward direction.
    way: f64,
}

impl Run {
    fn go(&self, seed: u64, mut each: impl FnMut(&SlipFilter, f64, Pose)) {
        let mut noise = Noise::new(seed);
        let settings = FilterSettings {
            slip: SlipPrior {
                mean: 0.1,
                sigma: 0.2,
            },
            ..FilterSettings::default()
        };
        let mut filter = SlipFilter::new(&self.robot, settings).unwrap();
        let mut turned = vec![0.0_f64; self.robot.wheels().len()];
        let mut poses = vec![Pose::default()];
        let mut pose = Pose::default();
        let last = (self.seconds / STEP).round() as i64;
        for row in 0..last {
            let time_ns = row * STEP_NS;
            let mut say = |measurement| {
                let _ = filter.update(Sample {
                    time_ns,
                    measurement,
                });
            };
            for (wheel, travel) in turned.iter().enumerate() {
                let ticks = travel / (core::f64::consts::TAU * RADIUS) * TICKS;
                let raw = ticks.floor() as i64 as u64;
                say(Measurement::WheelCount { wheel, raw });
            }
            let now = share(row as f64 * STEP + 0.5 * STEP);
            let [v_x, v_y, turn] = self.velocity.map(|v| v * now);
            say(Measurement::YawRate {
                rate: turn + 0.003 * noise.normal(),
            });
            let seen = filter.latest();
            let then = (seen.time_ns / STEP_NS) as usize;
            each(
                &filter,
                then as f64 * STEP,
                poses[then.min(poses.len() - 1)],
            );
            for ((travel, wheel), slip) in
                turned.iter_mut().zip(self.robot.wheels()).zip(&self.slips)
            {
                let row = wheel.speed_row();
                *travel += (row[0] * v_x + row[1] * v_y + row[2] * turn) / (1.0 - slip) * STEP;
            }
            let middle = pose.yaw + 0.5 * turn * STEP;
            pose.x += (middle.cos() * v_x - middle.sin() * v_y) * STEP;
            pose.y += (middle.sin() * v_x + middle.cos() * v_y) * STEP;
            pose.yaw += turn * STEP;
            pose.way += v_x * STEP;
            poses.push(pose);
        }
    }

    /// The side slip angle of a wheel under way, from v + Ω × p.
    fn side_slip(&self, wheel: usize) -> f64 {
        let wheel = &self.robot.wheels()[wheel];
        let [v_x, v_y, turn] = self.velocity;
        let (x, y) = (v_x - turn * wheel.y, v_y + turn * wheel.x);
        let off = y.atan2(x) - wheel.heading.rad();
        off.sin().atan2(off.cos())
    }
}

fn skid_steered() -> Run {
    let (front, rear) = (0.3, -0.3);
    Run {
        robot: Robot::new(
            "skid-steered".into(),
            vec![
                wheel(Wheel::powered("front left"), (front, 0.25), 0.0),
                wheel(Wheel::powered("front right"), (front, -0.25), 0.0),
                wheel(Wheel::powered("rear left"), (rear, 0.25), 0.0),
                wheel(Wheel::powered("rear right"), (rear, -0.25), 0.0),
                wheel(Wheel::free("free"), (0.0, 0.1), 0.0),
            ],
        )
        .unwrap(),
        velocity: [0.3, 0.0, 0.2],
        slips: vec![0.15, 0.2, 0.1, 0.15, 0.0],
        seconds: 30.0,
    }
}

/// Three omni wheels about the robot and two free ones along and across it; it drives ahead and to the left at once, turning.
fn omni() -> Run {
    let place = |deg: f64| {
        let (sin, cos) = deg.to_radians().sin_cos();
        (0.25 * cos, 0.25 * sin)
    };
    Run {
        robot: Robot::new(
            "omni".into(),
            vec![
                wheel(Wheel::powered("a"), place(60.0), 150.0),
                wheel(Wheel::powered("b"), place(180.0), 270.0),
                wheel(Wheel::powered("c"), place(300.0), 30.0),
                wheel(Wheel::free("along"), (0.0, 0.1), 0.0),
                wheel(Wheel::free("across"), (-0.1, 0.0), 90.0),
            ],
        )
        .unwrap(),
        velocity: [0.25, 0.15, 0.1],
        slips: vec![0.1, 0.1, 0.2, 0.0, 0.0],
        seconds: 30.0,
    }
}

#[test]
fn side_slip_angles_are_those_of_the_motion() {
    for run in [skid_steered(), omni()] {
        let (mut squares, mut scaled, mut count) = (0.0, 0.0, 0.0_f64);
        run.go(1, |filter, time, _| {
            let known = filter.latest();
            if time < 1.0 {
                // at rest there is none
                assert!((0..known.wheels.len()).all(|i| known.side_slip_angle(i).is_none()));
            }
            if time < 4.0 {
                return;
            }
            assert!(known.side_slip_angle(known.wheels.len()).is_none());
            for wheel in 0..known.wheels.len() {
                let angle = known.side_slip_angle(wheel).unwrap();
                let off = angle.value - run.side_slip(wheel);
                squares += off * off;
                scaled += off * off / angle.variance;
                count += 1.0;
                assert!(off.abs() < 6.0 * angle.sigma(), "{time} {wheel}: {off}");
            }
        });
        println!(
            "{}: side slip angles to {:.4} rad, squared error over variance {:.2}",
            run.robot.name(),
            (squares / count).sqrt(),
            scaled / count
        );
        // two thirds of a degree
        assert!((squares / count).sqrt() < 0.012 && scaled / count < 1.5);
    }
}

#[test]
fn slips_of_skid_steered_and_omni_robots_are_found_in_a_bend() {
    for run in [skid_steered(), omni()] {
        let (mut squares, mut count, mut ok, mut wrong) = (0.0, 0.0_f64, 0.0, 0.0);
        run.go(2, |filter, time, _| {
            let known = filter.latest();
            for (wheel, estimate) in known.wheels.iter().enumerate().take(run.slips.len() - 1) {
                let free = run.robot.wheels()[wheel].role == WheelRole::Free;
                let fast = estimate.rim_speed.is_some_and(|rim| rim.value.abs() > 0.1);
                if time < 4.0 || free || !fast {
                    continue;
                }
                let off = estimate.slip.unwrap().value() - run.slips[wheel];
                let sigma = estimate.sigma.unwrap();
                wrong += f64::from(u8::from(off.abs() > 4.0 * sigma));
                ok += f64::from(u8::from(estimate.health == Health::Ok));
                squares += off * off;
                count += 1.0;
            }
        });
        println!(
            "{}: slips to {:.4}, {:.3} beyond four sigma",
            run.robot.name(),
            (squares / count).sqrt(),
            wrong / count
        );
        // two of the omni robot's wheels run at .13 m/s only, and slip unlike the others
        let most = if run.robot.name() == "omni" {
            0.15
        } else {
            0.03
        };
        assert!(count > 1000.0 && (squares / count).sqrt() < most);
        assert!(ok > 0.9 * count, "{ok} of {count}");
        // where the slips of an omni robot's wheels differ, its direction of travel is known less well than its sigmas say
        assert!(
            wrong
                < if run.robot.name() == "omni" {
                    0.4
                } else {
                    0.01
                } * count
        );
    }
}

/// Over runs with the gyro's bias and the free wheel's skid drawn from what the filter is configured with.
#[test]
fn the_place_is_within_its_covariance_and_that_grows() {
    for run in [skid_steered(), omni()] {
        let (mut nees, mut count) = (0.0, 0.0);
        let mut last = None;
        for seed in 0..20 {
            let mut noise = Noise::new(100 + seed);
            let mut run = Run {
                robot: run.robot.clone(),
                slips: run.slips.clone(),
                ..run
            };
            for (slip, wheel) in run.slips.iter_mut().zip(run.robot.wheels()) {
                if wheel.role == WheelRole::Free {
                    // as the skid of its prior, 1 %
                    *slip = 0.01 * noise.normal();
                }
            }
            let mut sigma = 0.0;
            run.go(seed, |filter, _, truth| {
                let place = filter.latest().body.odometry;
                last = Some((place, truth));
                let [[xx, xy, _], [yx, yy, _], _] = place.covariance;
                assert!((xy - yx).abs() <= 1e-9 * (xx + yy) && xx >= 0.0 && yy >= 0.0);
                sigma = (xx + yy).sqrt();
            });
            let (place, truth) = last.unwrap();
            let [[xx, xy, _], [_, yy, _], _] = place.covariance;
            let (dx, dy) = (place.x - truth.x, place.y - truth.y);
            let inside = xx * yy - xy * xy;
            nees += 0.5 * (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / inside;
            count += 1.0;
            assert!(sigma > 0.01, "it grows: {sigma}");
        }
        let nees = nees / count;
        println!(
            "{}: place, squared error over variance {nees:.2}",
            run.robot.name()
        );
        // a mean of 20 χ² of 2, each halved: 95 % of them lie below 1.4; cautious is allowed. The model knows one direction of travel:
        // what each wheel of an omnidirectional robot slips on its own moves its place as well, and is not in the covariance
        let most = if run.robot.name() == "omni" { 8.0 } else { 1.4 };
        assert!(nees < most, "{nees}");
    }
}

#[test]
fn the_way_without_compensation_stands_beside_it() {
    let run = skid_steered();
    let mut last = None;
    run.go(3, |filter, _, truth| {
        let body = filter.latest().body;
        last = Some((body.distance, body.distance_of_wheels, truth.way));
    });
    let (distance, of_wheels, truth) = last.unwrap();
    println!("way {truth:.3} m: {distance:.3}, by the wheels alone {of_wheels:.3}");
    assert!((distance / truth - 1.0).abs() < 0.02);
    // the mean of v_i/(1 − s_i) over v is 1.18 here; in a bend the sides' slips count a little otherwise
    let expected = run.slips[..4].iter().map(|s| 0.25 / (1.0 - s)).sum::<f64>();
    assert!((of_wheels / truth - expected).abs() < 0.01, "{expected}");
}

#[test]
fn r8_time_slip_dropped_and_rejected_are_counted() {
    let run = skid_steered();
    let mut filter = SlipFilter::new(&run.robot, FilterSettings::default()).unwrap();
    let wheels = run.robot.wheels().len();
    let gyro = |rate| Measurement::YawRate { rate };
    let mut say = |row: i64, measurement| {
        let sample = Sample {
            time_ns: row * STEP_NS,
            measurement,
        };
        let refused = filter.update(sample).is_err();
        let known = filter.latest();
        (
            refused,
            known.time_slip,
            known.dropped,
            known.rejected.total(),
        )
    };
    for row in 0..50 {
        for wheel in 0..wheels {
            let measurement = Measurement::WheelCount { wheel, raw: 0 };
            say(row, measurement);
        }
        say(row, gyro(0.0));
    }
    let (_, behind, dropped, rejected) = say(50, gyro(0.0));
    // the horizon, and the step that is not over
    assert!(
        (0.02..0.02 + 1.5 * SlipFilter::STEP_S).contains(&behind),
        "{behind}"
    );
    assert!(dropped == 0 && rejected == 0);
    // 51 to 54 never came; 30 comes far too late; NaN is none
    assert_eq!(say(55, gyro(0.0)).2, 4);
    assert!(say(30, gyro(0.0)).0);
    say(56, gyro(f64::NAN));
    say(60, gyro(0.0));
    let (_, _, _, rejected) = say(61, gyro(0.0));
    assert_eq!(rejected, 2);
}
