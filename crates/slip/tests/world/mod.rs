//! A robot with known slips: what its sensors would say, sample after sample.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "each test takes what it needs; counts and steps are small"
)]

use std::f64::consts::TAU;

use grouser_slip::{CounterWidth, Encoder, Measurement, Robot, Sample, Wheel};

use crate::noise::Noise;

pub(crate) const STEP: f64 = 0.01;
pub(crate) const STEP_NS: i64 = 10_000_000;

/// What the robot does and what the ground does to it.
#[derive(Clone, Debug)]
pub(crate) struct World {
    pub(crate) seed: u64,
    /// Powered wheels, in pairs left and right.
    pub(crate) powered: usize,
    pub(crate) free: bool,
    /// Ticks per turn of the free wheel.
    pub(crate) free_ticks: f64,
    /// Slip of the powered wheels on firm ground and between `patch` (s, s).
    pub(crate) slip: (f64, f64),
    pub(crate) patch: (f64, f64),
    /// How far each wheel's slip wanders about it, with half a second's memory.
    pub(crate) wander: f64,
    pub(crate) skid: f64,
    pub(crate) speed: f64,
    pub(crate) turn: f64,
    /// Seconds of rest, of starting, of driving, of stopping.
    pub(crate) legs: [f64; 4],
    pub(crate) accelerometer: bool,
    /// Hz of a camera that tells displacements; 0 for none.
    pub(crate) camera: u32,
    pub(crate) gyro_bias: f64,
}

impl Default for World {
    fn default() -> Self {
        Self {
            seed: 1,
            powered: 4,
            free: true,
            free_ticks: 500.0,
            slip: (0.08, 0.35),
            patch: (10.0, 15.0),
            wander: 0.02,
            skid: -0.005,
            speed: 0.3,
            turn: 0.1,
            legs: [2.0, 2.0, 22.0, 2.0],
            accelerometer: true,
            camera: 0,
            gyro_bias: 0.004,
        }
    }
}

/// What is true at a moment.
#[derive(Clone, Debug, Default)]
pub(crate) struct Truth {
    pub(crate) time: f64,
    pub(crate) speed: f64,
    /// Slip by wheel; `None` where it stands.
    pub(crate) slips: Vec<Option<f64>>,
}

impl World {
    pub(crate) fn wheels(&self) -> usize {
        self.powered + usize::from(self.free)
    }

    pub(crate) fn robot(&self) -> Robot {
        let wheels = (0..self.wheels()).map(|i| {
            let free = i == self.powered;
            let (x, y) = self.place(i);
            let name = format!("w{i}");
            let wheel = if free {
                Wheel::free(name)
            } else {
                Wheel::powered(name)
            };
            wheel
                .at(x, y)
                .radius(0.1)
                .encoder(Encoder::counting(self.ticks(i)).counter(CounterWidth::new(16).unwrap()))
        });
        Robot::new("world".into(), wheels.collect()).unwrap()
    }

    fn ticks(&self, wheel: usize) -> f64 {
        if wheel == self.powered {
            self.free_ticks
        } else {
            1000.0
        }
    }

    fn place(&self, wheel: usize) -> (f64, f64) {
        if wheel == self.powered {
            return (-0.45, 0.0);
        }
        let row = (wheel / 2) as f64;
        (
            0.3 - 0.3 * row,
            if wheel.is_multiple_of(2) { 0.25 } else { -0.25 },
        )
    }

    pub(crate) fn duration(&self) -> f64 {
        self.legs.iter().sum()
    }

    /// Speed and acceleration at a time.
    pub(crate) fn drive(&self, time: f64) -> (f64, f64) {
        let [rest, start, steady, stop] = self.legs;
        let smooth = |t: f64, of: f64| {
            let u = (t / of).clamp(0.0, 1.0);
            (u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u) / of)
        };
        let (rise, rising) = smooth(time - rest, start);
        let (fall, falling) = smooth(time - rest - start - steady, stop);
        (self.speed * (rise - fall), self.speed * (rising - falling))
    }

    /// Runs the whole, giving the truth and the samples of every step.
    pub(crate) fn run(&self, mut each: impl FnMut(&Truth, &[Sample])) {
        let mut noise = Noise::new(self.seed);
        let count = self.wheels();
        let (mut rim, mut wander) = (vec![0.0; count], vec![0.0; count]);
        let phases: Vec<f64> = (0..count).map(|_| noise.uniform()).collect();
        let mut way = 0.0;
        let mut yaw = 0.0;
        let (mut seen_way, mut seen_yaw) = (0.0, 0.0);
        let mut samples = Vec::new();
        let steps = (self.duration() / STEP).round() as i64;
        for step in 0..steps {
            let time = step as f64 * STEP;
            let (speed, acceleration) = self.drive(time);
            let yaw_rate = self.turn * speed / self.speed * ((time * 0.4).sin());
            // a wheel's length of ground lies between firm and soft
            let edge = |since: f64| (since / 0.3).clamp(0.0, 1.0);
            let soft = edge(time - self.patch.0) - edge(time - self.patch.1);
            let mut truth = Truth {
                time,
                speed,
                slips: vec![None; count],
            };
            samples.clear();
            let time_ns = step * STEP_NS;
            for i in 0..count {
                let free = i == self.powered;
                let (_, y) = self.place(i);
                let forward = speed - yaw_rate * y;
                wander[i] += -wander[i] * STEP / 0.5
                    + self.wander * (2.0 * STEP / 0.5_f64).sqrt() * noise.normal();
                let slip = if free {
                    self.skid
                } else {
                    self.slip.0 + soft * (self.slip.1 - self.slip.0) + wander[i]
                };
                let rim_speed = if slip >= 0.0 {
                    forward / (1.0 - slip)
                } else {
                    forward * (1.0 + slip)
                };
                // the reading stands at the beginning of the step
                let turned = (rim[i] / (TAU * 0.1) * self.ticks(i) + phases[i]).floor();
                samples.push(Sample {
                    time_ns,
                    measurement: Measurement::WheelCount {
                        wheel: i,
                        raw: (turned as i64).rem_euclid(65536) as u64,
                    },
                });
                rim[i] += rim_speed * STEP;
                truth.slips[i] = (forward.abs() > 0.02).then_some(slip);
            }
            samples.push(Sample {
                time_ns,
                measurement: Measurement::YawRate {
                    rate: yaw_rate + self.gyro_bias + 0.004 * noise.normal(),
                },
            });
            if self.accelerometer {
                samples.push(Sample {
                    time_ns,
                    measurement: Measurement::Acceleration {
                        forward: acceleration + 0.1 + 0.1 * noise.normal(),
                        left: yaw_rate * speed - 0.05 + 0.1 * noise.normal(),
                    },
                });
            }
            if self.camera > 0 && step % i64::from(100 / self.camera) == 0 {
                let mut off = || 0.001 * noise.normal();
                samples.push(Sample {
                    time_ns,
                    measurement: Measurement::Displacement {
                        forward: way - seen_way + off(),
                        left: off(),
                        turn: Some(yaw - seen_yaw),
                    },
                });
                (seen_way, seen_yaw) = (way, yaw);
            }
            each(&truth, &samples);
            way += speed * STEP;
            yaw += yaw_rate * STEP;
        }
    }
}
