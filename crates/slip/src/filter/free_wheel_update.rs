//! A free wheel as a reference that is itself watched: it may skid, jam or lose the ground.

use grouser_real::Real;

use super::estimator::Core;
use super::motion_model::{self, COMMON_SLIP, FORWARD, FORWARD_BIAS, own_slip};
use super::rolling_history::KnownSpeed;
use super::wheel_update::WheelWindow;
use super::{READMIT_SPEED_SHARE, REFERENCE_TIMEOUT_S};
use crate::history::seconds_between;

/// A free wheel whose skid has a larger standard deviation is no reference.
const MAX_SKID_SIGMA: f64 = 0.1;
/// The largest standard deviation that one jump adds to a skid.
const MAX_SKID_STEP: f64 = 0.25;
/// After a jump a free wheel's skid is learnt from the robot's speed for this long, s.
const LEARN_AFTER_JUMP_S: f64 = 0.3;
/// A skid learnt after a jump is known to this share of it: the robot's speed was known less well than its sigma.
const SKID_AFTER_JUMP_SHARE: f64 = 0.25;
/// A stop is unexpected where the robot should still be faster than this many sigma.
const UNEXPECTED_STOP_SIGMA: f64 = 2.0;
/// The robot's speed after an unexpected change has at most this variance, m²/s².
const MAX_SPEED_VARIANCE: f64 = 1e4;

impl Core {
    /// Considers a free wheel's skid instead of estimating it, unless another reference measures the robot's speed or the
    /// wheel has just jumped.
    pub(super) fn consider_skid(&mut self, index: usize, to_ns: i64) {
        let alone = self
            .reference
            .accepted_ns
            .is_none_or(|then| seconds_between(then, to_ns) > REFERENCE_TIMEOUT_S);
        let rolling = &mut self.wheels.channels[index].rolling;
        let jumped = rolling
            .jumped_ns
            .is_some_and(|then| seconds_between(then, to_ns) <= LEARN_AFTER_JUMP_S);
        self.state.set_considered(own_slip(index), alone && !jumped);
        if !jumped && rolling.jumped_ns.take().is_some() {
            let off = self.state.mean(own_slip(index)) - self.settings.free_slip.by_wheel().mean;
            let doubt = SKID_AFTER_JUMP_SHARE * off;
            self.state.raise_variance(own_slip(index), doubt * doubt);
        }
    }

    /// Records how fast a free wheel turns; while it does not, whether the accelerometer explains that: a wheel that jams
    /// stops of itself, and one that jammed while the robot was stuck does not start with it.
    fn watch_stop(&mut self, w: &WheelWindow) {
        let density = self.process_noise_density();
        let bias = self.state.covariance(FORWARD_BIAS, FORWARD_BIAS);
        let accel_integral = self.path.forward_integral();
        let wheel = &mut self.wheels.channels[w.index];
        let variance = self.state.variance_of(&motion_model::along(wheel.row));
        let now = KnownSpeed {
            time_ns: w.to_ns,
            speed: w.forward,
            variance,
            accel_integral,
        };
        if wheel.turns() {
            wheel.rolling.turns(now);
        } else {
            if let Some(then) = wheel.rolling.known_before() {
                let passed = seconds_between(then.time_ns, w.to_ns);
                let expected = then.speed + accel_integral - then.accel_integral;
                let variance = then.variance + (density * density + bias * passed) * passed;
                let limit = UNEXPECTED_STOP_SIGMA * Real::sqrt(variance) + self.settings.low_speed;
                wheel.rolling.stop_expected &= expected.abs() <= limit;
            }
            wheel.rolling.rests(now);
        }
    }

