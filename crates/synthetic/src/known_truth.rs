//! Drives whose slip is prescribed as a profile over time, with an absolute pose and an inertial unit: the cells on which
//! the slip filter's errors are measured.

use grouser_slip::{Encoder, Measurement, Result, Robot, Sample, Wheel};

use crate::noise::{Noise, Wander};

/// Rate of wheels and inertial unit, Hz, and steps between two poses (5 Hz).
const RATE_HZ: u32 = 100;
const POSE_STEPS: u32 = 20;
/// Wheel radius, m, and ticks per turn.
const RADIUS_M: f64 = 0.1;
const TICKS_PER_TURN: f64 = 1000.0;
/// Standard deviation and bias of the gyro, rad/s.
const GYRO_SIGMA: f64 = 0.002;
const GYRO_BIAS: f64 = 0.004;
/// Standard deviations of the accelerometer and of its bias, m/s².
const ACCELEROMETER_SIGMA: f64 = 0.05;
const ACCELEROMETER_BIAS: f64 = 0.05;
/// Standard deviation of a measured yaw, rad.
const YAW_SIGMA: f64 = 0.01;
/// Share of outliers among the poses, and their size, m.
const OUTLIER_SHARE: f64 = 0.01;
const OUTLIER_M: f64 = 0.5;
/// Delay of late stamps, steps (0.1 s).
const LATE_STEPS: usize = 10;
/// Each wheel's slip wanders about the common one with this standard deviation, and this correlation time, s.
const WHEEL_SLIP_SIGMA: f64 = 0.005;
const WHEEL_SLIP_TIME_S: f64 = 5.0;
/// Rims run faster and slower by this share, with a period of 17 s.
const RIM_SHARE: f64 = 0.03;
/// The largest yaw rate, rad/s, with a period of 21 s.
const YAW_RATE: f64 = 0.02;
/// Positions of the wheels, m.
const PLACES: [(f64, f64); 4] = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)];

/// The common slip over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlipProfile {
    /// 0, from 40 s on 0.2, from 80 s on 0.5, each within 0.15 s.
    Steps,
    /// 0.15 all the time.
    Constant,
    /// 0.05, and 0.45 for 0.8 s of each 6 s.
    Blips,
    /// From 0 to 0.6 in 120 s.
    Ramp,
    /// About 0.25 by 0.2 with a period of 8 s.
    Waves,
    /// A random walk of 0.05 per √s within [−0.1, 0.8].
    Walk,
}

/// What is wrong with the sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// Nothing.
    Clean,
    /// 1 % of the poses are 0.5 m off.
    Outliers,
    /// Poses and accelerations are stamped 0.1 s after they were measured.
    Late,
}

/// One drive of four wheels at a steady rim speed.
#[derive(Clone, Copy, Debug)]
pub struct KnownTruth {
    /// Mean rim speed, m/s.
    pub rim_speed: f64,
    /// Is there an accelerometer?
    pub accelerations: bool,
    /// What is wrong with the sensors.
    pub disturbance: Disturbance,
    /// The common slip over time.
    pub profile: SlipProfile,
    /// Standard deviation of a position, m.
    pub position_sigma: f64,
    /// Length of the drive, s.
    pub duration_s: u32,
    /// Seed of all noise.
    pub seed: u64,
}

/// One step of a drive.
#[derive(Clone, Debug)]
pub struct TruthStep {
    /// s.
    pub time_s: f64,
    /// The common slip.
    pub slip: f64,
    /// Slip of each wheel.
    pub wheel_slips: [f64; 4],
    /// Mean way of the rims since the start, m.
    pub rim_way: f64,
    /// The measured position, m, where there is one.
    pub position: Option<[f64; 2]>,
    /// The samples of all sensors.
    pub samples: Vec<Sample>,
}

/// Between −1 and 1 with this period, smooth: two parabolas a period.
fn wave(time_s: f64, period_s: f64) -> f64 {
    let phase = time_s / period_s;
    let x = 2.0 * (phase - phase.floor()) - 1.0;
    4.0 * x * (x.abs() - 1.0)
}

