//! A free wheel in the filter: a reference that is itself watched, for it may skid, jam or lose the ground.

use grouser_real::Real;

use super::motion_model::{self, FORWARD, FORWARD_BIAS, own_slip};
use super::wheel_update::Window;
use super::{ALONE, RETURNS, SlipFilter};
use crate::history::seconds_between;

/// A free wheel whose skid is less certain than this is no reference.
const SKID_KNOWN: f64 = 0.1;
/// No free wheel's skid is in more doubt than this.
const MOST_DOUBT: f64 = 0.25;
/// For this long after its jump a free wheel's skid is learnt from what was known of the robot's speed, s.
const SETTLES: f64 = 0.3;
/// Only if all was well for this long before (s), and the accelerometer no worse than this many times what was told; and no
/// better than to this share of it.
const CALM: f64 = 1.0;
const RESTLESS: f64 = 2.0;
const JUMP_KNOWN: f64 = 0.25;
/// What a free wheel's speed was is remembered from this long before it stands, at least, s; a stop is unforeseen where the robot
/// should still be faster than so many sigma.
const REMEMBERED: f64 = 0.3;
const UNFELT: f64 = 2.0;
/// A free wheel faster than this turns for certain, m/s.
const TURNS: f64 = 0.04;

/// How a free wheel has been rolling.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rolling {
    /// It has turned since the robot stood.
    pub(super) has_turned: bool,
    /// It came to stand as was expected of it: not a wheel that stopped of itself.
    pub(super) stop_known: bool,
    /// Its speed last jumped unforeseen, ns.
    jumped_ns: Option<i64>,
    /// It has been as expected since, ns; and was so for long before it was not.
    calm_since_ns: Option<i64>,
    was_calm: bool,
    /// What was known of its speed while it turned, the older first.
    known: [Option<Known>; 2],
}

/// A speed along the wheel (m/s) at a time, its variance, and what the accelerometer had felt in all by then.
#[derive(Clone, Copy, Debug)]
struct Known {
    time_ns: i64,
    speed: f64,
    variance: f64,
    felt: f64,
}

impl Default for Rolling {
    fn default() -> Self {
        Self {
            has_turned: false,
            stop_known: true,
            jumped_ns: None,
            calm_since_ns: None,
            was_calm: false,
            known: [None; 2],
        }
    }
}

impl Rolling {
    /// Its rim runs at this speed, m/s.
    pub(super) fn runs(&mut self, rim: f64) {
        self.has_turned |= rim.abs() > TURNS;
    }

    /// The robot stands with all its wheels.
    pub(super) const fn stands(&mut self) {
        self.has_turned = false;
        self.stop_known = true;
    }

    fn note(&mut self, w: &Window, felt_unrest: f64) {
        if !w.is_off {
            self.calm_since_ns.get_or_insert(w.to_ns);
        } else if let Some(since) = self.calm_since_ns.take() {
            self.was_calm = seconds_between(since, w.to_ns) >= CALM && felt_unrest < RESTLESS;
        }
    }
}

impl SlipFilter {
    /// A free wheel's skid is not learnt from the robot's speed, unless something else tells that, or it has just jumped.
    pub(super) fn consider_skid(&mut self, index: usize, to_ns: i64) {
        let told = self.reference.accepted_ns;
        let alone = told.is_none_or(|then| seconds_between(then, to_ns) > ALONE);
        let rolling = &mut self.wheels[index].rolling;
        let jumped = rolling
            .jumped_ns
            .is_some_and(|then| seconds_between(then, to_ns) <= SETTLES);
        self.state.set_considered(own_slip(index), alone && !jumped);
        if !jumped && rolling.jumped_ns.take().is_some() {
            // the robot's speed was known less well than it seemed
            let off = self.state.mean(own_slip(index)) - self.settings.free_slip.by_rim().mean;
            let doubt = JUMP_KNOWN * off;
            self.state
                .inflate(own_slip(index), doubt * doubt, doubt * doubt);
        }
    }

