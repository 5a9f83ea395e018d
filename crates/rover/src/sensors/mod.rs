//! What the robot's sensors show of the truth, with their noise, their delay and their faults.

mod contact;
mod encoder;
mod fault;
mod settings;

pub use fault::{FaultKind, FaultWindow, Schedule};
pub use settings::SensorSettings;

use std::collections::VecDeque;

use grouser_real::{Real, wrap_angle};
use grouser_slip::{Measurement, Sample};

use crate::dynamics::Vehicle;
use crate::ground::Noise;
use crate::vector::Vector;
use contact::ContactSensors;
use encoder::Encoder;
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

/// Samples under way at most: two seconds of the greatest delay at a hundred rows a second; a sensor that delays more loses
/// the newest.
const MAX_UNDER_WAY: usize = 4096;

/// Every sensor of a robot.
#[derive(Clone, Debug)]
pub struct Sensors {
    settings: SensorSettings,
    schedule: Schedule,
    encoders: Vec<Encoder>,
    gyro: Noise,
    gyro_bias: f64,
    camera: Noise,
    current: Noise,
    joint: Noise,
    clock: Noise,
    camera_at: Option<(Vector, f64)>,
    gnss: Noise,
    last_inertial: Option<(Vector, Vector)>,
    next_camera: f64,
    next_gnss: f64,
    next_sample: f64,
    /// When edges were last looked for, s.
    looked_at: f64,
    contact: ContactSensors,
    under_way: VecDeque<(f64, Sample)>,
}

impl Sensors {
    /// The sensors of `vehicle`'s robot with noise of `seed`.
    #[must_use]
    pub fn new(vehicle: &Vehicle, settings: SensorSettings, schedule: Schedule, seed: u64) -> Self {
        let encoders = vehicle
            .model()
            .robot
            .wheels()
            .iter()
            .enumerate()
            .map(|(index, wheel)| Encoder::new(wheel, seed, index))
            .collect::<Vec<_>>();
        let mut gyro = Noise::new(seed, 1);
        let gyro_bias = settings.gyro_bias * gyro.normal();
        Self {
            contact: ContactSensors::new(encoders.len(), &settings, seed),
            settings,
            schedule,
            encoders,
            gyro,
            gyro_bias,
            camera: Noise::new(seed, 2),
            gnss: Noise::new(seed, 3),
            current: Noise::new(seed, 4),
            clock: Noise::new(seed, 5),
            joint: Noise::new(seed, 6),
            camera_at: None,
            last_inertial: None,
            next_camera: 0.0,
            next_gnss: 0.0,
            next_sample: 0.0,
            looked_at: 0.0,
            under_way: VecDeque::with_capacity(256),
        }
    }

    /// The fault schedule.
    #[must_use]
    pub const fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// The rate of a wheel against its link as its motor driver sees it: through the same encoder, faults
    /// included, rad/s.
    #[must_use]
    pub fn driver_rate(&self, wheel: usize, rate: f64, time: f64) -> f64 {
        let on = |kind| self.schedule.active(kind, Some(wheel), time).is_some();
        if on(FaultKind::EncoderStuck) || on(FaultKind::EncoderSilent) || on(FaultKind::AllSilent) {
            0.0
        } else if on(FaultKind::EncoderReversed) {
            -rate
        } else {
            rate
        }
    }

    /// Looks at the truth and gives what has arrived by now, in the order of arrival.
    pub fn read(&mut self, vehicle: &Vehicle, arrived: &mut Vec<Sample>) {
        let time = vehicle.time();
        self.edges(vehicle, time);
        if time + 1e-9 >= self.next_sample {
            let rate = self
                .schedule
                .active(FaultKind::SlowRate, None, time)
                .unwrap_or(self.settings.rate);
            self.next_sample += 1.0 / rate.clamp(0.1, 1e4);
            self.sample(vehicle, time);
        }
        arrived.clear();
        while let Some((due, sample)) = self.under_way.front() {
            if *due > time + 1e-9 {
                break;
            }
            arrived.push(*sample);
            self.under_way.pop_front();
        }
    }

