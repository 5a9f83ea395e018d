//! Slips of a robot that winds its way beside a reference, a gyro and stamps that are not what they should be.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts and steps are small"
)]

use core::f64::consts::TAU;

use grouser_slip::filter::{FilterOutput, FilterSettings, SlipFilter};
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

/// How the errors of poses depend on one another, in m and s.
#[derive(Clone, Copy, Debug)]
enum PoseErrors {
    /// Each has its own.
    Independent,
    /// Those of a map or a tracker wander: standard deviation and memory, beside a third of the drive's own.
    Wandering(f64, f64),
    /// A tracker's filter with this memory.
    Filtered(f64),
    /// Taken up to this much earlier than stamped.
    Late(f64),
    /// To a multiple of this.
    Rounded(f64),
    /// Held up for this long in every four seconds; then all come at once.
    HeldUp(f64),
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
    /// The rims' turn over the robot's: wheels that skid sideways turn faster.
    rim_turn: f64,
    /// By how much the wheels on the left slip more.
    left_slip: f64,
    has_gyro: bool,
    /// rad/s, by time.
    gyro_bias: &'a dyn Fn(f64) -> f64,
    gyro_scale: f64,
    /// Standard deviation of the stamps of the wheels about the moment of reading, s.
    jitter_s: f64,
    row_steps: i64,
    ticks_per_turn: f64,
    /// Does a driver make rates of the ticks?
    by_rates: bool,
    errors: PoseErrors,
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
            rim_turn: 1.0,
            left_slip: 0.0,
            has_gyro: true,
            gyro_bias: &|_| 0.002,
            gyro_scale: 1.0,
            jitter_s: 0.0,
            row_steps: 2,
            ticks_per_turn: TICKS_PER_TURN,
            by_rates: false,
            errors: PoseErrors::Independent,
            seed: 1,
        }
    }
}

/// How a drive ended.
#[derive(Debug, Default)]
struct Outcome {
    /// Root mean square error of all slips that are Ok; of all slips; and that of the way of the poses over that of the rims within the last second, with
    /// the true heading.
    rmse: f64,
    whole_rmse: f64,
    naive: f64,
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
            let wheel = Wheel::powered(format!("w{i}")).at(x, y).radius(RADIUS_M);
            if self.by_rates {
                wheel
            } else {
                wheel.ticks_per_turn(self.ticks_per_turn)
            }
        });
        let robot = Robot::new("four".into(), wheels.collect()).unwrap();
        let settings = FilterSettings {
            horizon: 0.0,
            position_sigma: self.sigma,
            speed_sigma: self.sigma,
            ..FilterSettings::default()
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
        let mut ticks_before = [None; 4];
        let mut queue = Vec::new();
        let mut reference = Reference::default();
        let mut stamp_ns = i64::MIN;
        let mut score = Score::default();
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
            let mut slips = [slip; 4];
            for ((angle, own), (_, left)) in angles.iter_mut().zip(&mut slips).zip(PLACES) {
                *own += if left > 0.0 { self.left_slip } else { 0.0 };
                let share = if *own < 0.0 {
                    1.0 + *own
                } else {
                    1.0 / (1.0 - *own)
                };
                let rim = (speed - self.rim_turn * turn * left) * share;
                *angle += rim / RADIUS_M * STEP_S;
                let along = speed - turn * left;
                if rim.abs().max(along.abs()) > 0.0 {
                    *own = (rim - along) / rim.abs().max(along.abs()) * rim.signum();
                }
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
            if self.has_gyro {
                send(stamp_ns, Measurement::YawRate { rate });
            }
            if step % 10 == 0 {
                let c = self.sigma * noise.normal();
                let true_pose = [x + aside[0], y + aside[1]];
                let way = core::array::from_fn(|i| {
                    (angles[i] / TAU * self.ticks_per_turn).floor() * TAU / self.ticks_per_turn
                });
                let [x, y] = reference.read(self, (true_pose, yaw), way, &mut noise);
                queue.push(match self.by {
                    By::Pose => Measurement::Pose { x, y, yaw: yaw + c },
                    By::Position => Measurement::Position { x, y },
                    By::Speed => Measurement::Speed {
                        forward: speed + c,
                        left: None,
                    },
                });
                let is_held_up =
                    matches!(self.errors, PoseErrors::HeldUp(time) if time_s % 4.0 < time - 0.05);
                if !is_held_up {
                    for measurement in queue.drain(..) {
                        send(stamp_ns, measurement);
                    }
                }
            }
            if step % self.row_steps != 0 {
                continue;
            }
            let late_ns = (self.jitter_s * noise.normal() * 1e9) as i64;
            stamp_ns = (stamp_ns + 2_000_000).max(now_ns + late_ns);
            for (wheel, angle) in angles.iter().enumerate() {
                let ticks = (angle / TAU * self.ticks_per_turn).floor();
                let before = ticks_before[wheel].replace(ticks).unwrap_or(ticks);
                send(stamp_ns, self.rotation(wheel, ticks, before));
            }
            if !(from_s..to_s).contains(&time_s) {
                continue;
            }
            for (wheel, (_, left)) in PLACES.into_iter().enumerate() {
                if let Some(mean) = reference.mean_slip(wheel, left) {
                    score.naive.add(mean - slips[wheel]);
                }
            }
            score.add(&filter.latest(), slips, self.row_steps as f64 * STEP_S);
        }
        score.outcome()
    }

    /// What the sensor of a wheel says of its ticks.
    fn rotation(&self, wheel: usize, ticks: f64, before: f64) -> Measurement {
        if !self.by_rates {
            let raw = ticks as i64 as u64;
            return Measurement::WheelCount { wheel, raw };
        }
        let period_s = self.row_steps as f64 * STEP_S;
        let rate = (ticks - before) * TAU / self.ticks_per_turn / period_s;
        Measurement::WheelRate { wheel, rate }
    }
}

