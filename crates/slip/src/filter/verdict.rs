//! What can be said of each wheel, and when the filter itself has lost its way.

use grouser_real::Real;
use grouser_terra::Slip;

use super::body::{COMMON_SLIP, FORWARD, along, own_slip};
use super::settings::SlipPrior;
use super::watch::Watch;
use super::wheel::LONGEST;
use super::{ALONE, FELT_UNREST, RUNAWAY, SlipFilter, WRONG};
use crate::estimate::WheelEstimate;
use crate::history::seconds_between;
use crate::measured_slip::MeasuredSlip;
use crate::speed::Measured;
use crate::state::{Degraded, Health, Invalid, Motion};

impl SlipFilter {
    /// What can be said of each wheel now.
    pub(super) fn judge(&mut self, now_ns: i64) {
        for index in 0..self.wheels.len() {
            let estimate = self.judged(index, now_ns);
            let before = self.wheels[index].estimate;
            let good = if estimate.health == Health::Ok {
                Some(now_ns)
            } else {
                before.until_ns
            };
            self.wheels[index].estimate = WheelEstimate {
                until_ns: good,
                ..estimate
            };
            self.estimates[index] = WheelEstimate {
                last_good_age: good.map(|then| seconds_between(then, now_ns)),
                ..estimate
            };
        }
    }

    pub(super) fn judged(&self, index: usize, now_ns: i64) -> WheelEstimate {
        let wheel = &self.wheels[index];
        let nothing = |health| WheelEstimate {
            health,
            ..WheelEstimate::NOTHING
        };
        let (Some((rim, until_ns)), Some(silence)) = (wheel.rim, wheel.silence(now_ns)) else {
            return WheelEstimate::NOTHING;
        };
        if silence > self.settings.dropout {
            return nothing(Health::Invalid(Invalid::Dropout));
        }
        let slopes = along(wheel.row);
        let level = slopes.iter().map(|&(i, a)| a * self.state.mean(i)).sum();
        let (value, longer) = wheel.carrier.over_ground(level, wheel.row[0], now_ns);
        let forward = Measured {
            value,
            variance: longer * longer * self.state.variance_of(&slopes),
        };
        let measured = MeasuredSlip::from_speeds(forward, rim, &self.limits);
        let slips = self.slip_slopes(index);
        let kept = SlipPrior {
            mean: self.slip_mean(index),
            sigma: Real::sqrt(self.state.variance_of(&slips)),
        };
        let SlipPrior { mean, sigma } = if wheel.free { kept.by_faster() } else { kept };
        let slip = mean.clamp(-1.0, 1.0);
        let shows = measured.slip.is_some();
        let mut estimate = WheelEstimate {
            slip: Slip::new(slip).ok().filter(|_| shows),
            sigma: shows.then_some(sigma),
            forward_speed: Some(forward),
            rim_speed: Some(rim),
            motion: Some(measured.motion),
            health: measured.health,
            until_ns: Some(until_ns),
            last_good_age: None,
        };
        estimate.health = self.health(index, now_ns, &measured, sigma);
        if matches!(estimate.health, Health::Invalid(_)) {
            estimate.slip = None;
            estimate.sigma = None;
        }
        estimate
    }

    pub(super) fn health(
        &self,
        index: usize,
        now_ns: i64,
        measured: &MeasuredSlip,
        sigma: f64,
    ) -> Health {
        let wheel = &self.wheels[index];
        let for_long =
            |since: Option<i64>| since.is_some_and(|since| seconds_between(since, now_ns) >= WRONG);
        let moves = measured.motion != Motion::Standstill;
        let stuck = wheel.stillness(now_ns) >= WRONG && moves;
        if stuck || for_long(wheel.against_since_ns) || (wheel.free && wheel.watch.has_failed()) {
            return Health::Invalid(Invalid::Inconsistent);
        }
        if measured.slip.is_none() {
            return measured.health;
        }
        let blocked = self.is_blocked(now_ns) && !wheel.free;
        if blocked || self.contradicted.has_failed() || (moves && wheel.stillness(now_ns) > 0.0) {
            return Health::Degraded(Degraded::Suspect);
        }
        let age = self.reference_ns.map(|then| seconds_between(then, now_ns));
        match age {
            None => Health::Degraded(Degraded::Relative),
            Some(age) if age > self.settings.dropout + LONGEST * self.settings.wheel_window => {
                Health::Degraded(Degraded::ReferenceLost)
            }
            Some(_) if sigma > self.settings.max_sigma => Health::Degraded(Degraded::Quantised),
            Some(_) if wheel.watch.is_suspect() => Health::Degraded(Degraded::ReferenceLost),
            Some(_) => Health::Ok,
        }
    }

    /// Has no free wheel turned since the robot stood, and does nothing else tell its speed? Then either the robot is stuck
    /// or they are.
    pub(super) fn is_blocked(&self, now_ns: i64) -> bool {
        let told = self.reference.accepted_ns;
        let alone = told.is_none_or(|then| seconds_between(then, now_ns) > ALONE);
        let mut free = self.wheels.iter().filter(|wheel| wheel.free).peekable();
        alone && free.peek().is_some() && free.all(|wheel| !wheel.has_turned)
    }

    /// A filter that has lost its way: the robot would be much faster than the fastest of its wheels. It begins again from
    /// these.
    pub(super) fn catch_runaway(&mut self, time_ns: i64) {
        let rims = || {
            self.wheels
                .iter()
                .filter_map(|wheel| Some(wheel.rim?.0.value))
        };
        let Some(fastest) = rims().reduce(|a, b| if b.abs() > a.abs() { b } else { a }) else {
            return;
        };
        let speed = self.state.mean(FORWARD);
        let runs = speed.abs() > RUNAWAY.0 * fastest.abs() + RUNAWAY.1;
        if self.runaway.judge(time_ns, !runs, self.settings.failure) {
            return;
        }
        self.runaway = Watch::default();
        self.felt_unrest = FELT_UNREST.1;
        let sigma = 0.5 * fastest.abs() + RUNAWAY.1;
        self.state.restart(FORWARD, fastest, sigma * sigma);
        self.state.restart(
            COMMON_SLIP,
            self.settings.slip.mean,
            self.settings.slip.sigma * self.settings.slip.sigma,
        );
        for (index, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.watch = Watch::default();
            if wheel.free {
                let SlipPrior { mean, sigma } = self.settings.free_slip.by_rim();
                self.state.restart(own_slip(index), mean, sigma * sigma);
            } else {
                let sigma = self.settings.wheel_slip_sigma;
                self.state.restart(own_slip(index), 0.0, sigma * sigma);
            }
        }
    }
}
