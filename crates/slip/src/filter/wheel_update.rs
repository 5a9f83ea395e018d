//! The update by one window of a wheel: u (1 + ρ) = v + s m, with the remainders of its ticks.

use grouser_real::Real;

use super::estimator::Core;
use super::ground_track::GroundTrack;
use super::gyro_monitor::BEND_YAW_RATE_RAD_PER_S;
use super::kalman::ScalarMeasurement;
use super::motion_model::{
    COMMON_SLIP, FORWARD, GYRO_BIAS, LEFT, YAW, along, own_slip, radius, remainder,
};
use super::{INNOVATION_CLAMP_SIGMA, WRONG_ENCODER_TIME_S};
use crate::fault::Fault;
use crate::history::seconds_between;
use crate::sample::Measurement;
use crate::speed::Measured;

/// Rim and robot differ by this for other reasons than slip, m/s: play, tyres, an uneven floor.
const RIM_CREEP_M_PER_S: f64 = 5e-4;
/// How fast a wheel's noise scale is learnt, per window. Four times as fast made four runs in ten thousand wrong for more
/// than a second while they were Ok, where half of the wheels left a soft patch (`faults_ground` of the generator's crate).
const NOISE_SCALE_GAIN: f64 = 0.005;
/// Limits of the noise scale.
const NOISE_SCALE_LIMITS: (f64, f64) = (0.1, 100.0);
/// No slip as the rim over the robot's speed is larger than this, either way.
const MAX_OWN_SLIP: f64 = 2.0;

/// One window of a wheel against the rest of the state.
pub(super) struct WheelWindow {
    pub(super) index: usize,
    pub(super) to_ns: i64,
    /// Rim speed, the robot's speed along the wheel, and the faster of the two, m/s.
    pub(super) rim: f64,
    pub(super) forward: f64,
    pub(super) faster: f64,
    pub(super) innovation: f64,
    pub(super) variance: f64,
    /// Is the innovation beyond the gate?
    pub(super) is_off: bool,
    /// Is it fast enough for a slip?
    pub(super) has_slip: bool,
}

impl WheelWindow {
    /// The innovation in sigma, clamped.
    pub(super) fn clamped_innovation(&self) -> f64 {
        let limit = INNOVATION_CLAMP_SIGMA;
        (self.innovation / Real::sqrt(self.variance)).clamp(-limit, limit)
    }
}

/// The speed of a robot whose speed changes within a window as the settings say, m/s.
const FULL_CHANGE_M_PER_S: f64 = 0.15;
/// Readings further apart are sparse, s: at 0.5 m/s² a speed changes by 0.025 m/s.
const SPARSE_S: f64 = 0.05;

/// Rim speed and time of a window.
#[derive(Clone, Copy)]
struct Span {
    rim: Measured,
    from_ns: i64,
    to_ns: i64,
}

impl Core {
    /// After the readings of a moment: predicts the motion over the ground, and updates the state by the windows that have ended.
    /// Before the last of them the rims' way is not known: a wheel's own slip would hold what the others have not reported yet.
    pub(super) fn settle_rims(&mut self) {
        let Some(now_ns) = self.now_ns.filter(|_| self.ground.is_some()) else {
            return;
        };
        if !self.is_sparse(now_ns) {
            self.predict_ground_motion(now_ns);
            let last_ns = self
                .ground
                .as_deref()
                .and_then(GroundTrack::last_awaiting_ns);
            if last_ns.is_some_and(|stamp_ns| self.are_rims_read_since(stamp_ns)) {
                self.use_awaiting();
            }
        }
        for index in 0..self.wheels.channels.len() {
            let wheel = &mut self.wheels.channels[index];
            if !core::mem::take(&mut wheel.has_ended) {
                continue;
            }
            if let (Some((rim, _)), Some((from_ns, to_ns))) = (wheel.rim, wheel.rim_span()) {
                let span = Span {
                    rim,
                    from_ns,
                    to_ns,
                };
                self.update_rim(index, span);
            }
        }
    }