/// The root mean square of numbers.
#[derive(Clone, Copy, Default)]
struct Rms {
    squares: f64,
    count: f64,
}

impl Rms {
    fn add(&mut self, x: f64) {
        self.squares += x * x;
        self.count += 1.0;
    }

    fn value(self) -> f64 {
        (self.squares / self.count.max(1.0)).sqrt()
    }
}

/// What was said, against the truth.
#[derive(Default)]
struct Score {
    ok: Rms,
    whole: Rms,
    naive: Rms,
    all: f64,
    stands: f64,
    contradicts: f64,
    lie_s: f64,
    lies: [f64; 4],
}

impl Score {
    /// Adds the estimates of a row of `period_s`.
    fn add(&mut self, estimates: &FilterOutput<'_>, slips: [f64; 4], period_s: f64) {
        let lies = self.lies.iter_mut().zip(slips);
        for (estimate, (lie, slip)) in estimates.wheels.iter().zip(lies) {
            self.all += 1.0;
            let is_ok = estimate.health == Health::Ok;
            let stands = is_ok && estimate.motion == Some(Motion::Standstill);
            self.stands += f64::from(u8::from(stands));
            let is_wrong = estimate.health == Health::Invalid(Invalid::Inconsistent);
            self.contradicts += f64::from(u8::from(is_wrong));
            if let Some(known) = estimate.slip {
                self.whole.add(known.value() - slip);
            }
            let Some(known) = estimate.slip.filter(|_| is_ok) else {
                *lie = 0.0;
                continue;
            };
            let error = known.value() - slip;
            self.ok.add(error);
            let is_far = error.abs() > 4.0 * estimate.sigma.unwrap_or(0.0);
            *lie = if is_far { *lie + period_s } else { 0.0 };
            self.lie_s = self.lie_s.max(*lie);
        }
    }

