//! Slips of a robot that winds its way beside a reference, a gyro and stamps that are not what they should be.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts and steps are small"
)]

use core::f64::consts::TAU;

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{Health, Invalid, Measurement, Motion, Robot, Sample, Wheel};

use crate::noise::Noise;

const STEP_S: f64 = 0.01;
const RADIUS_M: f64 = 0.1;
const TICKS_PER_TURN: f64 = 1000.0;
const PLACES: [(f64, f64); 4] = [(0.25, 0.3), (0.25, -0.3), (-0.25, 0.3), (-0.25, -0.3)];

/// What measures the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    Pose,
    Position,
    Speed,
}

/// A drive with fixed wheels; times in s.
struct Drive<'a> {
    /// The robot's speed (m/s), its yaw rate (rad/s), and the slip of all wheels.
    speed: &'a dyn Fn(f64) -> f64,
    turn: &'a dyn Fn(f64) -> f64,
    slip: &'a dyn Fn(f64) -> f64,
    by: By,
    /// By how much the reference's frame lies to the left of the robot, m.
    jump: &'a dyn Fn(f64) -> f64,
    sigma: f64,
    /// rad/s, by time.
    gyro_bias: &'a dyn Fn(f64) -> f64,
    gyro_scale: f64,
    /// Standard deviation of the stamps of the wheels about the moment of reading, s.
    jitter_s: f64,
    row_steps: i64,
    seed: u64,
}

impl Default for Drive<'_> {
    fn default() -> Self {
        Self {
            speed: &|t| {
                if t < 3.0 {
                    0.0
                } else {
                    0.6_f64.min(0.5 * (t - 3.0))
                }
            },
            turn: &|t| {
                if t < 5.0 {
                    0.0
                } else {
                    0.3 * (0.2 * TAU * t).sin()
                }
            },
            slip: &|t| if (t * 0.1).fract() < 0.5 { 0.08 } else { 0.25 },
            by: By::Pose,
            jump: &|_| 0.0,
            sigma: 0.01,
            gyro_bias: &|_| 0.002,
            gyro_scale: 1.0,
            jitter_s: 0.0,
            row_steps: 2,
            seed: 1,
        }
    }
}

/// How a drive ended.
#[derive(Debug, Default)]
struct Outcome {
    /// Root mean square error of all slips that are Ok.
    rmse: f64,
    /// The longest time in which a wheel was Ok and wrong by more than four sigma, s.
    lie_s: f64,
    /// The share of readings that are Ok.
    ok: f64,
    /// The shares at which the robot is said to stand, and the wheels to contradict the reference.
    stands: f64,
    contradicts: f64,
}

