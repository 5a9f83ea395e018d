//! The motion over the ground in the state of the filter: a reference updates the models of [`GroundTrack`], and their
//! motion replaces that of the Kalman filter.

use grouser_real::Real;

use super::estimator::Core;
use super::ground_track::{Inertial, Outcome};
use super::motion_model::{COMMON_SLIP, FORWARD, LEFT, YAW};
use crate::fault::Fault;
use crate::history::{nanoseconds, seconds_between};
use crate::sample::Measurement;

/// Variance of a speed beside that of the slip, m²/s²: what two steps of 5 ms at 0.2 m/s² differ by.
const SPEED_VARIANCE_FLOOR: f64 = 1e-6;

impl Core {
    /// Predicts the motion over the ground, and puts it in the state.
    pub(super) fn predict_ground_motion(&mut self, time_ns: i64) {
        let Some(ground) = &mut self.ground else {
            return;
        };
        let dropout = self.settings.dropout;
        let inertial = Inertial {
            yaw_rate: self.state.mean(YAW),
            force: self
                .accelerometer
                .last
                .filter(|last| seconds_between(last.time_ns, time_ns) <= dropout),
        };
        if inertial.force.is_none() || !ground.awaits_accelerometer(time_ns) {
            ground.step(time_ns, &self.wheels, inertial, &self.settings);
        }
        let motion = ground.motion(time_ns);
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

    /// Updates the models by a reading of the reference that was stamped `stamp_ns`.
    pub(super) fn update_ground_motion(
        &mut self,
        stamp_ns: i64,
        measurement: &Measurement,
    ) -> Result<(), Fault> {
        let now_ns = self.now_ns.unwrap_or(stamp_ns).max(stamp_ns);
        let motion = self
            .reference
            .motion(stamp_ns, measurement, &self.settings)?;
        self.reference.speed = motion.and_then(|motion| Some((motion.speed[0]?, stamp_ns)));
        let has_gyro = self.gyro.is_trusted(now_ns, &self.settings);
        let Some(ground) = &mut self.ground else {
            return Ok(());
        };
        let taken_ns = stamp_ns.saturating_sub(nanoseconds(self.settings.reference_latency));
        let outcome = ground.update(taken_ns, measurement, (now_ns, has_gyro), &self.settings);
        if outcome == Outcome::Unused {
            return Ok(());
        }
        self.output.reference_readings += 1;
        let accepted = outcome == Outcome::Accepted;
        self.output.reference_refused += u64::from(!accepted);
        let patience = self.settings.failure;
        self.reference.monitor.record(now_ns, accepted, patience);
        if accepted {
            self.reference.accepted_ns = Some(now_ns);
            self.speed_known_ns = Some(now_ns);
            if let Some(motion) = motion.filter(|_| !has_gyro) {
                self.update_turn(&motion, now_ns);
            }
        }
        Ok(())
    }
}