    fn outcome(&self) -> Outcome {
        Outcome {
            rmse: self.ok.value(),
            whole_rmse: self.whole.value(),
            naive: self.naive.value(),
            lie_s: self.lie_s,
            ok: self.ok.count / self.all,
            stands: self.stands / self.all,
            contradicts: self.contradicts / self.all,
        }
    }
}

/// The poses as they are measured, ten a second.
#[derive(Default)]
struct Reference {
    error: Option<[f64; 2]>,
    /// What was measured of the last second: place, true heading, and the angles by whole ticks.
    kept: Vec<([f64; 3], [f64; 4])>,
    true_places: Vec<[f64; 2]>,
}

impl Reference {
    fn read(
        &mut self,
        drive: &Drive<'_>,
        (place, yaw): ([f64; 2], f64),
        angles: [f64; 4],
        noise: &mut Noise,
    ) -> [f64; 2] {
        let mut normal = |sigma: f64| [0; 2].map(|_| sigma * noise.normal());
        let own = normal(drive.sigma);
        let with = |error: [f64; 2]| [place[0] + error[0], place[1] + error[1]];
        self.true_places.push(place);
        let measured = match drive.errors {
            PoseErrors::Independent | PoseErrors::HeldUp(_) => with(own),
            PoseErrors::Wandering(sigma, memory_s) => {
                let step = normal(sigma);
                let before = self.error.unwrap_or(step);
                let kept = (-0.1 / memory_s).exp();
                let error = [0, 1].map(|i| kept * before[i] + (1.0 - kept * kept).sqrt() * step[i]);
                self.error = Some(error);
                with([0, 1].map(|i| error[i] + own[i] / 3.0))
            }
            PoseErrors::Filtered(memory_s) => {
                let rough = with(own);
                let before = self.error.unwrap_or(rough);
                let new = 0.1 / (0.1 + memory_s);
                let smooth = [0, 1].map(|i| before[i] + new * (rough[i] - before[i]));
                self.error = Some(smooth);
                smooth
            }
            PoseErrors::Late(most_s) => {
                // between the places of the last tenths of a second
                let late = most_s * 10.0 * noise.uniform();
                let count = self.true_places.len();
                let back = (late as usize).min(count - 1);
                let [newer, older] =
                    [back, (back + 1).min(count - 1)].map(|i| self.true_places[count - 1 - i]);
                let share = late.fract();
                [0, 1].map(|i| newer[i] + share * (older[i] - newer[i]) + own[i])
            }
            PoseErrors::Rounded(step) => place.map(|x| (x / step).round() * step),
        };
        self.kept.push(([measured[0], measured[1], yaw], angles));
        if self.kept.len() > 11 {
            self.kept.remove(0);
        }
        measured
    }

    /// The slip of a wheel over the last second.
    fn mean_slip(&self, wheel: usize, left: f64) -> Option<f64> {
        let (from, to) = (self.kept.first()?, self.kept.last()?);
        let ([x0, y0, yaw0], [x1, y1, yaw1]) = (from.0, to.0);
        let heading = 0.5 * (yaw0 + yaw1);
        let robot = heading.cos() * (x1 - x0) + heading.sin() * (y1 - y0) - left * (yaw1 - yaw0);
        let rim = RADIUS_M * (to.1[wheel] - from.1[wheel]);
        (self.kept.len() == 11).then(|| {
            if robot < rim {
                1.0 - robot / rim
            } else {
                rim / robot - 1.0
            }
        })
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
                out.rmse < 0.075 && out.lie_s < 1.0 && out.ok > 0.85,
                "bias {before} and {after}, scale {gyro_scale}: {out:?}"
            );
        }
    }
}

