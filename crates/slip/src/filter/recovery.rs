//! Recovery: references that contradict each other, a state that has run away, and the restart of the motion.

use super::accelerometer::NOISE_SCALE_LIMITS;
use super::estimator::Core;
use super::monitor::Monitor;
use super::motion_model::{COMMON_SLIP, FORWARD, own_slip};
use super::settings::SlipPrior;
use super::wheel_channel::WheelChannel;
use super::{READMIT_SPEED_SHARE, REFERENCE_TIMEOUT_S};
use crate::history::seconds_between;

/// A robot faster than its fastest wheel by this factor and this speed (m/s) for long is an error of the filter.
const RUNAWAY_FACTOR: f64 = 1.5;
const RUNAWAY_SPEED_M_PER_S: f64 = 0.05;
/// A speed is plausible when the slip that follows from it is within this many sigma of the prior.
const PLAUSIBLE_SIGMA: f64 = 2.5;
/// Standard deviation of the speed from which the motion restarts: a share of it, and m/s.
const RESTART_SHARE: f64 = 0.05;
const RESTART_SPEED_M_PER_S: f64 = 0.02;

/// What is wrong with the motion as a whole.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Recovery {
    runaway: Monitor,
    /// The robot is stuck, or its free wheels are.
    pub(super) is_blocked: bool,
    /// Two references contradict each other.
    pub(super) is_disputed: bool,
}

impl Core {
    /// The distance of the powered wheels' slip from its prior, in sigma, if the robot went at `speed` (m/s); `None` where
    /// they hardly turn.
    fn surprise(&self, speed: f64) -> Option<f64> {
        let now_ns = self.now_ns.unwrap_or(0);
        let rim = self
            .wheels
            .mean_powered_rim(now_ns, self.settings.dropout)?;
        let SlipPrior { mean, sigma } = self.settings.slip;
        let faster = if rim.abs() >= speed.abs() { rim } else { speed };
        let has_slip = faster.abs() > 2.0 * self.settings.low_speed;
        has_slip.then(|| ((rim - speed) / faster - mean).abs() / sigma)
    }

    /// Does the prior of slip allow that the robot goes at `speed` (m/s)?
    pub(super) fn is_plausible(&self, speed: f64) -> bool {
        self.surprise(speed)
            .is_some_and(|off| off <= PLAUSIBLE_SIGMA)
    }

    /// Does the reference sensor measure about the same speed as `speed` (m/s) now?
    pub(super) fn agrees_with_sensor(&self, speed: f64, now_ns: i64) -> bool {
        self.reference.speed.is_some_and(|(measured, then)| {
            seconds_between(then, now_ns) <= REFERENCE_TIMEOUT_S && self.is_near(measured, speed)
        })
    }

    /// Does a free wheel that turns measure about the same speed as `speed` (m/s) now?
    pub(super) fn agrees_with_free_wheel(&self, speed: f64, now_ns: i64) -> bool {
        self.wheels.free().any(|wheel| {
            let rim = wheel.rim.map_or(0.0, |(rim, _)| rim.value);
            wheel.is_received(now_ns, self.settings.dropout)
                && wheel.turns()
                && self.is_near(rim, speed)
        })
    }

    fn is_near(&self, measured: f64, speed: f64) -> bool {
        (measured - speed).abs() - self.settings.low_speed <= READMIT_SPEED_SHARE * speed.abs()
    }

    /// Do a refused reference and the state contradict each other, while the slip that follows from the state is further from
    /// its prior? Then neither is trusted, until one of them shows what is wrong with it.
    pub(super) fn is_disputed(&self, now_ns: i64) -> bool {
        if self.is_led {
            return false;
        }
        let own = self.state.mean(FORWARD);
        let contradicts = |claim: f64| {
            let (Some(ours), Some(theirs)) = (self.surprise(own), self.surprise(claim)) else {
                return false;
            };
            (own - claim).abs() > READMIT_SPEED_SHARE * claim.abs().max(own.abs()) && ours > theirs
        };
        let by_wheel = self.wheels.free().any(|wheel| {
            (wheel.monitor.has_failed() || wheel.monitor.is_suspect())
                && wheel.is_received(now_ns, self.settings.dropout)
                && wheel.turns()
                && wheel.rim.is_some_and(|(rim, _)| contradicts(rim.value))
        });
        let by_sensor = !self.reference.monitor.is_clean()
            && self.reference.speed.is_some_and(|(speed, then)| {
                seconds_between(then, now_ns) <= REFERENCE_TIMEOUT_S && contradicts(speed)
            });
        by_wheel || by_sensor
    }