    /// [`Core::settle_rims`] where wheels have been read at `now_ns`, and nothing that came with them before is still to come.
    pub(super) fn settle_whole_row(&mut self, now_ns: i64) {
        let awaits = |ground: &GroundTrack| ground.force.awaits(now_ns);
        let is_whole = self.wheels.is_whole_row(now_ns);
        if is_whole && !self.ground.as_deref().is_some_and(awaits) {
            self.settle_rims();
        }
    }

    /// Is the last reading of every powered wheel so old that the rims' speed may have changed since? The motion over the ground
    /// then waits for the next reading instead of continuing at the speed before.
    pub(super) fn is_sparse(&self, time_ns: i64) -> bool {
        let powered = self.wheels.powered();
        powered
            .filter(|wheel| wheel.is_led_on(time_ns))
            .filter_map(|wheel| wheel.silence(time_ns))
            .reduce(f64::min)
            .is_some_and(|silence| silence >= SPARSE_S)
    }

    /// Adds a reading of a wheel's rotation, and updates the state where it ends a window.
    pub(super) fn update_wheel(
        &mut self,
        to_ns: i64,
        index: usize,
        measurement: &Measurement,
    ) -> Result<(), Fault> {
        let wheel = self.wheels.get_mut(index)?;
        wheel.read_before_ns = wheel.track.newest_time().unwrap_or(i64::MIN);
        wheel.track.take(to_ns, measurement)?;
        if let Measurement::WheelRate { rate, .. } = *measurement {
            wheel.repeated.push(to_ns, rate);
        }
        if wheel.track.counts() {
            wheel.pulses.update(to_ns, wheel.track.travel());
        }
        let ended = wheel.window(to_ns, self.settings.wheel_window);
        let span = ended.map(|(rim, from_ns)| Span {
            rim,
            from_ns,
            to_ns,
        });
        if self.ground.is_some() {
            wheel.has_ended = span.is_some();
            self.settle_whole_row(to_ns);
        } else if let Some(span) = span {
            self.update_rim(index, span);
        }
        Ok(())
    }

    /// The robot's mean speed along `row` over a window, m/s. Where the motion over the ground leads, it is the rims' own
    /// less the present slip: a change of the common slip within the window is no wheel's own.
    fn level_speed(&self, row: [f64; 3], from_ns: i64, to_ns: i64) -> f64 {
        let ground = self.ground.as_ref().filter(|_| self.is_led);
        match ground.and_then(|ground| ground.mean_motion((from_ns, to_ns), &self.settings)) {
            Some([forward, left]) => {
                let turn = self.path.mean_yaw_rate(&self.state, from_ns, to_ns);
                crate::body::dot(row, [forward, left, turn])
            }
            None => self.path.mean_along(&self.state, row, from_ns, to_ns),
        }
    }

    /// How fast the robot's speed changes within a window, as a share of the settings' process noise: where the motion over the ground
    /// is known, a robot that is never fast gains and loses little.
    fn share_of_change(&self, index: usize) -> f64 {
        if self.is_led {
            (self.wheels.channels[index].top_rim() / FULL_CHANGE_M_PER_S).min(1.0)
        } else {
            1.0
        }
    }