impl Drive<'_> {
    fn filter(&self) -> SlipFilter {
        let wheels = PLACES.into_iter().enumerate().map(|(i, (x, y))| {
            Wheel::powered(format!("w{i}"))
                .at(x, y)
                .radius(RADIUS_M)
                .ticks_per_turn(TICKS_PER_TURN)
        });
        let robot = Robot::new("four".into(), wheels.collect()).unwrap();
        let settings = FilterSettings {
            horizon: 0.0,
            position_sigma: self.sigma,
            speed_sigma: self.sigma,
            ..FilterSettings::any_ground()
        };
        SlipFilter::new(&robot, settings).unwrap()
    }

    /// What is said from one time to another.
    fn run(&self, seconds: f64, (from_s, to_s): (f64, f64)) -> Outcome {
        let mut filter = self.filter();
        let mut noise = Noise::new(self.seed);
        let mut angles = [0.13, 0.37, 0.61, 0.89];
        let [mut x, mut y, mut yaw] = [3.0, -2.0, 0.7];
        let mut aside = [0.0; 2];
        let mut stamp_ns = i64::MIN;
        let (mut squares, mut ok, mut all) = (0.0, 0.0, 0.0);
        let (mut stands, mut contradicts) = (0.0, 0.0);
        let (mut lie_s, mut lies) = (0.0_f64, [0.0; 4]);
        for step in 0..(seconds / STEP_S).round() as i64 {
            let time_s = step as f64 * STEP_S;
            let (speed, turn, slip) = (
                (self.speed)(time_s),
                (self.turn)(time_s),
                (self.slip)(time_s),
            );
            let middle = yaw + 0.5 * turn * STEP_S;
            x += middle.cos() * speed * STEP_S;
            y += middle.sin() * speed * STEP_S;
            yaw += turn * STEP_S;
            let share = if slip < 0.0 {
                1.0 + slip
            } else {
                1.0 / (1.0 - slip)
            };
            for (angle, (_, left)) in angles.iter_mut().zip(PLACES) {
                *angle += (speed - turn * left) * share / RADIUS_M * STEP_S;
            }
            let jumped = (self.jump)(time_s) - (self.jump)(time_s - STEP_S);
            aside[0] -= yaw.sin() * jumped;
            aside[1] += yaw.cos() * jumped;
            let mut send = |time_ns, measurement| {
                let sample = Sample {
                    time_ns,
                    measurement,
                };
                filter.update(sample).map(|_| ()).unwrap();
            };
            let now_ns = step * 10_000_000;
            let rate = self.gyro_scale * turn + (self.gyro_bias)(time_s) + 0.003 * noise.normal();
            stamp_ns = stamp_ns.max(now_ns);
            send(stamp_ns, Measurement::YawRate { rate });
            if step % 10 == 0 {
                let [a, b, c] = [(); 3].map(|()| self.sigma * noise.normal());
                let (x, y) = (x + aside[0] + a, y + aside[1] + b);
                send(
                    stamp_ns,
                    match self.by {
                        By::Pose => Measurement::Pose { x, y, yaw: yaw + c },
                        By::Position => Measurement::Position { x, y },
                        By::Speed => Measurement::Speed {
                            forward: speed + c,
                            left: None,
                        },
                    },
                );
            }
            if step % self.row_steps != 0 {
                continue;
            }
            let late_ns = (self.jitter_s * noise.normal() * 1e9) as i64;
            stamp_ns = (stamp_ns + 2_000_000).max(now_ns + late_ns);
            for (wheel, angle) in angles.iter().enumerate() {
                let raw = (angle / TAU * TICKS_PER_TURN).floor() as i64 as u64;
                send(stamp_ns, Measurement::WheelCount { wheel, raw });
            }
            if !(from_s..to_s).contains(&time_s) {
                continue;
            }
            for (estimate, lie) in filter.latest().wheels.iter().zip(&mut lies) {
                all += 1.0;
                stands += f64::from(u8::from(
                    estimate.health == Health::Ok && estimate.motion == Some(Motion::Standstill),
                ));
                let is_wrong = estimate.health == Health::Invalid(Invalid::Inconsistent);
                contradicts += f64::from(u8::from(is_wrong));
                let Some(known) = estimate.slip.filter(|_| estimate.health == Health::Ok) else {
                    *lie = 0.0;
                    continue;
                };
                ok += 1.0;
                let error = known.value() - slip;
                squares += error * error;
                let is_far = error.abs() > 4.0 * estimate.sigma.unwrap_or(0.0);
                *lie = if is_far {
                    *lie + self.row_steps as f64 * STEP_S
                } else {
                    0.0
                };
                lie_s = lie_s.max(*lie);
            }
        }
        Outcome {
            rmse: (squares / f64::max(ok, 1.0)).sqrt(),
            lie_s,
            ok: ok / all,
            stands: stands / all,
            contradicts: contradicts / all,
        }
    }
}

/// A loop closure of a map moves the pose to one side; its yaw remains right. The course from the last pose before it to the first
/// ones after it is not the robot's.
#[test]
fn a_jump_to_the_side_turns_no_heading() {
    for metres in [0.1, 0.2, 0.3, 0.4, 1.0] {
        for seed in 0..4 {
            let jump =
                |t: f64| metres * (f64::from(u8::from(t > 21.3)) + f64::from(u8::from(t > 34.7)));
            let drive = Drive {
                jump: &jump,
                seed,
                ..Drive::default()
            };
            let out = drive.run(70.0, (30.0, 70.0));
            assert!(
                out.rmse < 0.06 && out.lie_s < 1.0 && out.ok > 0.7,
                "{metres} m: {out:?}"
            );
        }
    }
}

