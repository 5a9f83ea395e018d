//! What the robot's sensors say of a course: the samples of the slip estimators.

use std::f64::consts::TAU;

use grouser_slip::{Measurement, Sample};

use crate::course::Course;
use crate::five_wheel::{FiveWheel, WHEELS};
use crate::noise::{Noise, Wander};

/// A sensor of the robot's own displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Rows between two samples.
    pub every: usize,
    /// Standard deviation of each displacement, m.
    pub sigma: f64,
    /// A sample comes this many rows after the moment it measures, with the later stamp.
    pub late: usize,
}

/// What the robot carries, besides encoders and gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Seed of their noise.
    pub seed: u64,
    /// Bits of the wheels' counters.
    pub bits: u32,
    /// Has it an accelerometer?
    pub accelerometer: bool,
    /// Standard deviation of the accelerometer, m/s².
    pub acceleration_sigma: f64,
    /// Bias of the accelerometer forwards and to the left, m/s².
    pub acceleration_bias: (f64, f64),
    /// Does it measure the wheels' torques?
    pub torque: bool,
    /// Standard deviation of a torque, N m.
    pub torque_sigma: f64,
    /// A camera, if it has one.
    pub camera: Option<Camera>,
    /// Standard deviation of each powered wheel's rim speed about its command, as a share of it. The slip of a real
    /// rover shows 0.071 with a correlation of 0.48 from one tenth of a second to the next (data set corenav-GP).
    pub rim_noise: f64,
    /// How long that noise remembers, s.
    pub rim_memory: f64,
    /// The time of the first row, ns.
    pub start_ns: i64,
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            seed: 6,
            bits: 16,
            accelerometer: true,
            acceleration_sigma: 0.1,
            acceleration_bias: (0.1, -0.05),
            torque: true,
            torque_sigma: 0.1,
            camera: None,
            rim_noise: 0.0,
            rim_memory: 0.137,
            start_ns: 0,
        }
    }
}

impl Sensors {
    /// The samples of a course, in order of time; noise of the rims is written into the course.
    #[must_use]
    pub fn samples(&self, robot: &FiveWheel, course: &mut Course) -> Vec<Sample> {
        let mut noise = Noise::new(self.seed);
        let rate = f64::from(course.rate);
        let mut wander = [Wander::default(); WHEELS];
        let mut turned: [f64; WHEELS] = std::array::from_fn(|_| noise.uniform());
        let (mut way, mut yaw) = (0.0, 0.0);
        let mut reported = (0.0, 0.0);
        let mut trail = Vec::new();
        let mut last_speed = 0.0;
        let mut out = Vec::with_capacity(course.steps.len() * 12);
        for (row, step) in course.steps.iter_mut().enumerate() {
            let ns = row as u64 * 1_000_000_000 / u64::from(course.rate);
            let time_ns = self.start_ns.wrapping_add_unsigned(ns);
            let mut say = |measurement| {
                out.push(Sample {
                    time_ns,
                    measurement,
                });
            };
            for (wheel, turned) in turned.iter().enumerate() {
                let raw = count(robot.wheels[wheel].count_at_start, *turned, self.bits);
                say(Measurement::WheelCount { wheel, raw });
            }
            let gyro = step.yaw_rate + robot.gyro_bias + robot.gyro_sigma * noise.normal();
            say(Measurement::YawRate { rate: gyro });
            if self.accelerometer {
                let rise = (step.speed - last_speed) * rate;
                say(Measurement::Acceleration {
                    forward: rise
                        + self.acceleration_bias.0
                        + self.acceleration_sigma * noise.normal(),
                    left: step.yaw_rate * step.speed
                        + self.acceleration_bias.1
                        + self.acceleration_sigma * noise.normal(),
                });
            }
            last_speed = step.speed;
            if self.torque {
                for wheel in 0..WHEELS - 1 {
                    let torque = step.torque[wheel] + self.torque_sigma * noise.normal();
                    say(Measurement::WheelTorque { wheel, torque });
                }
            }
            trail.push((way, yaw));
            if let Some(camera) = self.camera
                && row.is_multiple_of(camera.every)
            {
                let seen: (f64, f64) = trail[row.saturating_sub(camera.late)];
                let (forward, left) =
                    (camera.sigma * noise.normal(), camera.sigma * noise.normal());
                say(Measurement::Displacement {
                    forward: seen.0 - reported.0 + forward,
                    left,
                    turn: Some(seen.1 - reported.1 + 0.002 * noise.normal()),
                });
                reported = seen;
            }
            for (wheel, turned) in turned.iter_mut().enumerate() {
                let share = 1.0 / (rate * self.rim_memory);
                let off = wander[wheel].step(&mut noise, share, self.rim_noise);
                if !robot.wheels[wheel].free {
                    step.rim[wheel] *= 1.0 + off;
                }
                let wheel_of = &robot.wheels[wheel];
                *turned += step.rim[wheel] / rate / (TAU * wheel_of.radius) * wheel_of.ticks;
            }
            way += step.speed / rate;
            yaw += step.yaw_rate / rate;
        }
        out
    }
}

/// What a counter of `bits` bits shows after `turned` ticks.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a counter keeps the low bits"
)]
fn count(start: i64, turned: f64, bits: u32) -> u64 {
    let all = start.wrapping_add(turned.floor() as i64) as u64;
    all & (u64::MAX >> (64 - bits.clamp(1, 64)))
}