    fn update_rim(&mut self, index: usize, span: Span) {
        let Span {
            rim,
            from_ns,
            to_ns,
        } = span;
        let level = self.level_speed(self.wheels.channels[index].row, from_ns, to_ns);
        let wheel = &mut self.wheels.channels[index];
        let (row, free, tick) = (wheel.row, wheel.free, wheel.tick);
        let (forward, longer) = wheel.carrier.over_ground(level, row[0], to_ns);
        let u = rim.value * (1.0 + self.state.mean(radius(index)));
        let slip_row = wheel.slip_row(index);
        let slip = self.state.mean_of(&slip_row);
        // The branch follows the estimated slip, unless the two noisy speeds leave no doubt.
        let excess = forward.abs() - u.abs();
        let doubt = 3.0 * (self.state.sigma(FORWARD) + rim.sigma());
        let braking = !free && (excess > doubt || (slip < 0.0 && excess > -doubt));
        let faster = if braking { forward } else { u };
        let by_speed = if braking {
            1.0 + slip.clamp(-1.0, 0.0)
        } else {
            1.0
        };
        let has_slip = faster.abs() > self.settings.low_speed;
        // The derivative by the slip is made of earlier windows: that of this one would share its error, and the square of
        // the error would raise the slip reading by reading.
        let earlier = if braking {
            forward
        } else {
            wheel.smoothed_rim()
        };
        wheel.smooth(u);
        if !has_slip {
            wheel.mean_innovation = 0.0;
        }
        let mut jacobian = [(FORWARD, 0.0); 8];
        jacobian[..3].copy_from_slice(&along(row.map(|part| by_speed * longer * part)));
        jacobian[3] = (COMMON_SLIP, if free { 0.0 } else { earlier });
        jacobian[4] = (own_slip(index), earlier);
        jacobian[5] = (radius(index), -rim.value);
        // The rim speed is the mean over the window, during which the robot's speed has changed.
        let density = self.process_noise_density() * self.share_of_change(index);
        let window = seconds_between(from_ns, to_ns);
        let changed = density * density * window / 3.0;
        let (odd, counts) = self.begin_remainder(index);
        jacobian[6] = (remainder(index, odd), -1.0 / window);
        jacobian[7] = (remainder(index, !odd), 1.0 / window);
        let remainders = self.state.mean(remainder(index, !odd)) / window;
        let counted = counts * tick * tick / 6.0 / (window * window);
        // Where the rim starts, the earlier derivative is too small and would overshoot: the difference counts as noise.
        let lacking = (faster * faster - earlier * earlier).max(0.0)
            * self
                .state
                .variance_of(&self.wheels.channels[index].slip_row(index));
        let measured = ScalarMeasurement {
            jacobian: &jacobian,
            residual: u - forward - slip * faster - remainders,
            variance: (rim.variance - counted).max(0.0)
                + changed
                + lacking
                + RIM_CREEP_M_PER_S * RIM_CREEP_M_PER_S,
        };
        if free {
            self.consider_skid(index, to_ns);
        }
        let (innovation, variance) = self.state.innovation(&measured);
        let is_off = innovation.abs() > self.settings.gate * Real::sqrt(variance);
        let wheel = &mut self.wheels.channels[index];
        wheel.remainder = Some(odd);
        let still = wheel.stillness(to_ns) >= WRONG_ENCODER_TIME_S;
        // as far as the turn that moves its place backwards is not that of a wrong gyro
        let against = !self.gyro.contradicts_wheels()
            && rim.value * forward < 0.0
            && forward.abs() > 3.0 * self.state.sigma(FORWARD) + self.settings.low_speed
            && rim.value.abs() > self.settings.low_speed;
        let since = wheel.against_since_ns.unwrap_or(to_ns);
        wheel.against_since_ns = against.then_some(since);
        let window = WheelWindow {
            index,
            to_ns,
            rim: u,
            forward,
            faster,
            innovation,
            variance,
            is_off,
            has_slip,
        };
        let accepted = if free {
            self.accepts_free_window(&window)
        } else {
            let stands_wrongly = still && is_off;
            !(against || stands_wrongly || has_slip && !self.accepts_powered_window(&window))
        };
        if accepted {
            self.apply_window(&window, free, &measured);
        }
    }

