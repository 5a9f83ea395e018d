//! One window of one wheel as a statement about robot, slips and ticks.

use grouser_real::Real;

use super::motion_model::{COMMON_SLIP, FORWARD, GYRO_BIAS, LEFT, YAW, along, own_slip, radius, remainder};
use super::kalman::ScalarMeasurement;
use super::settings::SlipPrior;
use super::wheel_channel::Tracked;
use super::{BREAKS, CREEP, LEARNING, MAX_FILTER_WHEELS, PULLED, SlipFilter, UNREST, WRONG};
use crate::fault::Fault;
use crate::history::{nanoseconds, seconds_between};
use crate::sample::Measurement;
use crate::speed::Measured;

/// A robot whose wheels turn it faster than this is in a bend, rad/s.
pub(super) const BEND: f64 = 0.03;

/// What one window of a wheel came to.
pub(super) struct Window {
    pub(super) index: usize,
    pub(super) to_ns: i64,
    /// Rim speed and the robot's speed along the wheel, m/s, and the faster of the two.
    pub(super) rim: f64,
    pub(super) forward: f64,
    pub(super) faster: f64,
    pub(super) residual: f64,
    pub(super) variance: f64,
    /// Is the residual beyond the gate?
    pub(super) is_off: bool,
    /// Is it fast enough for a slip?
    pub(super) shows: bool,
}

impl SlipFilter {
    pub(super) fn take_wheel(
        &mut self,
        time_ns: i64,
        index: usize,
        measurement: &Measurement,
    ) -> core::result::Result<(), Fault> {
        let wheels = self.wheels.len();
        let wheel = self
            .wheels
            .get_mut(index)
            .ok_or(Fault::UnknownWheel { index, wheels })?;
        wheel.track.take(time_ns, measurement)?;
        if wheel.track.counts() {
            wheel.pulses.take(time_ns, wheel.track.travel());
        }
        let Some((rim, from_ns)) = wheel.window(time_ns, self.settings.wheel_window) else {
            return Ok(());
        };
        self.take_rim(index, rim, from_ns, time_ns);
        Ok(())
    }

    /// The robot's mean speed along `row` from `from_ns` to `to_ns` by the filter itself: what it is now, less what was
    /// felt of its change since. Past estimates would bring back what the measurements since have put right.
    pub(super) fn mean_along(&self, row: [f64; 3], from_ns: i64, to_ns: i64) -> f64 {
        let mut mean = [FORWARD, LEFT, YAW].map(|i| self.state.mean(i));
        let window = seconds_between(from_ns, to_ns);
        let middle = to_ns.saturating_sub(nanoseconds(0.5 * window));
        if let Some(then) = self.path.at(middle) {
            mean[0] -= self.totals[0] - then[0];
            mean[1] -= self.totals[1] - then[1];
        }
        if let Some([_, _, turned]) = self.path.between(from_ns, to_ns)
            && window > 0.0
        {
            mean[2] += turned / window - self.turning;
        }
        crate::body::dot(row, mean)
    }

