//! The motion over the ground in the state of the filter: a reference updates the models of [`GroundTrack`], and their
//! motion replaces that of the Kalman filter.

use grouser_real::Real;

use super::estimator::Core;
use super::ground_track::{Awaiting, Inertial, Outcome};
use super::motion_model::{COMMON_SLIP, FORWARD, GYRO_BIAS, LEFT, YAW};
use super::multiple_model::TurnError;
use crate::fault::Fault;
use crate::history::nanoseconds;
use crate::sample::Measurement;
use crate::speed::Measured;

/// Variance of a speed beside that of the slip, m²/s²: what two steps of 5 ms at 0.2 m/s² differ by.
const SPEED_VARIANCE_FLOOR: f64 = 1e-6;

/// How long the error of a turn rate stays the same, s: of a gyro, and of wheels that slip.
const GYRO_ERROR_MEMORY_S: f64 = 100.0;
const WHEEL_TURN_ERROR_MEMORY_S: f64 = 2.0;
/// The models know the gyro's bias better where their variance is below this share of the filter's own.
const BETTER_VARIANCE_SHARE: f64 = 0.9;

impl Core {
    /// Predicts the motion over the ground, and puts it in the state.
    pub(super) fn predict_ground_motion(&mut self, time_ns: i64) {
        if self.ground.is_none() {
            return;
        }
        let has_gyro = self.gyro.is_trusted(time_ns, &self.settings);
        let by_wheels = (!has_gyro).then(|| self.turn_by_wheels()).flatten();
        let steered = (!has_gyro).then(|| self.wheels.steered_turn(1.0, &self.settings));
        let yaw_rate = self.state.mean(YAW);
        let turn_error = if has_gyro {
            TurnError {
                by_gyro: true,
                removed: self.state.mean(GYRO_BIAS),
                sigma: self.state.sigma(GYRO_BIAS),
                memory: GYRO_ERROR_MEMORY_S,
            }
        } else {
            TurnError {
                by_gyro: false,
                removed: 0.0,
                sigma: by_wheels
                    .map_or_else(|| self.state.sigma(YAW), |turn| Real::sqrt(turn.variance)),
                memory: WHEEL_TURN_ERROR_MEMORY_S,
            }
        };
        let inertial = Inertial {
            yaw_rate,
            turn_rate: by_wheels.map_or(yaw_rate, |turn| turn.value),
            turn_error,
            curvature: steered.flatten().map(|turn| turn.value),
        };
        let Some(ground) = &mut self.ground else {
            return;
        };
        if !ground.force.awaits(time_ns) {
            ground.step(time_ns, &self.wheels, inertial, &self.settings);
        }
        self.follow_ground_motion(time_ns, by_wheels.map(|turn| turn.value));
    }

    /// Puts the motion of the models in the state; `by_wheels` is the turn by the wheels where no gyro is trusted, rad/s.
    fn follow_ground_motion(&mut self, time_ns: i64, by_wheels: Option<f64>) {
        let Some(ground) = &self.ground else {
            return;
        };
        let motion = ground.motion(time_ns, &self.settings);
        self.is_led = motion.is_some();
        let Some((motion, direction, rim)) = motion else {
            return;
        };
        let (sin, cos) = Real::sin_cos(direction);
        let across = motion.drift * motion.speed;
        let faster = if motion.slip < 0.0 { motion.speed } else { rim };
        // u = v + s m holds: speed and slip are one uncertainty
        let by_slip = -motion.slip_sigma * motion.slip_sigma * faster;
        let along_variance = by_slip * -faster + SPEED_VARIANCE_FLOOR;
        let across_sigma = motion.drift_sigma * motion.speed;
        let across_variance = across_sigma * across_sigma + SPEED_VARIANCE_FLOOR;
        let slip_variance = motion.slip_sigma * motion.slip_sigma;
        let forward = cos * motion.speed - sin * across;
        let left = sin * motion.speed + cos * across;
        let state = &mut self.state;
        if let Some(turn) = by_wheels {
            // the wheels' own turn less what the reference shows of its error: wheels that skid sideways turn faster than the robot
            let Measured { value, variance } = motion.turn_error;
            state.reset(YAW, turn - value, variance);
        }
        state.reset(
            FORWARD,
            forward,
            cos * cos * along_variance + sin * sin * across_variance,
        );
        state.reset(
            LEFT,
            left,
            sin * sin * along_variance + cos * cos * across_variance,
        );
        state.reset(COMMON_SLIP, motion.slip, slip_variance);
        state.set_covariance(
            FORWARD,
            LEFT,
            sin * cos * (along_variance - across_variance),
        );
        state.set_covariance(FORWARD, COMMON_SLIP, cos * by_slip);
        state.set_covariance(LEFT, COMMON_SLIP, sin * by_slip);
    }

