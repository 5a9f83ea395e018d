//! The gyro: gated, watched for sticking, and compared with the yaw rate of the wheels.

use grouser_real::Real;

use super::inertial_path::InertialPath;
use super::kalman::{Kalman, ScalarMeasurement};
use super::monitor::Monitor;
use super::motion_model::{FORWARD, GYRO_BIAS, YAW};
use super::settings::FilterSettings;
use super::turn_agreement::TurnAgreement;
use super::wheel_bank::WheelBank;
use crate::fault::Fault;
use crate::history::seconds_between;

/// No gyro of a wheeled robot measures more, rad/s.
const MAX_YAW_RATE_RAD_PER_S: f64 = 100.0;
/// A gyro that repeats its value to the bit for this long while wheels turn is stuck, s.
const STUCK_GYRO_TIME_S: f64 = 0.5;
/// A robot whose wheels turn it faster than this is in a bend, rad/s.
pub(super) const BEND_YAW_RATE_RAD_PER_S: f64 = 0.03;
/// Share of the gap between gyro and wheels by which the bias may change, 1/√s.
const BIAS_CHANGE_PER_SQRT_S: f64 = 0.3;

/// What is known of the gyro beside its bias.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GyroMonitor {
    gate: Monitor,
    last_ns: Option<i64>,
    /// The bits of its last reading, and since when they have been the same.
    repeated: Option<(u64, i64)>,
    agreement: TurnAgreement,
    compared_ns: Option<i64>,
    contradiction: Monitor,
}

impl GyroMonitor {
    /// Updates the state by a yaw rate; returns the normalised innovation squared where the reading is used. A gyro that a reference's
    /// headings confirm contradicts no wheels: then they slip.
    pub(super) fn update(
        &mut self,
        (time_ns, rate): (i64, f64),
        settings: &FilterSettings,
        (wheels, is_confirmed): (&WheelBank, bool),
        state: &mut Kalman,
        path: &mut InertialPath,
    ) -> Result<Option<f64>, Fault> {
        let limit = MAX_YAW_RATE_RAD_PER_S;
        Fault::check_range("yaw rate", rate, -limit, limit, "rad/s")?;
        let sigma = settings.yaw_rate_sigma;
        let measured = ScalarMeasurement {
            jacobian: &[(YAW, 1.0), (GYRO_BIAS, 1.0)],
            residual: rate - state.mean(YAW) - state.mean(GYRO_BIAS),
            variance: sigma * sigma,
        };
        let (innovation, variance) = state.innovation(&measured);
        let agreed = innovation.abs() <= settings.gate * Real::sqrt(variance)
            && !self.is_stuck(time_ns, rate, wheels.any_turns());
        let trusted = self.gate.record(time_ns, agreed, settings.failure);
        let last = self.last_ns.replace(time_ns).unwrap_or(time_ns);
        if let Some(by_wheels) = wheels.yaw_rate() {
            self.compare((time_ns, rate), by_wheels, settings, state);
        }
        let turn = rate - state.mean(GYRO_BIAS);
        let turn = self
            .agreement
            .mean_turn(turn, seconds_between(last, time_ns));
        let forces_wheels = wheels.are_forced((state.mean(FORWARD), turn), settings.low_speed);
        // wheels that slip unequally may contradict a gyro, but their agreement does not clear it; nor does the end of a bend
        let same_way = is_confirmed || !self.agreement.contradicts() && !forces_wheels;
        if !same_way || agreed && wheels.slip_alike(state, settings) {
            self.contradiction
                .record(time_ns, same_way, settings.failure);
        }
        if !agreed || !trusted || self.contradiction.has_failed() {
            path.yaw_rate = state.mean(YAW);
            return Ok(None);
        }
        path.yaw_rate = rate;
        Ok(Some(state.update(&measured)))
    }

    /// Compares the gyro with the wheels, and inflates its bias where they disagree while the wheels go straight.
    fn compare(
        &mut self,
        (time_ns, rate): (i64, f64),
        by_wheels: f64,
        settings: &FilterSettings,
        state: &mut Kalman,
    ) {
        let last = self.compared_ns.replace(time_ns).unwrap_or(time_ns);
        let dt = seconds_between(last, time_ns);
        let turn = rate - state.mean(GYRO_BIAS);
        self.agreement.update(turn, by_wheels, dt);
        let gap = turn - by_wheels;
        if by_wheels.abs() < BEND_YAW_RATE_RAD_PER_S
            && let Some(mean_gap) = self.agreement.update_straight(gap, dt)
        {
            let bias = settings.gyro_bias;
            let change = BIAS_CHANGE_PER_SQRT_S * mean_gap;
            state.inflate(GYRO_BIAS, change * change * dt, bias * bias);
        }
    }

    /// Has the gyro repeated its value to the bit for long while wheels turn?
    fn is_stuck(&mut self, time_ns: i64, rate: f64, wheels_turn: bool) -> bool {
        let bits = rate.to_bits();
        match self.repeated {
            Some((same, since)) if same == bits && wheels_turn => {
                seconds_between(since, time_ns) >= STUCK_GYRO_TIME_S
            }
            _ => {
                self.repeated = Some((bits, time_ns));
                false
            }
        }
    }

    /// Is it received and trusted?
    pub(super) fn is_trusted(&self, now_ns: i64, settings: &FilterSettings) -> bool {
        let received = self
            .last_ns
            .is_some_and(|then| seconds_between(then, now_ns) <= settings.dropout);
        received && !self.gate.has_failed() && !self.contradiction.has_failed()
    }

    /// Does it contradict the wheels, in sign or in unit?
    pub(super) const fn contradicts_wheels(&self) -> bool {
        self.contradiction.has_failed()
    }

    /// The clock was set: times are forgotten, trust is not.
    pub(super) const fn restart_clock(&mut self) {
        self.last_ns = None;
        self.repeated = None;
        self.compared_ns = None;
    }
}

#[cfg(test)]
mod tests;