    /// Gates a free wheel's window, and inflates the variance of what may be wrong.
    pub(super) fn accepts_free_window(&mut self, w: &WheelWindow) -> bool {
        // A wheel that failed is readmitted near the speed of the others. Where these have no reference either, any speed
        // that the prior of slip allows will do, and its skid stays uncertain.
        let gap = (w.rim - w.forward).abs() - self.settings.low_speed;
        let near = gap <= READMIT_SPEED_SHARE * w.faster.abs();
        if w.is_off && self.recovery.is_blocked && w.has_slip && self.is_plausible(w.rim) {
            // this wheel alone showed that the robot stood
            self.restart_from(w.rim);
            return false;
        }
        let had_failed = self.wheels.channels[w.index].monitor.has_failed();
        self.watch_stop(w);
        // a wheel that is known to miss pulses measures nothing beside a sensor that does not
        if self.output.checks[w.index].misses_pulses && !self.is_alone(w.to_ns) {
            return false;
        }
        let wheel = &self.wheels.channels[w.index];
        let agreed = if !wheel.turns() && !wheel.rolling.stop_expected {
            false
        } else if had_failed {
            near || self.is_lost(w.to_ns) && self.is_plausible(w.rim)
        } else {
            !w.is_off
        };
        let patience = self.settings.failure;
        let monitor = &mut self.wheels.channels[w.index].monitor;
        let trusted = monitor.record(w.to_ns, agreed, patience);
        if had_failed && trusted && !near {
            let confirmed = self.agrees_with_sensor(w.rim, w.to_ns);
            self.restart_from(w.rim);
            let doubt = 1.5 * MAX_SKID_SIGMA * MAX_SKID_SIGMA;
            if !confirmed {
                self.state.raise_variance(own_slip(w.index), doubt);
            }
            return false;
        }
        let wheel = &mut self.wheels.channels[w.index];
        let was_off = core::mem::replace(&mut wheel.was_off, w.is_off);
        wheel.rolling.record(w, self.accelerometer.noise_scale);
        if w.is_off && was_off && w.has_slip && w.rim != 0.0 {
            self.doubt_after_jump(w);
        } else {
            self.end_jump(w);
        }
        self.attribute(w, agreed && trusted);
        let skid_known = self.state.sigma(own_slip(w.index)) < MAX_SKID_SIGMA;
        let known = skid_known && !self.is_lost(w.to_ns);
        let wheel = &mut self.wheels.channels[w.index];
        if !wheel.turns() && (!known || w.is_off) {
            wheel.rolling.stop_expected = false;
        }
        if !agreed || !trusted {
            return false;
        }
        if skid_known {
            self.speed_known_ns = Some(w.to_ns);
        }
        true
    }

    /// The robot's speed has changed without the accelerometer, or the wheel begins or ends a skid: both become less
    /// certain. No motor drives the wheel, so that it does not run ahead of the robot.
    fn doubt_after_jump(&mut self, w: &WheelWindow) {
        self.state
            .inflate(FORWARD, w.innovation * w.innovation, MAX_SPEED_VARIANCE);
        let doubted = motion_model::is_doubted(&self.state, &self.settings, w.index);
        if w.innovation * w.rim < 0.0 || doubted {
            let step = (w.innovation / w.faster).clamp(-MAX_SKID_STEP, MAX_SKID_STEP);
            let rolling = &mut self.wheels.channels[w.index].rolling;
            if !doubted {
                let slip = own_slip(w.index);
                rolling.jumps(
                    w,
                    (self.state.mean(slip), self.state.covariance(slip, slip)),
                );
            }
            self.state.raise_variance(own_slip(w.index), step * step);
            rolling.jumped_ns = rolling.was_calm.then_some(w.to_ns);
        }
    }

    /// Attributes the innovation of a window to the powered wheels' common slip, which has changed by about as much, where their
    /// innovations oppose it or the free wheel stands while they turn; else to the accelerometer.
    fn attribute(&mut self, w: &WheelWindow, is_used: bool) {
        let settings = &self.settings;
        let rims = self.wheels.mean_powered_rim(w.to_ns, settings.dropout);
        let rims = rims.filter(|rims| rims.abs() > settings.low_speed);
        let mean_weight = self.wheels.mean_weight;
        let wheel = &mut self.wheels.channels[w.index];
        if is_used && w.has_slip {
            wheel.mean_innovation += mean_weight * (w.clamped_innovation() - wheel.mean_innovation);
        } else {
            wheel.mean_innovation = 0.0;
        }
        let stands = is_used && !wheel.turns();
        match rims {
            Some(rims) if stands || self.wheels.slips_oppose(w.index) => {
                let step = w.innovation / rims;
                self.state.inflate(COMMON_SLIP, step * step, 1.0);
            }
            _ => self.accelerometer.learn_noise(w.innovation, w.variance),
        }
    }

    /// A wheel that turns as before soon after a jump has crossed a bump or a rut: its skid is what it was.
    fn end_jump(&mut self, w: &WheelWindow) {
        let accel_integral = self.path.forward_integral();
        let rolling = &mut self.wheels.channels[w.index].rolling;
        if let Some((mean, variance)) = rolling.returns(w, accel_integral) {
            self.state.reset(own_slip(w.index), mean, variance);
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
