//! The estimate of each wheel, and how far it can be trusted.

use grouser_real::Real;
use grouser_terra::Slip;

use super::steps::{Core, MIN_TRUST};
use crate::history::seconds_between;
use crate::measured_slip::{MeasuredSlip, SlipLimits};
use crate::speed::Measured;
use crate::state::{Degraded, Health, Invalid, Motion};
use crate::wheel_estimate::WheelEstimate;

/// A wheel that is stationary while the robot moves, or turns against it, for this long has a wrong encoder, s.
const WRONG_ENCODER_TIME_S: f64 = 0.25;
/// A crawling wheel counts in some steps only: its speed is a mean over this, and it is stationary after this without a count, s.
const CRAWL_TIME_S: f64 = 0.5;
/// The robot moves where its speed is this many sigma from zero.
const MOVES_SIGMAS: f64 = 3.0;

/// How a wheel's readings go with the robot's motion.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WheelWatch {
    /// For how long it has been stationary while the robot moved, and has turned against it, s.
    still: f64,
    against: f64,
    /// Mean speed of its circumference, m/s, and for how long it has not turned, s.
    mean_speed: f64,
    unturned: f64,
    until_ns: Option<i64>,
    last_good_ns: Option<i64>,
}

/// Does its encoder contradict the robot's motion?
const fn is_wrong(watch: &WheelWatch) -> bool {
    watch.still >= WRONG_ENCODER_TIME_S || watch.against >= WRONG_ENCODER_TIME_S
}

impl Core {
    /// Updates every wheel's estimate after a step.
    pub(super) fn update_estimates(&mut self, end_ns: i64) {
        for index in 0..self.wheels.len() {
            let speeds = self.speeds(index);
            if let Some((forward, rim)) = speeds {
                let moves = forward.value.abs() > MOVES_SIGMAS * forward.sigma();
                let limits = SlipLimits::default();
                let moves = moves && forward.value.abs() > limits.low_speed;
                let dt = self.last.dt;
                let is_still = rim.value == 0.0;
                let watch = &mut self.wheels[index];
                let share = (dt / CRAWL_TIME_S).min(1.0);
                watch.mean_speed += share * (rim.value.abs() - watch.mean_speed);
                watch.unturned = if is_still { watch.unturned + dt } else { 0.0 };
                watch.still = if is_still && moves {
                    watch.still + dt
                } else {
                    0.0
                };
                let is_against = moves
                    && rim.value.abs() > limits.low_speed.max(2.0 * rim.sigma())
                    && rim.value * forward.value < 0.0;
                watch.against = if is_against { watch.against + dt } else { 0.0 };
                watch.until_ns = Some(end_ns);
            }
            self.enter(index, speeds, end_ns);
        }
    }

    /// Updates what silence changes.
    pub(super) fn update_health(&mut self, now_ns: i64) {
        for index in 0..self.wheels.len() {
            self.enter(index, self.speeds(index), now_ns);
        }
    }

    /// Speed of a wheel's centre along its heading, and that of its rim, over the last step.
    fn speeds(&self, index: usize) -> Option<(Measured, Measured)> {
        let wheel = self.last.wheels.get(index)?;
        let dt = self.last.dt;
        let distance = wheel.distance?;
        let mut forward = self.filter().motion().along(wheel.row);
        forward.value += wheel.swing / dt;
        let rim = Measured {
            value: distance / dt,
            variance: wheel.variance / (dt * dt),
        };
        Some((forward, rim))
    }

    fn enter(&mut self, index: usize, speeds: Option<(Measured, Measured)>, now_ns: i64) {
        let estimate = self.wheel_estimate(index, speeds, now_ns);
        let watch = &mut self.wheels[index];
        if estimate.health == Health::Ok {
            watch.last_good_ns = Some(now_ns);
        }
        let last_good_age = watch.last_good_ns.map(|then| seconds_between(then, now_ns));
        self.estimates[index] = WheelEstimate {
            last_good_age,
            ..estimate
        };
    }