    pub(super) fn take_rim(&mut self, index: usize, rim: Measured, from_ns: i64, to_ns: i64) {
        let Tracked { row, free, .. } = self.wheels[index];
        let level = self.mean_along(row, from_ns, to_ns);
        let (forward, longer) = self.wheels[index].carrier.over_ground(level, row[0], to_ns);
        let grown = self.state.mean(radius(index));
        let u = rim.value * (1.0 + grown);
        let slip = self.slip_mean(index);
        // the branch goes by the slip, not by which of two noisy speeds happens to be greater, unless they leave no doubt
        let excess = forward.abs() - u.abs();
        let doubt = 3.0 * (self.state.sigma(FORWARD) + rim.sigma());
        let braking = !free && (excess > doubt || (slip < 0.0 && excess > -doubt));
        let faster = if braking { forward } else { u };
        // what the rim has beyond the robot, as a share of the faster of the two
        let by_speed = if braking {
            1.0 + slip.clamp(-1.0, 0.0)
        } else {
            1.0
        };
        // near standstill a slip is no number
        let shows = faster.abs() > self.settings.low_speed;
        // The slope by the slip comes from the readings before: that of this one would share its error, and its square
        // would draw the slip upwards reading by reading.
        let usual = if braking {
            forward
        } else {
            self.wheels[index].usual_rim()
        };
        self.wheels[index].remember(u);
        if !shows {
            self.wheels[index].pull = 0.0;
        }
        let mut slopes = [(FORWARD, 0.0); 8];
        slopes[..3].copy_from_slice(&along(row.map(|part| by_speed * longer * part)));
        slopes[3] = (COMMON_SLIP, if free { 0.0 } else { usual });
        slopes[4] = (own_slip(index), usual);
        slopes[5] = (radius(index), -rim.value);
        // the mean over the window, where the robot's speed has wandered since
        let walk = self.walk();
        let wandered = walk * walk * seconds_between(from_ns, to_ns) / 3.0;
        let window = seconds_between(from_ns, to_ns);
        let (odd, begun) = self.remainders(index);
        slopes[6] = (remainder(index, odd), -1.0 / window);
        slopes[7] = (remainder(index, !odd), 1.0 / window);
        let remainders = self.state.mean(remainder(index, !odd)) / window;
        let tick = self.wheels[index].tick;
        let counted = begun * tick * tick / 6.0 / (window * window);
        // Where the rim starts, that slope is too small and would carry the slip beyond: what it lacks counts as noise.
        let lacking = (faster * faster - usual * usual).max(0.0)
            * self.state.variance_of(&self.slip_slopes(index));
        let seen = ScalarMeasurement {
            jacobian: &slopes,
            residual: u - forward - slip * faster - remainders,
            variance: (rim.variance - counted).max(0.0) + wandered + lacking + CREEP * CREEP,
        };
        if free {
            self.consider_skid(index, to_ns);
        }
        let (residual, variance) = self.state.innovation(&seen);
        self.wheels[index].remainder = Some(odd);
        let off = residual.abs() > self.settings.gate * Real::sqrt(variance);
        let still = self.wheels[index].stillness(to_ns) >= WRONG;
        let against = rim.value * forward < 0.0
            && forward.abs() > 3.0 * self.state.sigma(FORWARD) + self.settings.low_speed
            && rim.value.abs() > self.settings.low_speed;
        let wheel = &mut self.wheels[index];
        let since = wheel.against_since_ns.unwrap_or(to_ns);
        wheel.against_since_ns = against.then_some(since);
        let window = Window {
            index,
            to_ns,
            rim: u,
            forward,
            faster,
            residual,
            variance,
            is_off: off,
            shows,
        };
        let taken = if free {
            self.free_counts(&window)
        } else {
            let stands_wrongly = still && off;
            !(against || stands_wrongly || shows && !self.powered_counts(&window))
        };
        if !taken {
            return;
        }
        self.enter(free, &seen, to_ns);
        let most = if free {
            // nothing drives it
            let SlipPrior { mean, sigma } = self.settings.free_slip.by_rim();
            mean + 3.0 * sigma
        } else {
            2.0
        };
        let held = self.state.mean(own_slip(index)).clamp(-2.0, most);
        self.state.set_mean(own_slip(index), held);
        let held = self.state.mean(COMMON_SLIP).clamp(-1.0, 1.0);
        self.state.set_mean(COMMON_SLIP, held);
    }

    /// A wheel's statement enters. In a bend the sides slip differently for long: that is no turning, and no bias of the gyro,
    /// where there is one.
    fn enter(&mut self, free: bool, seen: &ScalarMeasurement<'_>, to_ns: i64) {
        let bends = !free
            && self.gyro_is_believed(to_ns)
            && self.turn_by_wheels().is_some_and(|turn| turn.abs() > BEND);
        for i in [YAW, GYRO_BIAS] {
            self.state.set_considered(i, bends);
        }
        self.nis = self.state.update(seen);
        for i in [YAW, GYRO_BIAS] {
            self.state.set_considered(i, false);
        }
    }

