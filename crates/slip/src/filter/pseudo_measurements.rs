//! Pseudo-measurements, which need no sensor: a robot whose wheels all point one way hardly drifts, and one whose wheels
//! all stand, stands.

use grouser_real::Real;

use super::PSEUDO_MEASUREMENT_PERIOD_S;
use super::estimator::Core;
use super::motion_model::{self, FORWARD};

/// The robot stands when all wheels have been still for this long, s.
const STANDSTILL_TIME_S: f64 = 0.2;
/// Errors of a pseudo-measurement are correlated over this time, s.
const CORRELATION_TIME_S: f64 = 0.5;
/// Standard deviation of the yaw rate by the powered wheels: a share of it for unequal slip, and rad/s.
const WHEEL_TURN_SHARE: f64 = 0.3;
const WHEEL_TURN_RAD_PER_S: f64 = 0.05;
/// Standard deviation of the speed of a robot that stands, m/s: with a free wheel, and without one, where it may slide with
/// its wheels locked.
const STANDSTILL_SIGMA_M_PER_S: f64 = 0.002;
const LOCKED_SIGMA_M_PER_S: f64 = 0.02;
/// Standard deviation of the yaw rate of a robot that stands, rad/s.
const STANDSTILL_SIGMA_RAD_PER_S: f64 = 0.002;
/// Sideways drift on a cross slope over the rims' slip speed times the tangent of the roll: friction acts against the slip
/// velocity, so that the drift is to the slip speed as the weight's share downhill to the pull, and wheels in sand pull with
/// 0.3 to 0.6 of their load.
const DRIFT_OVER_SLIP_SPEED: f64 = 2.0;
/// Cross slopes below this are the noise of level ground, the tangent of 2°.
const MIN_CROSS_SLOPE: f64 = 0.03;
/// A drift by the slope lasts as long as the slope, s: some lengths of a robot.
const SLOPE_TIME_S: f64 = 10.0;
/// A counter that has not changed has moved by less than this share of a tick.
const STILL_TICK_SHARE: f64 = 0.6;

impl Core {
    /// Applies the pseudo-measurements.
    pub(super) fn apply_pseudo_measurements(&mut self, time_ns: i64) {
        let weight = Real::sqrt(CORRELATION_TIME_S / PSEUDO_MEASUREMENT_PERIOD_S);
        let yaw = [0.0, 0.0, 1.0];
        if let Some(row) = self.wheels.lateral {
            let lasting = Real::sqrt(SLOPE_TIME_S / PSEUDO_MEASUREMENT_PERIOD_S);
            let downhill = lasting * self.drift_downhill(time_ns);
            let sigma = Real::hypot(downhill, weight * self.settings.lateral_sigma);
            motion_model::hold(&mut self.state, row, 0.0, sigma);
        }
        if !self.gyro.is_trusted(time_ns, &self.settings)
            && let Some(turn) = self.turn_by_wheels()
        {
            let turn = turn.value;
            let sigma = WHEEL_TURN_SHARE * turn.abs() + WHEEL_TURN_RAD_PER_S;
            motion_model::hold(&mut self.state, yaw, turn, weight * sigma);
        }
        for wheel in self.wheels.free() {
            let still = wheel.stillness(time_ns);
            let stands = still >= STANDSTILL_TIME_S && wheel.monitor.is_clean();
            if stands && wheel.rolling.stop_expected {
                let sigma = (STILL_TICK_SHARE * wheel.tick / still).max(STANDSTILL_SIGMA_M_PER_S);
                motion_model::hold(&mut self.state, wheel.row, 0.0, weight * sigma);
            }
        }
        let slides = (self.ground.as_ref()).is_some_and(|ground| ground.slide(time_ns).is_some());
        let stands = !slides
            && self.wheels.iter().all(|wheel| {
                wheel.stillness(time_ns) >= STANDSTILL_TIME_S && !wheel.monitor.has_failed()
            });
        if stands {
            for wheel in &mut self.wheels.channels {
                wheel.rolling.stands();
            }
            let sigma = if self.wheels.free().next().is_some() {
                STANDSTILL_SIGMA_M_PER_S
            } else {
                LOCKED_SIGMA_M_PER_S
            };
            let variance = self.state.variance_of(&[(FORWARD, 1.0)]) + sigma * sigma;
            self.accelerometer
                .learn_noise(self.state.mean(FORWARD), variance);
            for row in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
                motion_model::hold(&mut self.state, row, 0.0, weight * sigma);
            }
            motion_model::hold(
                &mut self.state,
                yaw,
                0.0,
                weight * STANDSTILL_SIGMA_RAD_PER_S,
            );
        }
    }

    /// Does the ground fall off to one side so much that the robot drifts, where its wheels all point one way at rest?
    pub(super) fn drifts_downhill(&self) -> bool {
        self.wheels.lateral.is_some() && self.cross_slope > MIN_CROSS_SLOPE
    }

    /// The speed at which the robot may drift down a cross slope, m/s.
    fn drift_downhill(&self, time_ns: i64) -> f64 {
        let rims = self.wheels.mean_powered_rim(time_ns, self.settings.dropout);
        let slip_speed = rims.map_or(0.0, |rims| (rims - self.state.mean(FORWARD)).abs());
        DRIFT_OVER_SLIP_SPEED * self.cross_slope * slip_speed
    }
}

#[cfg(test)]
mod tests;
