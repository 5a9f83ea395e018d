//! What can be said of each wheel.

use grouser_real::Real;
use grouser_terra::Slip;

use super::body::along;
use super::settings::SlipPrior;
use super::wheel::LONGEST;
use super::{SlipFilter, WRONG};
use crate::history::seconds_between;
use crate::measured_slip::MeasuredSlip;
use crate::speed::Measured;
use crate::state::{Degraded, Health, Invalid, Motion};
use crate::wheel_estimate::WheelEstimate;

/// Pulses and radii are looked at this often, s.
const CHECKED: f64 = 0.1;
/// A side slip angle less certain than this is none, rad.
const BLIND: f64 = 0.5;

impl SlipFilter {
    /// What can be said of each wheel now.
    pub(super) fn judge(&mut self, now_ns: i64) {
        self.blocked = self.is_blocked(now_ns);
        self.disputed = self.is_disputed(now_ns);
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
            self.side_slip_angles[index] = self.side_slip_angle(index);
        }
    }

    /// Looks at each wheel's pulses and radius, ten times a second.
    pub(super) fn check_wheels(&mut self, now_ns: i64) {
        let due = self
            .checked_ns
            .is_none_or(|then| seconds_between(then, now_ns) >= CHECKED);
        if !due {
            return;
        }
        self.checked_ns = Some(now_ns);
        let unknown = self.settings.free_slip.sigma * self.settings.free_slip.sigma;
        for index in 0..self.wheels.len() {
            let others = self.usual_share(index);
            let wheel = &mut self.wheels[index];
            let ok = wheel.estimate.health == Health::Ok && !wheel.free;
            wheel
                .radius
                .take(match (wheel.estimate.slip, wheel.estimate.sigma) {
                    (Some(slip), Some(sigma)) if ok => Some(Measured {
                        value: slip.value(),
                        variance: sigma * sigma,
                    }),
                    _ => None,
                });
            self.checks[index] = super::WheelCheck {
                pulses_missed: wheel.pulses.share(),
                misses_pulses: wheel.pulses.misses(others),
                broken_slot: wheel.pulses.has_broken_slot(),
                radius_excess: wheel.radius.excess(unknown),
            };
        }
    }

    /// The share that the middle one of the other counters seems to miss: what rough ground or a restless clock makes of it.
    fn usual_share(&self, index: usize) -> f64 {
        let mut shares = [0.0; super::MAX_FILTER_WHEELS];
        let mut count = 0;
        for (i, wheel) in self.wheels.iter().enumerate() {
            if let Some(share) = wheel.pulses.share().filter(|_| i != index) {
                shares[count] = share;
                count += 1;
            }
        }
        let shares = &mut shares[..count];
        shares.sort_unstable_by(f64::total_cmp);
        shares.get(count / 2).copied().unwrap_or(0.0)
    }

    /// β = atan2(across, along) of the wheel's centre over the ground; `None` where the robot is too slow for one, or it is
    /// not known.
    fn side_slip_angle(&self, index: usize) -> Option<Measured> {
        let wheel = &self.wheels[index];
        let [along, across] = [wheel.row, wheel.across()].map(|row| {
            let rows = super::body::along(row);
            rows.iter()
                .map(|&(i, a)| a * self.state.mean(i))
                .sum::<f64>()
        });
        let square = along * along + across * across;
        let lowest = self.settings.low_speed;
        if !(square > lowest * lowest) {
            return None;
        }
        let sideways = wheel.across();
        let slopes: [f64; 3] =
            core::array::from_fn(|i| (along * sideways[i] - across * wheel.row[i]) / square);
        let variance = self.state.variance_of(&super::body::along(slopes));
        (variance < BLIND * BLIND).then(|| Measured {
            value: Real::atan2(across, along),
            variance,
        })
    }

    pub(super) fn judged(&self, index: usize, now_ns: i64) -> WheelEstimate {
        let wheel = &self.wheels[index];
        let nothing = |health| WheelEstimate {
            health,
            ..WheelEstimate::NOTHING
        };
        let heard_ns = self.heard_until(index, now_ns);
        let (Some((rim, until_ns)), Some(silence)) = (wheel.rim, wheel.silence(heard_ns)) else {
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
            motion: Some(match measured.motion {
                // one window is noisier than the slip
                Motion::Driving | Motion::Braking if slip < 0.0 => Motion::Braking,
                Motion::Driving | Motion::Braking => Motion::Driving,
                other => other,
            }),
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

    /// Up to when a wheel's silence is known: where none of its readings waits, up to the newest sample of any sensor.
    fn heard_until(&self, index: usize, now_ns: i64) -> i64 {
        match self.order.newest_ns() {
            Some(newest) if self.wheels[index].waiting == 0 => newest.max(now_ns),
            _ => now_ns,
        }
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
        let blocked = (self.blocked || self.disputed) && !wheel.free;
        if measured.slip.is_none() && !(blocked && measured.motion == Motion::RollBack) {
            return measured.health;
        }
        if blocked
            || self.checks[index].misses_pulses
            || self.contradicted.has_failed()
            || (moves && wheel.stillness(now_ns) > 0.0)
        {
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
}