    fn sample(&mut self, vehicle: &Vehicle, time: f64) {
        let silent = self.schedule.active(FaultKind::AllSilent, None, time);
        if silent.is_some() {
            return;
        }
        let stamp = self.stamp(time);
        let delay = self
            .schedule
            .active(FaultKind::Latency, None, time)
            .unwrap_or(0.0);
        for (wheel, now) in vehicle.wheels().iter().enumerate() {
            if self.stamps_edges(vehicle, wheel) {
                continue;
            }
            let raw = self.encoders[wheel].count(now.encoder_angle, &self.schedule, wheel, time);
            if let Some(raw) = raw {
                self.send(time + delay, stamp, Measurement::WheelCount { wheel, raw });
            }
        }
        self.joints(vehicle, time, stamp, delay);
        self.inertial(vehicle, time, stamp, delay);
        self.currents(vehicle, time, stamp, delay);
        self.contacts(vehicle, time, stamp, delay);
        self.camera(vehicle, time, stamp, delay);
        self.gnss(vehicle, time, stamp, delay);
    }

    /// Does the wheel's encoder report the time of each edge instead of a count?
    fn stamps_edges(&self, vehicle: &Vehicle, wheel: usize) -> bool {
        self.settings.edge_clock > 0.0 && vehicle.model().wheels[wheel].motor.is_none()
    }

    /// The edges since the last look.
    fn edges(&mut self, vehicle: &Vehicle, time: f64) {
        let span = [self.looked_at, time];
        self.looked_at = time;
        for (wheel, now) in vehicle.wheels().iter().enumerate() {
            let silent = [
                FaultKind::EncoderSilent,
                FaultKind::EncoderStuck,
                FaultKind::AllSilent,
            ]
            .iter()
            .any(|kind| self.schedule.active(*kind, Some(wheel), time).is_some());
            if !self.stamps_edges(vehicle, wheel) || silent {
                continue;
            }
            let Self {
                encoders,
                under_way,
                settings,
                ..
            } = self;
            encoders[wheel].edges(
                now.encoder_angle,
                span,
                settings.edge_clock,
                |at, forward| {
                    let sample = Sample {
                        time_ns: to_ns(at),
                        measurement: Measurement::WheelEdge { wheel, forward },
                    };
                    send(under_way, time, sample);
                },
            );
        }
    }

    fn joints(&mut self, vehicle: &Vehicle, time: f64, stamp: i64, delay: f64) {
        let freedoms = vehicle.model().linkage.freedoms();
        let angles = vehicle.state().joints;
        for (freedom, angle) in angles.into_iter().enumerate().take(freedoms) {
            let noise = self.settings.joint_sigma * self.joint.normal();
            let measurement = Measurement::JointAngle {
                joint: freedom,
                angle: angle + noise,
            };
            self.send(time + delay, stamp, measurement);
        }
    }

    fn inertial(&mut self, vehicle: &Vehicle, time: f64, stamp: i64, delay: f64) {
        let s = self.settings;
        let active = |kind| self.schedule.active(kind, None, time);
        let (bias_step, full) = (
            active(FaultKind::GyroBias).unwrap_or(0.0),
            active(FaultKind::ImuSaturated),
        );
        let (stuck, garbage) = (
            active(FaultKind::ImuStuck).is_some(),
            active(FaultKind::Garbage).is_some(),
        );
        let noise = &mut self.gyro;
        let mut around = |sigma: f64| {
            Vector::new(
                sigma * noise.normal(),
                sigma * noise.normal(),
                sigma * noise.normal(),
            )
        };
        let mut turning = vehicle.state().turning() + around(s.gyro_sigma);
        turning.z += self.gyro_bias + bias_step;
        let mut force = vehicle.specific_force() + around(s.accelerometer_sigma);
        if let Some(full) = full {
            let clip = |v: Vector, most: f64| {
                Vector::new(
                    v.x.clamp(-most, most),
                    v.y.clamp(-most, most),
                    v.z.clamp(-most, most),
                )
            };
            force = clip(force, full * EARTH_GRAVITY_M_PER_S2);
            turning = clip(turning, full);
        }
        match (stuck, self.last_inertial) {
            (true, Some((f, t))) => (force, turning) = (f, t),
            _ => self.last_inertial = Some((force, turning)),
        }
        if garbage {
            turning.z = f64::NAN;
            force.x = f64::INFINITY;
        }
        let [force, rate] = [force, turning].map(|v| [v.x, v.y, v.z]);
        self.send(time + delay, stamp, Measurement::Inertial { force, rate });
    }