    /// Notes how fast a free wheel turned; and when it comes to stand, whether that was felt.
    fn watch_stop(&mut self, w: &Window) {
        let walk = self.walk();
        let bias = self.state.covariance(FORWARD_BIAS, FORWARD_BIAS);
        let felt = self.totals[0];
        let variance = self
            .state
            .variance_of(&motion_model::along(self.wheels[w.index].row));
        let wheel = &mut self.wheels[w.index];
        let turns = wheel.turns();
        let rolling = &mut wheel.rolling;
        if turns {
            rolling.stop_known = true;
            let aged = rolling.known[1]
                .is_none_or(|known| seconds_between(known.time_ns, w.to_ns) >= REMEMBERED);
            if aged {
                let now = Known {
                    time_ns: w.to_ns,
                    speed: w.forward,
                    variance,
                    felt,
                };
                rolling.known = [rolling.known[1], Some(now)];
            }
            return;
        }
        let [older, newer] = core::mem::take(&mut rolling.known);
        if let Some(then) = older.or(newer) {
            let passed = seconds_between(then.time_ns, w.to_ns);
            let expected = then.speed + felt - then.felt;
            let doubt = then.variance + (walk * walk + bias * passed) * passed;
            let most = UNFELT * Real::sqrt(doubt) + self.settings.low_speed;
            rolling.stop_known &= expected.abs() <= most;
        }
    }

    /// A free wheel's window against the rest: is it to be taken? It is watched, and what may be wrong is made less certain.
    pub(super) fn free_counts(&mut self, w: &Window) -> bool {
        // One that failed comes back where it is near what the others say. Where these have no reference left either, what
        // they say is worth no more than what is believed of slip: then it may be anywhere near that, and its skid stays in
        // doubt for a while.
        let gap = (w.rim - w.forward).abs() - self.settings.low_speed;
        let near = gap <= RETURNS * w.faster.abs();
        if w.is_off && self.blocked && w.shows && self.is_plausible(w.rim) {
            // that the robot stood was known from this wheel alone
            self.begin_from(w.rim);
            return false;
        }
        let had_failed = self.wheels[w.index].watch.has_failed();
        self.watch_stop(w);
        let wheel = &self.wheels[w.index];
        let agreed = if !wheel.turns() && !wheel.rolling.stop_known {
            false
        } else if had_failed {
            near || self.is_lost(w.to_ns) && self.is_plausible(w.rim)
        } else {
            !w.is_off
        };
        let watch = &mut self.wheels[w.index].watch;
        let believed = watch.judge(w.to_ns, agreed, self.settings.failure);
        if had_failed && believed && !near {
            let confirmed = self.agrees_with_camera(w.rim, w.to_ns);
            self.begin_from(w.rim);
            let doubt = 1.5 * SKID_KNOWN * SKID_KNOWN;
            if !confirmed {
                self.state.inflate(own_slip(w.index), doubt, doubt);
            }
            return false;
        }
        let wheel = &mut self.wheels[w.index];
        let was_off = core::mem::replace(&mut wheel.was_off, w.is_off);
        wheel.rolling.note(w, self.felt_unrest);
        if w.is_off && was_off && w.shows && w.rim != 0.0 {
            // The robot's speed has changed unfelt, or the wheel skids, or no longer does: from now on both are less certain.
            // That the wheel runs ahead of the robot cannot be: nothing drives it.
            self.state.inflate(FORWARD, w.residual * w.residual, 1e4);
            let doubted = motion_model::is_doubted(&self.state, &self.settings, w.index);
            if w.residual * w.rim < 0.0 || doubted {
                let step = (w.residual / w.faster).clamp(-MOST_DOUBT, MOST_DOUBT);
                self.state
                    .inflate(own_slip(w.index), step * step, step * step);
                let rolling = &mut self.wheels[w.index].rolling;
                rolling.jumped_ns = rolling.was_calm.then_some(w.to_ns);
            }
        }
        self.learn_felt(w.residual, w.variance);
        let known = self.state.sigma(own_slip(w.index)) < SKID_KNOWN && !self.is_lost(w.to_ns);
        let wheel = &mut self.wheels[w.index];
        if !wheel.turns() && (!known || w.is_off) {
            wheel.rolling.stop_known = false;
        }
        if !agreed || !believed {
            return false;
        }
        if self.state.sigma(own_slip(w.index)) < SKID_KNOWN {
            self.reference_ns = Some(w.to_ns);
        }
        true
    }
}
