//! The estimate of each wheel, and its health.

use grouser_real::Real;
use grouser_terra::Slip;

use super::WRONG_ENCODER_TIME_S;
use super::estimator::Core;
use super::input::Input;
use super::motion_model::{YAW, along};
use super::settings::SlipPrior;
use super::wheel_channel::{MAX_WINDOW_FACTOR, WheelChannel};
use crate::history::seconds_between;
use crate::measured_slip::MeasuredSlip;
use crate::speed::Measured;
use crate::state::{Degraded, Health, Invalid, Motion};
use crate::wheel_estimate::WheelEstimate;

/// A side slip angle with a larger standard deviation is not reported, rad.
const MAX_SIDE_SLIP_SIGMA_RAD: f64 = 0.5;

impl Core {
    /// Updates the estimate of every wheel, and what its health needs of the robot's motion.
    pub(super) fn update_health(&mut self, now_ns: i64, input: &Input) {
        self.update_disputes(now_ns);
        self.update_estimates(now_ns, input);
    }

    /// Is the robot blocked, and do its references contradict each other?
    pub(super) fn update_disputes(&mut self, now_ns: i64) {
        self.recovery.is_blocked = self.is_blocked(now_ns);
        self.recovery.is_disputed =
            self.is_disputed(now_ns) || self.only_reference_misses_pulses(now_ns);
    }

    /// Updates the estimates that the readings since the last call have changed.
    pub(super) fn settle_estimates(&mut self, input: &Input) {
        if self.has_news
            && let Some(now_ns) = self.now_ns
        {
            self.update_estimates(now_ns, input);
        }
    }

    fn update_estimates(&mut self, now_ns: i64, input: &Input) {
        self.has_news = false;
        for index in 0..self.wheels.channels.len() {
            let estimate = self.wheel_estimate(index, now_ns, input);
            let last_good_ns = if estimate.health == Health::Ok {
                Some(now_ns)
            } else {
                self.wheels.channels[index].estimate.until_ns
            };
            self.wheels.channels[index].estimate = WheelEstimate {
                until_ns: last_good_ns,
                ..estimate
            };
            self.output.estimates[index] = WheelEstimate {
                last_good_age: last_good_ns.map(|then| seconds_between(then, now_ns)),
                ..estimate
            };
        }
    }

    /// β = atan2(across, along) of the wheel's centre over the ground; `None` where the robot is too slow for one, or it is
    /// not known.
    pub(super) fn side_slip_angle(&self, index: usize) -> Option<Measured> {
        let wheel = self.wheels.channels.get(index)?;
        let (ahead, sideways) = (wheel.row, wheel.steering.across());
        let speed = self.state.mean_of(&along(ahead));
        let drift = self.state.mean_of(&along(sideways));
        let square = speed * speed + drift * drift;
        let lowest = self.settings.low_speed;
        if !(square > lowest * lowest) {
            return None;
        }
        let row: [f64; 3] =
            core::array::from_fn(|i| (speed * sideways[i] - drift * ahead[i]) / square);
        let variance = self.state.variance_of(&along(row));
        let limit = MAX_SIDE_SLIP_SIGMA_RAD * MAX_SIDE_SLIP_SIGMA_RAD;
        (variance < limit).then(|| Measured {
            value: Real::atan2(drift, speed),
            variance,
        })
    }

    fn wheel_estimate(&self, index: usize, now_ns: i64, input: &Input) -> WheelEstimate {
        let wheel = &self.wheels.channels[index];
        let received_ns = input.received_until(index, now_ns);
        let (Some((rim, until_ns)), Some(silence)) = (wheel.rim, wheel.silence(received_ns)) else {
            return WheelEstimate::NOTHING;
        };
        if silence > self.settings.dropout {
            return WheelEstimate {
                health: Health::Invalid(Invalid::Dropout),
                ..WheelEstimate::NOTHING
            };
        }
        let row = along(wheel.row);
        let level = self.state.mean_of(&row);
        let (value, longer) = wheel.carrier.over_ground(level, wheel.row[0], now_ns);
        let forward = Measured {
            value,
            variance: longer * longer * self.state.variance_of(&row),
        };
        let measured = MeasuredSlip::from_speeds(forward, rim, &self.limits);
        let slip_row = wheel.slip_row(index);
        let drift = self.drift_doubt(wheel, rim.value);
        let yaw = self.yaw_doubt(wheel, rim.value, now_ns);
        let variance = self.state.variance_of(&slip_row) + drift * drift + yaw * yaw;
        let kept = SlipPrior {
            mean: self.state.mean_of(&slip_row),
            sigma: Real::sqrt(variance),
        };
        let SlipPrior { mean, sigma } = if wheel.free { kept.by_faster() } else { kept };
        let slip = mean.clamp(-1.0, 1.0);
        let health = self.health(index, now_ns, &measured, sigma);
        let has_slip = measured.slip.is_some() && !matches!(health, Health::Invalid(_));
        WheelEstimate {
            slip: Slip::new(slip).ok().filter(|_| has_slip),
            sigma: has_slip.then_some(sigma),
            forward_speed: Some(forward),
            rim_speed: Some(rim),
            motion: Some(match measured.motion {
                // the estimated slip is less noisy than one window
                Motion::Driving | Motion::Braking if slip < 0.0 => Motion::Braking,
                Motion::Driving | Motion::Braking => Motion::Driving,
                other => other,
            }),
            health,
            until_ns: Some(until_ns),
            last_good_age: None,
        }
    }