    /// Are most powered wheels off to one side, and the middle one by much? One alone, however far, is its own affair.
    fn break_away_together(&self) -> bool {
        let mut pulls = [0.0; MAX_FILTER_WHEELS];
        let mut count = 0;
        for wheel in self.wheels.iter().filter(|wheel| !wheel.free) {
            pulls[count] = wheel.pull;
            count += 1;
        }
        let pulls = &mut pulls[..count];
        pulls.sort_unstable_by(f64::total_cmp);
        let (Some(low), Some(high)) = (pulls.get((count.max(1) - 1) / 2), pulls.get(count / 2))
        else {
            return false;
        };
        let middle = 0.5 * (low + high);
        let most = pulls
            .iter()
            .filter(|pull| **pull * middle > 0.5 * PULLED * middle.abs());
        middle.abs() > PULLED && 2 * most.count() > count
    }

    /// A powered wheel's window against the rest: is it to be taken? One that breaks away gets another slip instead.
    fn powered_counts(&mut self, w: &Window) -> bool {
        if w.is_off && !core::mem::replace(&mut self.wheels[w.index].was_off, true) {
            // once may be the play of its gears
            return false;
        }
        let expected = Real::sqrt(w.variance);
        let r = (w.residual / expected).clamp(-BREAKS, BREAKS);
        self.wheels[w.index].pull += self.sharing * (r - self.wheels[w.index].pull);
        // sigmas that fit what is seen: residuals larger than they should be are slips that wander more
        let learnt = Real::exp(LEARNING * (r * r - 1.0));
        let unrest = &mut self.wheels[w.index].unrest;
        *unrest = (*unrest * learnt).clamp(UNREST.0, UNREST.1);
        let step = w.residual / w.faster;
        if self.break_away_together() {
            // the ground is another one
            self.state.inflate(COMMON_SLIP, step * step, 1.0);
        }
        if w.is_off {
            // It has broken away: its own slip is another one, and its rim says nothing of the robot's speed.
            let own = self.state.mean(own_slip(w.index)) + step;
            let spread = 2.0 * self.settings.wheel_slip_sigma;
            self.state
                .reset(own_slip(w.index), own.clamp(-2.0, 2.0), spread * spread);
            self.nis = w.residual * w.residual / w.variance;
            return false;
        }
        self.wheels[w.index].was_off = false;
        true
    }

    /// The counter shows whole ticks: what it does not show at a window's end it shows in the next. Gives which remainder
    /// is the new one, and 1 where remainders stand for the ticks' share of the variance, else 0.
    pub(super) fn remainders(&mut self, index: usize) -> (bool, f64) {
        let wheel = &self.wheels[index];
        let tick = if wheel.track.counts() {
            wheel.tick
        } else {
            0.0
        };
        let variance = tick * tick / 12.0;
        let odd = wheel.remainder.is_some_and(|last| !last);
        if wheel.remainder.is_none() {
            self.state.reset(remainder(index, !odd), 0.0, variance);
        }
        self.state.reset(remainder(index, odd), 0.0, variance);
        (odd, f64::from(u8::from(tick > 0.0)))
    }

    pub(super) fn slip_slopes(&self, index: usize) -> [(usize, f64); 2] {
        let common = if self.wheels[index].free { 0.0 } else { 1.0 };
        [(COMMON_SLIP, common), (own_slip(index), 1.0)]
    }

    pub(super) fn slip_mean(&self, index: usize) -> f64 {
        self.slip_slopes(index)
            .iter()
            .map(|&(i, a)| a * self.state.mean(i))
            .sum()
    }
}
