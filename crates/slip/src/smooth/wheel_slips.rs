//! Each wheel's slip by the smoothed motion: the common slip and what the wheel has of its own.

use alloc::vec::Vec;

use grouser_real::Real;

use super::fit::Fit;
use super::level::{LevelReading, smoothed_level};
use crate::motion::{
    CREEP, DRIFT, MIN_SPEED, MIN_SQUARED_SPEED, SIZE, SLIP, SPEED, Step, TURN_BIAS, log_slip,
    slip_within,
};

/// A wheel's slip over a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSlip {
    /// Index of the step.
    pub step: usize,
    /// The slip: 1 − v/u where the wheel drives, u/v − 1 where it brakes.
    pub slip: f64,
    /// Variance of its error.
    pub variance: f64,
}

/// The slips of one wheel in the steps in which it moved.
#[must_use]
pub fn wheel_slips(fit: &Fit, steps: &[Step], wheel: usize) -> Vec<WheelSlip> {
    let mut readings = Vec::new();
    let mut places = Vec::new();
    for (index, step) in steps.iter().enumerate() {
        let this = &step.wheels[wheel];
        let Some(distance) = this
            .distance
            .filter(|distance| distance.abs() >= MIN_SPEED * step.dt)
        else {
            continue;
        };
        let (belief, common) = (&fit.smoothed[index], &fit.common[index]);
        let (sin, cos) = Real::sin_cos(common.direction);
        let (speed, drift) = (belief.mean[SPEED], belief.mean[DRIFT]);
        let [along_x, along_y, lever] = this.row;
        // the wheel's speed over ground by speed, drift and turn
        let mut row = [0.0; SIZE];
        row[SPEED] = along_x * (cos - drift * sin) + along_y * (sin + drift * cos);
        row[DRIFT] = speed * (along_y * cos - along_x * sin);
        row[TURN_BIAS] = -lever;
        let turn = common.turned / step.dt - belief.mean[TURN_BIAS];
        let ground = row[SPEED] * speed + lever * turn + this.swing / step.dt;
        let noise = this.variance + CREEP * CREEP * step.dt * step.dt;
        readings.push(LevelReading {
            value: log_slip(distance, ground * step.dt) - belief.mean[SLIP],
            variance: noise / (distance * distance),
            dt: step.dt,
        });
        places.push((
            index,
            belief.variance_of(&row) / (ground * ground).max(MIN_SQUARED_SPEED),
        ));
    }
    let levels = smoothed_level(&readings).into_iter();
    let slips = places
        .into_iter()
        .zip(levels)
        .map(|((step, by_motion), (own, variance))| {
            let log = fit.smoothed[step].mean[SLIP] + own;
            let (slip, variance) = slip_within(log, by_motion + variance);
            WheelSlip {
                step,
                slip,
                variance,
            }
        });
    slips.collect()
}