impl KnownTruth {
    /// The robot's description.
    ///
    /// # Errors
    /// None for these wheels.
    pub fn robot() -> Result<Robot> {
        let wheels = PLACES.iter().enumerate().map(|(i, &(x, y))| {
            Wheel::powered(format!("w{i}"))
                .at(x, y)
                .radius(RADIUS_M)
                .encoder(Encoder::counting(TICKS_PER_TURN))
        });
        Robot::new("known truth".into(), wheels.collect())
    }

    fn slip(&self, time_s: f64, walk: f64) -> f64 {
        let rise = |since: f64| ((time_s - since) / 0.15).clamp(0.0, 1.0);
        match self.profile {
            SlipProfile::Steps => 0.2 * rise(40.0) + 0.3 * rise(80.0),
            SlipProfile::Constant => 0.15,
            SlipProfile::Blips => {
                let k = time_s % 6.0;
                let edge = |at: f64| ((k - at) / 0.15).clamp(0.0, 1.0);
                0.05 + 0.4 * (edge(3.0) - edge(3.8))
            }
            SlipProfile::Ramp => 0.6 * time_s / 120.0,
            SlipProfile::Waves => 0.25 + 0.2 * wave(time_s, 8.0),
            SlipProfile::Walk => walk,
        }
    }

    /// The drive, step by step.
    #[must_use]
    #[allow(
        clippy::too_many_lines,
        reason = "one loop, in the order of the sensors"
    )]
    pub fn steps(&self) -> Vec<TruthStep> {
        let mut noise = Noise::new(self.seed);
        let dt = 1.0 / f64::from(RATE_HZ);
        let bias = ACCELEROMETER_BIAS * noise.normal();
        let phases: [f64; 4] = core::array::from_fn(|_| noise.uniform());
        let mut wander = [Wander::default(); 4];
        let mut walk: f64 = 0.2;
        let (mut x, mut y, mut yaw, mut course) = (0.0, 0.0, 0.3_f64, unit(0.3));
        let (mut ways, mut rim_way, mut last_speed) = ([0.0; 4], 0.0, None);
        let mut poses = Vec::new();
        let mut forces: Vec<f64> = Vec::new();
        let mut steps = Vec::new();
        for step in 0..self.duration_s * RATE_HZ {
            let time_s = f64::from(step) * dt;
            let time_ns = i64::from(step) * 1_000_000_000 / i64::from(RATE_HZ);
            walk = (walk + 0.05 * dt.sqrt() * noise.normal()).clamp(-0.1, 0.8);
            let slip = self.slip(time_s, walk);
            let rim = self.rim_speed * (1.0 + RIM_SHARE * wave(time_s, 17.0));
            let speed = if slip >= 0.0 {
                rim * (1.0 - slip)
            } else {
                rim / (1.0 + slip)
            };
            let yaw_rate = YAW_RATE * wave(time_s, 21.0);
            let force = last_speed.map_or(0.0, |last| (speed - last) / dt);
            last_speed = Some(speed);
            poses.push([x, y, yaw]);
            forces.push(force);
            let late = match self.disturbance {
                Disturbance::Late => LATE_STEPS,
                _ => 0,
            };
            let then = (step as usize).saturating_sub(late);
            let mut samples = Vec::with_capacity(7);
            let mut wheel_slips = [0.0; 4];
            for (wheel, (&(_, place), way)) in PLACES.iter().zip(&mut ways).enumerate() {
                let own = wander[wheel].step(&mut noise, dt / WHEEL_SLIP_TIME_S, WHEEL_SLIP_SIGMA);
                let slip = (slip + own).clamp(-0.9, 0.95);
                wheel_slips[wheel] = slip;
                let forward = speed - yaw_rate * place;
                let count = (*way / (core::f64::consts::TAU * RADIUS_M) * TICKS_PER_TURN
                    + phases[wheel])
                    .floor();
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "counts rise from zero and stay small"
                )]
                let raw = count as u64;
                samples.push(Sample {
                    time_ns,
                    measurement: Measurement::WheelCount { wheel, raw },
                });
                *way += dt
                    * if slip >= 0.0 {
                        forward / (1.0 - slip)
                    } else {
                        forward * (1.0 + slip)
                    };
            }
            samples.push(Sample {
                time_ns,
                measurement: Measurement::YawRate {
                    rate: yaw_rate + GYRO_BIAS + GYRO_SIGMA * noise.normal(),
                },
            });
            let shaken = forces[then] + bias + ACCELEROMETER_SIGMA * noise.normal();
            let sideways = yaw_rate * speed + ACCELEROMETER_SIGMA * noise.normal();
            if self.accelerations {
                samples.push(Sample {
                    time_ns,
                    measurement: Measurement::Acceleration {
                        forward: shaken,
                        left: sideways,
                    },
                });
            }
            let mut position = None;
            if step % POSE_STEPS == 0 {
                let [x, y, yaw] = poses[then];
                let mut place = [x, y].map(|value| value + self.position_sigma * noise.normal());
                let yaw = yaw + YAW_SIGMA * noise.normal();
                let is_outlier = noise.uniform() < OUTLIER_SHARE;
                let off =
                    unit(core::f64::consts::TAU * noise.uniform()).map(|part| OUTLIER_M * part);
                if is_outlier && self.disturbance == Disturbance::Outliers {
                    place = [place[0] + off[0], place[1] + off[1]];
                }
                position = Some(place);
                let [x, y] = place;
                samples.push(Sample {
                    time_ns,
                    measurement: Measurement::Pose { x, y, yaw },
                });
            }
            steps.push(TruthStep {
                time_s,
                slip,
                wheel_slips,
                rim_way,
                position,
                samples,
            });
            rim_way += rim * dt;
            x += speed * course[0] * dt;
            y += speed * course[1] * dt;
            yaw += yaw_rate * dt;
            course = unit(yaw);
        }
        steps
    }
}