    /// Has no free wheel turned since the robot stood, or has each stopped unexpectedly, while nothing else measures the
    /// robot's speed? Then either the robot is stuck or they are.
    pub(super) fn is_blocked(&self, now_ns: i64) -> bool {
        let alone = self
            .reference
            .accepted_ns
            .is_none_or(|then| seconds_between(then, now_ns) > REFERENCE_TIMEOUT_S);
        let mut free = self.wheels.free().peekable();
        let blocked = |wheel: &WheelChannel| {
            !wheel.rolling.has_turned || !wheel.turns() && !wheel.rolling.stop_expected
        };
        alone && free.peek().is_some() && free.all(blocked)
    }

    /// Do the free wheels that measure the robot's speed miss pulses, while nothing else measures it? Then the robot seems
    /// slower than it is, and the slips of all wheels are as wrong as the pulses are few.
    pub(super) fn only_reference_misses_pulses(&self, now_ns: i64) -> bool {
        let checked = self.wheels.iter().zip(&self.output.checks);
        let mut used = checked
            .filter(|(wheel, _)| wheel.free && !wheel.monitor.has_failed())
            .peekable();
        self.is_alone(now_ns) && used.peek().is_some() && used.all(|(_, check)| check.misses_pulses)
    }

    /// Does no sensor but the wheels measure the robot's speed?
    pub(super) fn is_alone(&self, now_ns: i64) -> bool {
        let accepted_ns = self.reference.accepted_ns;
        !self.is_led
            && accepted_ns.is_none_or(|then| seconds_between(then, now_ns) > REFERENCE_TIMEOUT_S)
    }

    /// Restarts the motion from the fastest wheel where the robot would be much faster than that for long.
    pub(super) fn recover_from_runaway(&mut self, time_ns: i64) {
        if self.is_led {
            return;
        }
        let Some(fastest) = self.wheels.fastest_rim() else {
            return;
        };
        let limit = RUNAWAY_FACTOR * fastest.abs() + RUNAWAY_SPEED_M_PER_S;
        let runs = self.state.mean(FORWARD).abs() > limit;
        let patience = self.settings.failure;
        if self.recovery.runaway.record(time_ns, !runs, patience) {
            return;
        }
        self.recovery.runaway = Monitor::default();
        self.accelerometer.noise_scale = NOISE_SCALE_LIMITS.1;
        self.restart_motion(fastest, 0.5 * fastest.abs() + RUNAWAY_SPEED_M_PER_S);
        for wheel in &mut self.wheels.channels {
            wheel.monitor = Monitor::default();
        }
    }

    /// Restarts the motion from a measured speed (m/s).
    pub(super) fn restart_from(&mut self, speed: f64) {
        self.restart_motion(speed, RESTART_SHARE * speed.abs() + RESTART_SPEED_M_PER_S);
    }

    /// Sets the robot's speed, and all slips to their priors.
    fn restart_motion(&mut self, speed: f64, sigma: f64) {
        self.state.reset(FORWARD, speed, sigma * sigma);
        let SlipPrior { mean, sigma } = self.settings.slip;
        self.state.reset(COMMON_SLIP, mean, sigma * sigma);
        for (index, wheel) in self.wheels.channels.iter_mut().enumerate() {
            wheel.mean_innovation = 0.0;
            wheel.was_off = false;
            let SlipPrior { mean, sigma } = self.settings.own_slip_prior(wheel.free);
            self.state.reset(own_slip(index), mean, sigma * sigma);
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