    fn currents(&mut self, vehicle: &Vehicle, time: f64, stamp: i64, delay: f64) {
        for (wheel, now) in vehicle.wheels().iter().enumerate() {
            let Some(motor) = vehicle.model().wheels[wheel].motor else {
                continue;
            };
            let active = |kind| self.schedule.active(kind, Some(wheel), time);
            let offset = active(FaultKind::CurrentOffset).unwrap_or(0.0);
            let dead = active(FaultKind::CurrentZero).is_some();
            let noise = self.settings.current_sigma * self.current.normal();
            let share = if dead {
                0.0
            } else {
                now.motor.current / motor.current + offset + noise
            };
            self.send(
                time + delay,
                stamp,
                Measurement::MotorCurrent { wheel, share },
            );
        }
    }

    fn contacts(&mut self, vehicle: &Vehicle, time: f64, stamp: i64, delay: f64) {
        let Self {
            contact,
            settings,
            schedule,
            under_way,
            ..
        } = self;
        contact.read(vehicle, (settings, schedule), time, |measurement| {
            let sample = Sample {
                time_ns: stamp,
                measurement,
            };
            send(under_way, time + delay, sample);
        });
    }

    /// Way since the last picture, in the robot's frame at it.
    fn camera(&mut self, vehicle: &Vehicle, time: f64, stamp: i64, delay: f64) {
        let s = self.settings;
        if s.camera_rate <= 0.0 || time + 1e-9 < self.next_camera {
            return;
        }
        self.next_camera += 1.0 / s.camera_rate;
        let active = |kind| self.schedule.active(kind, None, time);
        if active(FaultKind::CameraLost).is_some() {
            return;
        }
        let (place, heading) = (vehicle.state().position, vehicle.heading());
        let before = self.camera_at.replace((place, heading));
        let Some((from, old)) = before else { return };
        let turn = wrap_angle(heading - old);
        let (sin, cos) = Real::sin_cos(old + 0.5 * turn);
        let way = place - from;
        let scale = if active(FaultKind::CameraFrozen).is_some() {
            0.0
        } else {
            active(FaultKind::CameraScale).unwrap_or(1.0)
        };
        let jump = active(FaultKind::CameraJump).unwrap_or(0.0);
        let mut noise = || s.camera_sigma * self.camera.normal();
        let measurement = Measurement::Displacement {
            forward: scale * (cos * way.x + sin * way.y) + noise() + jump,
            left: scale * (cos * way.y - sin * way.x) + noise(),
            turn: Some(scale * turn + 2.0 * noise()),
        };
        self.send(time + s.camera_latency + delay, stamp, measurement);
    }

    fn gnss(&mut self, vehicle: &Vehicle, time: f64, stamp: i64, delay: f64) {
        let s = self.settings;
        if s.gnss_rate <= 0.0 || time + 1e-9 < self.next_gnss {
            return;
        }
        self.next_gnss += 1.0 / s.gnss_rate;
        let place = vehicle.state().position;
        let mut noise = || s.gnss_sigma * self.gnss.normal();
        let measurement = Measurement::Pose {
            x: place.x + noise(),
            y: place.y + noise(),
            yaw: vehicle.heading(),
        };
        self.send(time + s.gnss_latency + delay, stamp, measurement);
    }

    /// The stamp of a reading taken now, by the robot's clock with its faults.
    fn stamp(&mut self, time: f64) -> i64 {
        let active = |kind| self.schedule.active(kind, None, time);
        let mut shown = time + self.schedule.settled(FaultKind::ClockJump, time);
        shown += active(FaultKind::ClockStep).unwrap_or(0.0);
        if let Some(share) = active(FaultKind::Jitter) {
            shown += share * (self.clock.uniform() - 0.5) / self.settings.rate;
        }
        if active(FaultKind::DuplicateTime).is_some() {
            shown = (shown * 5.0).floor() / 5.0;
        }
        to_ns(shown)
    }

    /// Sends a sample on its way: it arrives at `due` (s), after everything that is due before.
    fn send(&mut self, due: f64, time_ns: i64, measurement: Measurement) {
        let sample = Sample {
            time_ns,
            measurement,
        };
        send(&mut self.under_way, due, sample);
    }
}

fn send(under_way: &mut VecDeque<(f64, Sample)>, due: f64, sample: Sample) {
    if under_way.len() >= MAX_UNDER_WAY {
        return;
    }
    match under_way.iter().rev().take_while(|(d, _)| *d > due).count() {
        0 => under_way.push_back((due, sample)),
        later => under_way.insert(under_way.len() - later, (due, sample)),
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "beyond 292 years the cast saturates, which the estimator refuses"
)]
pub(crate) fn to_ns(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}