    /// Standard deviation of the slip of a wheel that is steered aside, since the robot's drift is not known: the wheels do
    /// not slip alike then, as their prior says.
    fn drift_doubt(&self, wheel: &WheelChannel, rim: f64) -> f64 {
        let drifts = self.drifts_downhill() && !self.is_led;
        let Some(left) = self.wheels.lateral.filter(|_| drifts) else {
            return 0.0;
        };
        let aside = left[0] * wheel.row[0] + left[1] * wheel.row[1];
        let drift = aside.abs() * Real::sqrt(self.state.variance_of(&along(left)));
        (drift / rim.abs().max(self.settings.low_speed)).min(1.0)
    }

    /// Standard deviation of the slip of a wheel beside the robot's middle by the yaw rate, where no gyro is trusted: the
    /// wheels measure that rate as well as they slip alike.
    fn yaw_doubt(&self, wheel: &WheelChannel, rim: f64, now_ns: i64) -> f64 {
        if self.gyro.is_trusted(now_ns, &self.settings) {
            return 0.0;
        }
        let yaw = match self.wheels.yaw_rate() {
            Some(_) if self.is_led => self.state.sigma(YAW),
            None if self.is_led => return 0.0,
            _ => self.wheels.yaw_rate_sigma(&self.state),
        };
        (yaw * wheel.row[2].abs() / rim.abs().max(self.settings.low_speed)).min(1.0)
    }

    fn health(&self, index: usize, now_ns: i64, measured: &MeasuredSlip, sigma: f64) -> Health {
        let wheel = &self.wheels.channels[index];
        let moves = measured.motion != Motion::Standstill;
        let stillness = wheel.stillness(now_ns);
        let stuck = stillness >= WRONG_ENCODER_TIME_S && moves;
        let against = wheel
            .against_since_ns
            .is_some_and(|since| seconds_between(since, now_ns) >= WRONG_ENCODER_TIME_S);
        let repeats = wheel.repeated.has_stopped()
            && self.wheels.powered().any(|other| other.repeated.changes());
        if stuck || repeats || against || (wheel.free && wheel.monitor.has_failed()) {
            return Health::Invalid(Invalid::Inconsistent);
        }
        let blocked = (self.recovery.is_blocked || self.recovery.is_disputed) && !wheel.free;
        if measured.slip.is_none() && !(blocked && measured.motion == Motion::RollBack) {
            return measured.health;
        }
        if blocked
            || self.output.checks[index].misses_pulses
            || self.gyro.contradicts_wheels()
            || (moves && stillness > 0.0)
        {
            return Health::Degraded(Degraded::Suspect);
        }
        let silent_after = self
            .ground
            .as_ref()
            .map_or(0.0, |ground| ground.silent_after());
        let windows = MAX_WINDOW_FACTOR * self.settings.wheel_window;
        let timeout = self.settings.dropout + windows.max(silent_after);
        let readmitted = self
            .ground
            .as_ref()
            .is_some_and(|ground| ground.is_readmitted(now_ns));
        match self
            .speed_known_ns
            .map(|then| seconds_between(then, now_ns))
        {
            None => Health::Degraded(Degraded::Relative),
            Some(age) if age > timeout => Health::Degraded(Degraded::ReferenceLost),
            Some(_) if readmitted => Health::Degraded(Degraded::ReferenceReadmitted),
            Some(_) if sigma > self.settings.max_sigma => Health::Degraded(Degraded::Quantised),
            Some(_) if wheel.monitor.is_suspect() => Health::Degraded(Degraded::ReferenceLost),
            Some(_) => Health::Ok,
        }
    }
}

#[cfg(test)]
mod tests;