/// The direction of an angle of a few turns, by a product of small rotations: only operations that IEEE 754 fixes.
fn unit(angle: f64) -> [f64; 2] {
    const PARTS: u32 = 6;
    // the half-angle tangent by its series; then the rotation is doubled back to the whole angle
    let part = angle / f64::from(1_u32 << PARTS);
    let square = part * part;
    let t = 0.5
        * part
        * (1.0 + square * (1.0 / 12.0 + square * (1.0 / 120.0 + square * 17.0 / 20160.0)));
    let scale = 1.0 / (1.0 + t * t);
    let (mut cos, mut sin) = ((1.0 - t * t) * scale, 2.0 * t * scale);
    for _ in 0..PARTS {
        (cos, sin) = (cos * cos - sin * sin, 2.0 * sin * cos);
    }
    [cos, sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_those_of_the_angle() {
        for angle in [-3.0_f64, -0.5, 0.0, 0.3, 2.0, 6.2] {
            let [x, y] = unit(angle);
            assert!(
                (x - angle.cos()).abs() < 1e-9 && (y - angle.sin()).abs() < 1e-9,
                "{angle}"
            );
        }
    }

    #[test]
    fn the_wheels_count_the_way_that_slip_asks_for() {
        let drive = KnownTruth {
            rim_speed: 0.5,
            accelerations: false,
            disturbance: Disturbance::Clean,
            profile: SlipProfile::Constant,
            position_sigma: 0.0,
            duration_s: 60,
            seed: 3,
        };
        let steps = drive.steps();
        let positions: Vec<_> = steps
            .iter()
            .filter_map(|step| Some((step.rim_way, step.position?)))
            .collect();
        let way: f64 = positions
            .windows(2)
            .map(|pair| {
                let ([x, y], [before_x, before_y]) = (pair[1].1, pair[0].1);
                ((x - before_x).powi(2) + (y - before_y).powi(2)).sqrt()
            })
            .sum();
        let rims = positions.last().map_or(0.0, |last| last.0);
        assert!((1.0 - way / rims - 0.15).abs() < 1e-3, "{way} of {rims}");
    }
}