    /// Updates the state. In a bend the sides slip differently for long: that is no turning and no bias of the gyro, where
    /// there is a gyro.
    fn apply_window(&mut self, w: &WheelWindow, free: bool, measured: &ScalarMeasurement<'_>) {
        let turn = || self.wheels.yaw_rate().map_or(0.0, f64::abs);
        let in_bend = !free
            && self.gyro.is_trusted(w.to_ns, &self.settings)
            && turn() > BEND_YAW_RATE_RAD_PER_S;
        // The motion over the ground is known by the reference: the window shows the wheel's own slip.
        let led = self.is_led;
        // Steered wheels see a sideways drift as unequal slips, as their prior does not have them: it is not learnt from them.
        let drifts = !free && self.drifts_downhill();
        let considered = [
            (YAW, in_bend || led),
            (GYRO_BIAS, in_bend || led),
            (FORWARD, led),
            (LEFT, led || drifts),
            (COMMON_SLIP, led),
        ];
        for (i, considered) in considered {
            self.state.set_considered(i, considered);
        }
        self.nis = self.state.update(measured);
        for (i, _) in considered {
            self.state.set_considered(i, false);
        }
        let (lowest, highest) = if free {
            // No motor drives it, so that it hardly runs ahead of the robot.
            let prior = self.settings.free_slip.by_wheel();
            let reach = 3.0 * prior.sigma;
            ((prior.mean - reach).min(-MAX_OWN_SLIP), prior.mean + reach)
        } else {
            (-MAX_OWN_SLIP, MAX_OWN_SLIP)
        };
        self.state.clamp_mean(own_slip(w.index), lowest, highest);
        self.state.clamp_mean(COMMON_SLIP, -1.0, 1.0);
    }

    /// Gates a powered wheel's window. A wheel that breaks away gets another slip instead of an update.
    fn accepts_powered_window(&mut self, w: &WheelWindow) -> bool {
        let mean_weight = self.wheels.mean_weight;
        let wheel = &mut self.wheels.channels[w.index];
        if w.is_off && !core::mem::replace(&mut wheel.was_off, true) {
            // a single window beyond the gate may be the play of gears
            return false;
        }
        let r = w.clamped_innovation();
        wheel.mean_innovation += mean_weight * (r - wheel.mean_innovation);
        // Innovations larger than their sigma mean that the slip changes faster than configured.
        let learnt = Real::exp(NOISE_SCALE_GAIN * (r * r - 1.0));
        let (low, high) = NOISE_SCALE_LIMITS;
        wheel.noise_scale = (wheel.noise_scale * learnt).clamp(low, high);
        let step = w.innovation / w.faster;
        if self.wheels.slips_change_together() {
            self.state.inflate(COMMON_SLIP, step * step, 1.0);
        }
        if w.is_off {
            // It has broken away: its rim says nothing of the robot's speed.
            let own = self.state.mean(own_slip(w.index)) + step;
            let sigma = 2.0 * self.settings.wheel_slip_sigma;
            let own = own.clamp(-MAX_OWN_SLIP, MAX_OWN_SLIP);
            self.state.reset(own_slip(w.index), own, sigma * sigma);
            self.nis = w.innovation * w.innovation / w.variance;
            return false;
        }
        self.wheels.channels[w.index].was_off = false;
        true
    }

    /// Begins the remainder of a window's end: the travel that a counter does not show at the end of a window, by its ticks and its
    /// stamps, it shows in the next. Returns which remainder that is, and 1 where remainders carry the ticks' share of the
    /// variance, else 0.
    fn begin_remainder(&mut self, index: usize) -> (bool, f64) {
        let wheel = &self.wheels.channels[index];
        let counts = wheel.track.counts();
        let variance = wheel.remainder_variance();
        let odd = wheel.remainder.is_some_and(|last| !last);
        if wheel.remainder.is_none() {
            self.state.reset(remainder(index, !odd), 0.0, variance);
        }
        self.state.reset(remainder(index, odd), 0.0, variance);
        (odd, f64::from(u8::from(counts)))
    }
}

#[cfg(test)]
mod tests;
