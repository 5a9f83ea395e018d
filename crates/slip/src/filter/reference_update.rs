//! The update by measured motion: a camera, a pose or a speed over ground.

use grouser_real::Real;

use super::estimator::Core;
use super::kalman::ScalarMeasurement;
use super::motion_model::{FORWARD, along};
use super::reference_sensor::ReferenceMotion;
use super::{
    INNOVATION_CLAMP_SIGMA, READMIT_SPEED_SHARE, REFERENCE_TIMEOUT_S, UNAIDED_NOISE_FACTOR,
};
use crate::fault::Fault;
use crate::history::seconds_between;
use crate::sample::Measurement;

/// How fast the mean innovation of a reference forgets, per reading.
const MEAN_GAIN: f64 = 0.3;
/// A mean innovation beyond this many sigma is a wrong scale or a delay, though no single reading is beyond the gate.
const MEAN_LIMIT_SIGMA: f64 = 2.0;
/// Variance of a turn (rad²/s²) over that of a speed (m²/s²) of the same reading: positions measured 0.2 m off the centre.
const TURN_VARIANCE_FACTOR: f64 = 25.0;

/// The share of the rims' changes of speed that an accelerometer does not predict: at 5 m/s² stamps 10 ms apart are 0.05 m/s.
const MEASURED_PACE_SHARE: f64 = 0.25;

/// One component of a measured motion: its jacobian, residual and variance.
type Component = ([(usize, f64); 3], f64, f64);

impl Core {
    /// Gates a reading of the reference that was stamped `stamp_ns`, and updates the state by it.
    pub(super) fn update_reference(
        &mut self,
        stamp_ns: i64,
        measurement: &Measurement,
    ) -> Result<(), Fault> {
        let Some(motion) = self
            .reference
            .motion(stamp_ns, measurement, &self.settings)?
        else {
            return Ok(());
        };
        self.output.reference_readings += 1;
        let time_ns = self.now_ns.unwrap_or(stamp_ns).max(stamp_ns);
        let moving = motion.speed[0].is_some_and(|v| v != 0.0);
        let frozen = self.reference.is_frozen(&motion, self.settings.failure) && moving;
        // a frozen sensor measures nothing
        self.reference.speed = motion.speed[0].filter(|_| !frozen).map(|v| (v, time_ns));
        let components = self.components(&motion, time_ns);
        let mut agreed = !frozen;
        let mut first = None;
        for component in components.iter().flatten() {
            let (innovation, variance) = self.state.innovation(&measured(component));
            let r = innovation / Real::sqrt(variance);
            agreed &= r.abs() <= self.settings.gate;
            first.get_or_insert(r);
        }
        let limit = INNOVATION_CLAMP_SIGMA;
        let r = first.unwrap_or(0.0).clamp(-limit, limit);
        self.reference.mean_innovation += MEAN_GAIN * (r - self.reference.mean_innovation);
        agreed &= self.reference.mean_innovation.abs() <= MEAN_LIMIT_SIGMA;
        let had_failed = self.reference.monitor.has_failed();
        let mut near = true;
        if had_failed && let Some((_, residual, _)) = components[0] {
            // Without the reference the speed is so uncertain that any reading would pass the gate.
            let limit =
                READMIT_SPEED_SHARE * self.state.mean(FORWARD).abs() + self.settings.low_speed;
            near = residual.abs() <= limit;
            let speed = motion.speed[0].unwrap_or(0.0);
            let plausible = self.is_lost(time_ns)
                && self.is_plausible(speed)
                && self.agrees_with_free_wheel(speed, time_ns);
            agreed = !frozen && (agreed && near || plausible);
        }
        let patience = self.settings.failure;
        let trusted = self.reference.monitor.record(time_ns, agreed, patience);
        if !agreed || !trusted {
            self.output.reference_refused += 1;
            return Ok(());
        }
        if had_failed
            && !near
            && let Some(speed) = motion.speed[0]
        {
            self.restart_from(speed);
            self.reference.mean_innovation = 0.0;
            return Ok(());
        }
        for component in components.iter().flatten() {
            self.nis = self.state.update(&measured(component));
        }
        self.reference.accepted_ns = Some(time_ns);
        self.speed_known_ns = Some(time_ns);
        Ok(())
    }

    /// The process noise density of the speed, m/s per √s. Without a reference the speed follows the wheels: a speed that
    /// changed slowly would turn every start into slip.
    pub(super) fn process_noise_density(&self) -> f64 {
        let settings = &self.settings;
        let unaided = UNAIDED_NOISE_FACTOR * settings.speed_walk;
        let now_ns = self.now_ns.unwrap_or(0);
        if self.is_lost(now_ns) {
            return unaided;
        }
        // a robot that starts or stops briskly does so with its wheels
        let pace = if self.ground.is_none() {
            self.wheels.pace(now_ns, settings.dropout)
        } else {
            0.0
        };
        let is_measured =
            self.accelerometer.last.is_some() && self.accelerometer.is_useful(settings);
        let (density, share) = if is_measured {
            let scale = Real::sqrt(self.accelerometer.noise_scale);
            (settings.accelerometer_noise * scale, MEASURED_PACE_SHARE)
        } else {
            (settings.speed_walk, 1.0)
        };
        Real::hypot(density, share * pace).min(unaided)
    }

    /// A measured motion as measurements of the present state: the change since then is added to the variance.
    fn components(&self, motion: &ReferenceMotion, now_ns: i64) -> [Option<Component>; 3] {
        let &ReferenceMotion { from_ns, to_ns, .. } = motion;
        let age = seconds_between(to_ns, now_ns) + 0.5 * seconds_between(from_ns, to_ns);
        let density = self.process_noise_density();
        let changed = density * density * age;
        let turned = self.settings.yaw_rate_sigma * self.settings.yaw_rate_sigma;
        let variance = motion.sigma * motion.sigma;
        let one = |row: [f64; 3], value: Option<f64>, variance: f64| {
            value.map(|value| {
                let predicted = self.path.mean_along(&self.state, row, from_ns, to_ns);
                (along(row), value - predicted, variance)
            })
        };
        let turn_variance = TURN_VARIANCE_FACTOR * variance + turned;
        [
            one([1.0, 0.0, 0.0], motion.speed[0], variance + changed),
            one([0.0, 1.0, 0.0], motion.speed[1], variance + changed),
            one([0.0, 0.0, 1.0], motion.turn, turn_variance),
        ]
    }

    /// Updates the yaw rate by the turn of a reference.
    pub(super) fn update_turn(&mut self, motion: &ReferenceMotion, now_ns: i64) {
        let [.., turn] = self.components(motion, now_ns);
        if let Some(component) = &turn {
            self.state.update(&measured(component));
        }
    }

    /// Has no reference measured the robot's speed for long?
    pub(super) fn is_lost(&self, now_ns: i64) -> bool {
        self.speed_known_ns
            .is_none_or(|then| seconds_between(then, now_ns) > REFERENCE_TIMEOUT_S)
    }
}

fn measured((jacobian, residual, variance): &Component) -> ScalarMeasurement<'_> {
    ScalarMeasurement {
        jacobian,
        residual: *residual,
        variance: *variance,
    }
}

#[cfg(test)]
mod tests;
