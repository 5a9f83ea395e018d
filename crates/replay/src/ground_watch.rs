//! Changes of ground over a log, by the motors alone.

use grouser_real::Real;
use grouser_slip::{Measurement, Robot, Sample, WheelRole};

use crate::ground_change::GroundChange;

/// After a command the motors need this long to settle, s.
const SETTLE_TIME_S: f64 = 2.0;
/// Changes that are kept: the first of the log.
const MAX_CHANGES: usize = 1000;

/// Feeds [`GroundChange`] while one command holds. Without commands nothing is called: a driver who changes speed looks like
/// another ground.
#[derive(Clone, Debug)]
pub(crate) struct GroundWatch {
    /// Logarithms of effort and speed.
    change: GroundChange<2>,
    /// Torque or current of each powered wheel.
    efforts: Vec<Option<f64>>,
    /// Its rim travel per radian, m, and the size of its rim speed where a rate is measured, m/s.
    rims: Vec<(f64, Option<f64>)>,
    command: Option<([f64; 2], i64)>,
    low_speed: f64,
    called_s: Vec<f64>,
}

impl GroundWatch {
    pub(crate) fn new(robot: &Robot, low_speed: f64) -> Self {
        let powered = || {
            robot
                .wheels()
                .iter()
                .map(|wheel| wheel.role == WheelRole::Powered)
        };
        let rims = robot.wheels().iter().map(|wheel| {
            let is_free = wheel.role == WheelRole::Free;
            (wheel.travel_per_radian(), is_free.then_some(0.0))
        });
        Self {
            rims: rims.collect(),
            change: GroundChange::new(),
            // A free wheel has no effort: 0 throughout.
            efforts: powered()
                .map(|is_powered| if is_powered { None } else { Some(0.0) })
                .collect(),
            command: None,
            low_speed,
            called_s: Vec::new(),
        }
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        match sample.measurement {
            Measurement::WheelTorque {
                wheel,
                torque: effort,
            }
            | Measurement::MotorCurrent {
                wheel,
                share: effort,
            } => {
                if let Some(slot) = self.efforts.get_mut(wheel) {
                    *slot = Some(effort);
                }
            }
            Measurement::WheelRate { wheel, rate } => {
                if let Some((per_radian, speed)) = self.rims.get_mut(wheel) {
                    *speed = Some((rate * *per_radian).abs());
                }
            }
            Measurement::Command { forward, left } => {
                let command = [forward, left];
                if self.command.is_none_or(|(same, _)| same != command) {
                    self.command = Some((command, sample.time_ns));
                    self.change.begin();
                }
            }
            _ => {}
        }
    }

    /// Takes the mean size of the powered wheels' rim speeds, m/s, after all samples of one time.
    pub(crate) fn step(&mut self, now_ns: i64, time_s: f64, rim: f64) {
        let is_settled = (self.command).is_some_and(|(_, since_ns)| {
            now_ns.saturating_sub(since_ns) as f64 * 1e-9 >= SETTLE_TIME_S
        });
        if !(is_settled && rim > self.low_speed) {
            return;
        }
        let efforts = self
            .efforts
            .iter()
            .map(|effort| Some(effort.as_ref()?.abs()));
        let Some(effort) = efforts.sum::<Option<f64>>().filter(|sum| *sum > 0.0) else {
            return;
        };
        // A rate is fresher than the mean over a window.
        let rates = self.rims.iter().map(|rim| rim.1).sum::<Option<f64>>();
        let speed = rates.filter(|sum| *sum > 0.0).unwrap_or(rim);
        let has_changed = self
            .change
            .take(time_s, &[Real::ln(effort), Real::ln(speed)]);
        if has_changed && self.called_s.len() < MAX_CHANGES {
            self.called_s.push(time_s);
        }
    }

    /// When the ground was called another one, s from the log's start.
    pub(crate) fn called_s(&self) -> &[f64] {
        &self.called_s
    }
}
