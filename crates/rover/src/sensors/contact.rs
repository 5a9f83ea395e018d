//! Sensors of sinkages and entry angles: by a camera, a displacement sensor, or the suspension's kinematics.

use grouser_real::Real;
use grouser_slip::Measurement;

use super::fault::{FaultKind, Schedule};
use super::settings::SensorSettings;
use crate::dynamics::Vehicle;
use crate::ground::Noise;

/// Both sensors of every wheel.
#[derive(Clone, Debug)]
pub(super) struct ContactSensors {
    noise: Noise,
    /// Constant errors of each wheel's sinkage (m) and entry angle (rad).
    biases: Vec<[f64; 2]>,
    /// What each showed last.
    last: Vec<[Option<f64>; 2]>,
    /// When both are read next, s.
    next: [f64; 2],
    /// Readings of a broken sensor so far.
    garbage: u32,
}

impl ContactSensors {
    pub(super) fn new(wheels: usize, settings: &SensorSettings, seed: u64) -> Self {
        let mut noise = Noise::new(seed, 7);
        let spreads = [settings.sinkage_bias, settings.entry_angle_bias];
        let biases = (0..wheels).map(|_| spreads.map(|spread| spread * noise.normal()));
        let biases = biases.collect();
        Self {
            noise,
            biases,
            last: vec![[None; 2]; wheels],
            next: [0.0; 2],
            garbage: 0,
        }
    }

    /// What they show at `time` (s) of the wheels that touch the ground.
    pub(super) fn read(
        &mut self,
        vehicle: &Vehicle,
        (settings, schedule): (&SensorSettings, &Schedule),
        time: f64,
        mut send: impl FnMut(Measurement),
    ) {
        let rates = [settings.sinkage_rate, settings.entry_angle_rate];
        let sigmas = [settings.sinkage_sigma, settings.entry_angle_sigma];
        for sensor in 0..2 {
            if rates[sensor] <= 0.0 || time + 1e-9 < self.next[sensor] {
                continue;
            }
            self.next[sensor] += 1.0 / rates[sensor];
            for (wheel, now) in vehicle.wheels().iter().enumerate() {
                let radius = vehicle.model().wheels[wheel].wheel.radius();
                let depth = now.load.pressed;
                let truth = if sensor == 0 {
                    depth
                } else {
                    Real::acos((1.0 - depth / radius).clamp(-1.0, 1.0))
                };
                let fresh =
                    truth + self.biases[wheel][sensor] + sigmas[sensor] * self.noise.normal();
                let active = |kind| schedule.active(kind, Some(wheel), time).is_some();
                let value = if active(FaultKind::ContactGarbage) {
                    self.garbage += 1;
                    [f64::NAN, -1.0, 10.0][self.garbage as usize % 3]
                } else if active(FaultKind::ContactStuck) {
                    self.last[wheel][sensor].unwrap_or(fresh)
                } else {
                    fresh
                };
                self.last[wheel][sensor] = Some(value);
                if now.load.normal > 0.0 {
                    send(if sensor == 0 {
                        Measurement::Sinkage {
                            wheel,
                            depth: value,
                        }
                    } else {
                        Measurement::EntryAngle {
                            wheel,
                            angle: value,
                        }
                    });
                }
            }
        }
    }
}