    fn wheel_estimate(
        &self,
        index: usize,
        speeds: Option<(Measured, Measured)>,
        now_ns: i64,
    ) -> WheelEstimate {
        let watch = &self.wheels[index];
        let Some((silence, limit)) = self.gather.silence(index, now_ns) else {
            return WheelEstimate::NOTHING;
        };
        if silence > limit {
            return WheelEstimate {
                health: Health::Invalid(Invalid::Dropout),
                ..WheelEstimate::NOTHING
            };
        }
        let (Some((forward, rim)), Some(until_ns)) = (speeds, watch.until_ns) else {
            return WheelEstimate::NOTHING;
        };
        let limits = SlipLimits::default();
        let mut measured = MeasuredSlip::from_speeds(forward, rim, &limits);
        let is_slow = forward.value.abs().max(watch.mean_speed) < limits.low_speed;
        let is_crawling = measured.motion == Motion::Standstill && watch.unturned < CRAWL_TIME_S;
        if measured.slip.is_some() && is_slow || is_crawling && watch.last_good_ns.is_some() {
            (measured.slip, measured.health) = (None, Health::Degraded(Degraded::LowSpeed));
        }
        let is_free = self.last.wheels[index].is_free;
        let skid = self.gather.skid();
        let found = self.filter().wheel_slip(index).map(|of| {
            if is_free {
                // its own speed was taken less the skid that it is expected to have
                let slip = 1.0 - (1.0 - of.slip) * (1.0 - skid.mean);
                (slip, of.variance + skid.sigma * skid.sigma)
            } else {
                (of.slip, of.variance + self.scale_variance(of.slip))
            }
        });
        let (slip, sigma) = match found {
            Some((slip, variance)) => (Some(slip.clamp(-1.0, 1.0)), Some(Real::sqrt(variance))),
            // a wheel that does not turn
            None => (measured.slip.map(Slip::value), measured.sigma),
        };
        // wheels that are stationary while a reference moves: they are locked, or their encoders are stuck
        let slides = self.trust < MIN_TRUST && measured.motion == Motion::Standstill;
        let health = if slides {
            Health::Invalid(Invalid::Inconsistent)
        } else {
            self.health(index, now_ns, &measured, sigma)
        };
        let has_slip = measured.slip.is_some() && !matches!(health, Health::Invalid(_));
        let motion = match (measured.motion, slip) {
            // the estimated slip is less noisy than one step
            (Motion::Driving | Motion::Braking, Some(slip)) if slip < 0.0 => Motion::Braking,
            (Motion::Driving | Motion::Braking, Some(_)) => Motion::Driving,
            (other, _) => other,
        };
        WheelEstimate {
            slip: slip
                .and_then(|slip| Slip::new(slip).ok())
                .filter(|_| has_slip),
            sigma: sigma.filter(|_| has_slip),
            forward_speed: Some(forward),
            rim_speed: Some(rim),
            motion: Some(motion).filter(|_| !slides),
            health,
            until_ns: Some(until_ns),
            last_good_age: None,
        }
    }

    /// Where a free wheel alone shows the speed over ground, all slips have the error of its skid in common.
    fn scale_variance(&self, slip: f64) -> f64 {
        let is_alone = self.last.wheels.iter().any(|of| of.is_free) && self.readings[0] == 0.0;
        if is_alone {
            let of_skid = self.gather.skid().sigma * (1.0 - slip.abs());
            of_skid * of_skid
        } else {
            0.0
        }
    }

    fn health(
        &self,
        index: usize,
        now_ns: i64,
        measured: &MeasuredSlip,
        sigma: Option<f64>,
    ) -> Health {
        let watch = &self.wheels[index];
        if is_wrong(watch) || self.is_skidding(index) {
            return Health::Invalid(Invalid::Inconsistent);
        }
        let is_watched = watch.still > 0.0 || watch.against > 0.0;
        let is_doubted = is_watched || self.misses_pulses(index) || self.gather.gyro.is_wrong();
        if self.trust < MIN_TRUST || is_doubted || self.is_misled(now_ns) {
            return Health::Degraded(Degraded::Suspect);
        }
        if measured.slip.is_none() {
            return measured.health;
        }
        let max_sigma = SlipLimits::default().max_sigma;
        match self.speed_age(now_ns) {
            None => Health::Degraded(Degraded::Relative),
            Some(_) if self.is_lost(now_ns) => Health::Degraded(Degraded::ReferenceLost),
            Some(_) if sigma.is_none_or(|sigma| sigma > max_sigma) => {
                Health::Degraded(Degraded::Quantised)
            }
            Some(_) => Health::Ok,
        }
    }

    /// The probability that a wheel's slip exceeds a limit.
    pub(super) fn exceeds(&self, index: usize, limit: f64) -> Option<f64> {
        let slip = self.estimates.get(index)?.slip;
        // a belief that most readings contradict calls nothing
        slip.filter(|_| self.trust >= MIN_TRUST)?;
        self.filter().exceeds(index, limit)
    }
}