/// Wheels that slip unlike or skid sideways in bends turn otherwise than the robot: the yaw of the poses says how much, without a
/// gyro and against a faultless one that they contradict.
#[test]
fn wheels_that_turn_otherwise_than_the_robot_do_not_overrule_a_measured_yaw() {
    for (rim_turn, left_slip, has_gyro) in [
        (2.0, 0.0, false),
        (1.5, 0.0, false),
        (1.0, 0.3, false),
        (-1.0, 0.0, true),
        (2.0, 0.0, true),
        (1.0, 0.5, true),
    ] {
        let mut runs = Vec::new();
        for seed in 0..4 {
            let drive = Drive {
                rim_turn,
                left_slip,
                has_gyro,
                seed,
                ..Drive::default()
            };
            let out = drive.run(70.0, (15.0, 70.0));
            assert!(
                out.lie_s < 1.0 && out.ok > 0.9,
                "rims turn {rim_turn} times, left {left_slip}, gyro {has_gyro}: {out:?}"
            );
            runs.push(out);
        }
        let ratio = mean_ratio(&runs);
        assert!(
            ratio < 1.3,
            "rims turn {rim_turn} times, left {left_slip}, gyro {has_gyro}: {ratio} {runs:?}"
        );
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

/// A driver that divides ticks by times gives rates that jump by a quarter of the speed and more, whose sum is right.
#[test]
fn rates_made_of_ticks_are_no_slip() {
    for (ticks_per_turn, row_steps) in [(50.0, 5), (50.0, 2), (200.0, 5), (1000.0, 2)] {
        let runs: Vec<_> = (0..4)
            .map(|seed| {
                let drive = Drive {
                    ticks_per_turn,
                    row_steps,
                    by_rates: true,
                    seed,
                    ..Drive::default()
                };
                drive.run(60.0, (10.0, 60.0))
            })
            .collect();
        assert!(
            mean_ratio(&runs) < if ticks_per_turn < 100.0 { 2.5 } else { 1.2 },
            "{ticks_per_turn} {row_steps}: {} {runs:#?}",
            mean_ratio(&runs)
        );
    }
}

/// Errors of poses that depend on one another make the filter no worse than a mean of one second, which knows the true heading; steps
/// of 5 cm do by a sixth.
#[test]
fn errors_of_poses_that_depend_on_one_another_are_no_slip() {
    for (errors, most) in [
        (PoseErrors::Independent, 1.0),
        (PoseErrors::Wandering(0.03, 3.0), 1.05),
        (PoseErrors::Wandering(0.1, 20.0), 1.05),
        (PoseErrors::Filtered(0.3), 1.05),
        (PoseErrors::Late(0.2), 1.25),
        (PoseErrors::Rounded(0.05), 1.25),
    ] {
        let sigma = match errors {
            PoseErrors::Filtered(_) => 0.03,
            _ => 0.01,
        };
        let runs: Vec<_> = (0..6)
            .map(|seed| {
                let drive = Drive {
                    sigma,
                    errors,
                    seed,
                    ..Drive::default()
                };
                drive.run(90.0, (10.0, 90.0))
            })
            .collect();
        let ratio = mean_ratio(&runs);
        println!("{errors:?} {ratio:.3}");
        assert!(ratio < most, "{errors:?}: {ratio:.3} {runs:#?}");
    }
}

/// Of poses that a stall had held up the last is the robot's place: the first, used in its stead, would be a jump back and one forwards.
#[test]
fn poses_that_come_at_once_after_a_stall_are_no_jumps() {
    for stall_s in [0.5, 0.7, 1.5] {
        for seed in 0..4 {
            let drive = Drive {
                errors: PoseErrors::HeldUp(stall_s),
                seed,
                ..Drive::default()
            };
            let out = drive.run(60.0, (10.0, 60.0));
            assert!(out.whole_rmse < 0.2, "{stall_s} s: {out:?}");
        }
    }
}

fn mean_ratio(runs: &[Outcome]) -> f64 {
    let logs: f64 = runs.iter().map(|out| (out.rmse / out.naive).ln()).sum();
    (logs / runs.len() as f64).exp()
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

/// A robot that is towed with its wheels locked does not stand, be it as slow as 0.1 m/s.
#[test]
fn a_robot_that_slides_on_locked_wheels_does_not_stand() {
    let slides = |t: f64| (20.0..32.0).contains(&t);
    let slip = |t: f64| if slides(t) { -1.0 } else { 0.04 };
    for (towed, shown_after) in [(0.3, 1.5), (0.1, 3.0)] {
        let speed = |t: f64| if slides(t) { towed } else { 0.5 };
        let drive = Drive {
            by: By::Speed,
            speed: &speed,
            slip: &slip,
            turn: &|_| 0.0,
            ..Drive::default()
        };
        let out = drive.run(32.0, (20.0 + shown_after, 32.0));
        println!("{towed} m/s: {out:?}");
        assert!(out.stands < 0.1 && out.contradicts > 0.8, "{out:?}");
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

/// The mean squared error of slips in a table that has all columns in each row, 0.2 s apart: counts, gyro, and places with or
/// without a heading.
fn square_of_slow_rows(seed: u64, has_heading: bool) -> f64 {
    let wheels = PLACES.iter().enumerate().map(|(index, &(x, y))| {
        let wheel = Wheel::powered(format!("{index}")).at(x, y);
        wheel.radius(RADIUS_M).ticks_per_turn(1000)
    });
    let robot = Robot::new("cart".into(), wheels.collect()).unwrap();
    let settings = FilterSettings {
        dropout: 0.6,
        position_sigma: 0.01,
        ..FilterSettings::default()
    };
    let mut filter = SlipFilter::new(&robot, settings).unwrap();
    let mut noise = Noise::new(seed);
    let (mut place, mut yaw, mut angles) = ([0.0, 0.0], 0.0_f64, [0.0; 4]);
    let (mut sum, mut count) = (0.0, 0.0);
    for step in 0..10_000_u32 {
        let time = f64::from(step) * STEP_S;
        let speed = 0.5 * (time - 2.0).clamp(0.0, 1.0);
        let turn = 0.3 * (0.5 * time).sin() * speed;
        let slip = [0.1, 0.4, 0.05, 0.3][(step / 700 % 4) as usize];
        if step % 20 == 0 {
            let time_ns = i64::from(step) * 10_000_000;
            let mut take = |measurement| {
                filter
                    .update(Sample {
                        time_ns,
                        measurement,
                    })
                    .unwrap();
            };
            for (wheel, angle) in angles.iter().enumerate() {
                let raw = (angle / TAU * TICKS_PER_TURN) as u64;
                take(Measurement::WheelCount { wheel, raw });
            }
            let rate = turn + 0.002 + 0.003 * noise.normal();
            take(Measurement::YawRate { rate });
            let [x, y] = place.map(|part: f64| part + 0.01 * noise.normal());
            let heading = yaw + 0.01 * noise.normal();
            take(if has_heading {
                Measurement::Pose { x, y, yaw: heading }
            } else {
                Measurement::Position { x, y }
            });
            let known = &filter.latest().wheels[0];
            if let Some(found) = known.slip.filter(|_| time > 8.0) {
                sum += (found.value() - slip) * (found.value() - slip);
                count += 1.0;
            }
        }
        for (angle, (_, y)) in angles.iter_mut().zip(PLACES) {
            *angle += (speed - turn * y) / (1.0 - slip) * STEP_S / RADIUS_M;
        }
        place[0] += yaw.cos() * speed * STEP_S;
        place[1] += yaw.sin() * speed * STEP_S;
        yaw += turn * STEP_S;
    }
    sum / count
}

/// Where the next sample comes as late as the next row, a reading was used a row too late: 0.099.
#[test]
fn a_place_in_slow_rows_is_used_at_its_own_row() {
    for has_heading in [true, false] {
        let squares = (0..10).map(|seed| square_of_slow_rows(seed, has_heading));
        let rms = (squares.sum::<f64>() / 10.0).sqrt();
        println!("heading: {has_heading}, {rms:.4}");
        assert!(rms < 0.1, "{rms}");
    }
}