    /// Updates the models by a reading of the reference that was stamped `stamp_ns`: at once, or once the rims have been read again
    /// where they are read seldom or it is late itself: others may come with it. A robot that brakes in between would be led on
    /// at its speed before.
    pub(super) fn update_ground_motion(
        &mut self,
        stamp_ns: i64,
        measurement: &Measurement,
    ) -> Result<(), Fault> {
        let motion = self
            .reference
            .motion(stamp_ns, measurement, &self.settings)?;
        self.reference.speed = motion.and_then(|motion| Some((motion.speed[0]?, stamp_ns)));
        let now_ns = self.now_ns.unwrap_or(stamp_ns);
        let is_known = self.are_rims_read_since(stamp_ns);
        let is_sparse = self.is_sparse(now_ns);
        let Some(ground) = &mut self.ground else {
            return Ok(());
        };
        let is_late = ground.is_late(stamp_ns) && !is_known;
        let waits = self.wheels.measure_ways() && (is_sparse || is_late);
        let has_room = ground.put_off((stamp_ns, *measurement, motion));
        if !(waits && has_room) {
            self.predict_ground_motion(now_ns);
            self.use_awaiting();
        }
        Ok(())
    }

    /// Has a powered wheel been read at `time_ns` or later?
    pub(super) fn are_rims_read_since(&self, time_ns: i64) -> bool {
        let newest = self
            .wheels
            .powered()
            .filter_map(|wheel| wheel.track.newest_time());
        newest.max().is_some_and(|newest| newest >= time_ns)
    }

    /// Updates the models by the readings of the reference that waited for the rims.
    pub(super) fn use_awaiting(&mut self) {
        let next = |core: &mut Self| {
            core.ground
                .as_mut()
                .and_then(|ground| ground.next_awaiting())
        };
        while let Some(reading) = next(self) {
            self.use_reading(reading);
        }
    }

    fn use_reading(&mut self, (stamp_ns, measurement, motion): Awaiting) {
        let now_ns = self.now_ns.unwrap_or(stamp_ns).max(stamp_ns);
        let has_gyro = self.gyro.is_trusted(now_ns, &self.settings);
        let Some(ground) = &mut self.ground else {
            return;
        };
        let taken_ns = stamp_ns.saturating_sub(nanoseconds(self.settings.reference_latency));
        let outcome = ground.update(taken_ns, &measurement, (now_ns, has_gyro), &self.settings);
        if outcome == Outcome::Unused {
            return;
        }
        if ground.has_wrong_turn() {
            let (bias, sigma) = (self.state.mean(GYRO_BIAS), self.settings.gyro_bias);
            self.state.reset(GYRO_BIAS, bias, sigma * sigma);
        }
        self.output.reference_readings += 1;
        let accepted = outcome == Outcome::Accepted;
        self.output.reference_refused += u64::from(!accepted);
        let patience = self.settings.failure;
        self.reference.monitor.record(now_ns, accepted, patience);
        if accepted {
            self.reference.accepted_ns = Some(now_ns);
            self.speed_known_ns = Some(now_ns);
            let is_led = self.turn_by_wheels().is_some();
            if let Some(motion) = motion.filter(|_| !has_gyro && !is_led) {
                self.update_turn(&motion, now_ns);
            }
            if has_gyro {
                self.learn_gyro_bias(now_ns);
            }
        }
        // the next sample may come as late as the next row of a table
        let by_wheels = (!has_gyro).then(|| self.turn_by_wheels()).flatten();
        self.follow_ground_motion(now_ns, by_wheels.map(|turn| turn.value));
    }

    /// Takes on what the models have learnt of the gyro's bias, where they know it better.
    fn learn_gyro_bias(&mut self, now_ns: i64) {
        let Some((motion, ..)) = self
            .ground
            .as_ref()
            .and_then(|ground| ground.motion(now_ns, &self.settings))
        else {
            return;
        };
        let Measured { value, variance } = motion.turn_error;
        if variance < BETTER_VARIANCE_SHARE * self.state.covariance(GYRO_BIAS, GYRO_BIAS) {
            let bias = self.state.mean(GYRO_BIAS) + value;
            self.state.reset(GYRO_BIAS, bias, variance);
        }
    }

    /// The yaw rate that the wheels show and its variance: by how they are steered, else by how unlike their rims run.
    pub(super) fn turn_by_wheels(&self) -> Option<Measured> {
        let forward = self.state.mean(FORWARD);
        self.wheels
            .steered_turn(forward, &self.settings)
            .or_else(|| {
                let value = self.wheels.yaw_rate()?;
                let sigma = self.wheels.turn_sigma(value, &self.settings);
                Some(Measured {
                    value,
                    variance: sigma * sigma,
                })
            })
    }
}

#[cfg(test)]
mod tests;