/// A measured yaw outlasts any gyro: one with a bias far beyond the settings', from the start or from a moment on, or with another
/// scale.
#[test]
fn a_gyro_with_another_bias_or_scale_does_not_overrule_a_measured_yaw() {
    for (before, after, gyro_scale) in [
        (0.05, 0.05, 1.0),
        (-0.1, -0.1, 1.0),
        (0.002, 0.05, 1.0),
        (0.0, -0.03, 1.0),
        (0.0, 0.0, 1.1),
        (0.0, 0.0, 0.9),
    ] {
        for seed in 0..4 {
            let bias = |t: f64| if t < 30.0 { before } else { after };
            let drive = Drive {
                gyro_bias: &bias,
                gyro_scale,
                seed,
                ..Drive::default()
            };
            let out = drive.run(70.0, (15.0, 70.0));
            assert!(
                out.rmse < 0.06 && out.lie_s < 1.0 && out.ok > 0.85,
                "bias {before} and {after}, scale {gyro_scale}: {out:?}"
            );
        }
    }
}

/// Places without a heading tell slip as well as poses do, whatever the bias of the gyro.
#[test]
fn places_without_a_heading_are_positions() {
    for gyro_bias in [0.0, 0.02, 0.05] {
        for seed in 0..4 {
            let drive = Drive {
                by: By::Position,
                gyro_bias: &|_| gyro_bias,
                seed,
                ..Drive::default()
            };
            let out = drive.run(70.0, (20.0, 70.0));
            assert!(
                out.rmse < 0.06 && out.lie_s < 1.0 && out.ok > 0.9,
                "bias {gyro_bias}: {out:?}"
            );
        }
    }
}

/// A computer without real time stamps the counts when it gets to them.
#[test]
fn stamps_that_scatter_are_no_slip() {
    let rmse = |jitter_s: f64| {
        let runs = (0..4).map(|seed| {
            let drive = Drive {
                jitter_s,
                seed,
                ..Drive::default()
            };
            drive.run(60.0, (10.0, 60.0)).rmse
        });
        runs.sum::<f64>() / 4.0
    };
    let (steady, scattered) = (rmse(0.0), rmse(0.008));
    assert!(scattered < 1.1 * steady, "{steady:.4} {scattered:.4}");
}

/// The wheels brake and skid: the rims all but stand, and the robot does not. A speed that says so again and again is right.
#[test]
fn a_skid_is_seen_by_a_speed_over_ground() {
    let skids = |t: f64| (20.0..24.0).contains(&t);
    let slip = |t: f64| if skids(t) { -0.9 } else { 0.04 };
    let speed = |t: f64| if skids(t) { 0.4 } else { 0.5 };
    for seed in 0..4 {
        let drive = Drive {
            by: By::Speed,
            speed: &speed,
            slip: &slip,
            turn: &|_| 0.0,
            sigma: 0.03,
            seed,
            ..Drive::default()
        };
        let out = drive.run(24.0, (20.0, 24.0));
        assert!(out.lie_s < 1.0, "{out:?}");
        let late = drive.run(24.0, (22.0, 24.0));
        assert!(late.rmse < 0.1 && late.ok > 0.9, "{late:?}");
    }
}

/// A robot that is towed with its wheels locked does not stand.
#[test]
fn a_robot_that_slides_on_locked_wheels_does_not_stand() {
    let slides = |t: f64| (20.0..32.0).contains(&t);
    let slip = |t: f64| if slides(t) { -1.0 } else { 0.04 };
    let speed = |t: f64| if slides(t) { 0.3 } else { 0.5 };
    for by in [By::Pose, By::Position, By::Speed] {
        let drive = Drive {
            by,
            speed: &speed,
            slip: &slip,
            turn: &|_| 0.0,
            ..Drive::default()
        };
        let out = drive.run(32.0, (21.5, 32.0));
        assert!(out.stands < 0.1 && out.contradicts > 0.8, "{by:?}: {out:?}");
    }
    // and one that rests does
    let speed = |t: f64| if t < 20.0 { 0.5 } else { 0.0 };
    for by in [By::Pose, By::Position, By::Speed] {
        let drive = Drive {
            by,
            speed: &speed,
            turn: &|_| 0.0,
            ..Drive::default()
        };
        let out = drive.run(32.0, (22.0, 32.0));
        assert!(out.stands > 0.9, "{by:?}: {out:?}");
    }
}
