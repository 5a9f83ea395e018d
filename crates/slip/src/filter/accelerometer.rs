//! The accelerometer: its last reading, and how well it predicts the speed.

use grouser_real::Real;

use super::INNOVATION_CLAMP_SIGMA;
use super::settings::FilterSettings;
use crate::fault::Fault;
use crate::history::seconds_between;

/// No wheeled robot is pushed harder than this, m/s²: an accelerometer that shows more has been hit.
const MAX_SPECIFIC_FORCE_M_PER_S2: f64 = 20.0;
/// How fast the noise scale is learnt, per reading of a reference; set by `its_sigmas_are_those_of_its_errors`.
const NOISE_SCALE_GAIN: f64 = 0.03;
/// The noise is never below the configured one, and at most this many times its variance.
pub(super) const NOISE_SCALE_LIMITS: (f64, f64) = (1.0, 40.0);

/// Specific force in the robot's frame at a time, forwards and to the left, m/s².
#[derive(Clone, Copy, Debug)]
pub(super) struct SpecificForce {
    pub(super) time_ns: i64,
    pub(super) force: [f64; 2],
}

/// The accelerometer of the robot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accelerometer {
    pub(super) last: Option<SpecificForce>,
    /// Variance with which it predicts the speed, as a multiple of the configured one.
    pub(super) noise_scale: f64,
}

impl Default for Accelerometer {
    fn default() -> Self {
        Self {
            last: None,
            noise_scale: 1.0,
        }
    }
}

impl Accelerometer {
    pub(super) fn update(&mut self, time_ns: i64, force: [f64; 2]) -> Result<(), Fault> {
        let limit = MAX_SPECIFIC_FORCE_M_PER_S2;
        for (field, value) in [
            ("acceleration forward", force[0]),
            ("acceleration left", force[1]),
        ] {
            Fault::check_range(field, value, -limit, limit, "m/s²")?;
        }
        self.last = Some(SpecificForce { time_ns, force });
        Ok(())
    }

    /// Does it predict the speed better than no sensor does?
    pub(super) fn is_useful(&self, settings: &FilterSettings) -> bool {
        settings.accelerometer_noise * Real::sqrt(self.noise_scale) < settings.speed_walk
    }

    /// The reading by which the state is predicted at `time_ns`, if it is useful and not older than the dropout time.
    pub(super) fn current(&self, time_ns: i64, settings: &FilterSettings) -> Option<SpecificForce> {
        self.last
            .filter(|last| seconds_between(last.time_ns, time_ns) <= settings.dropout)
            .filter(|_| self.is_useful(settings))
    }

    /// Learns the noise scale from an innovation of the speed and its variance.
    pub(super) fn learn_noise(&mut self, innovation: f64, variance: f64) {
        let limit = INNOVATION_CLAMP_SIGMA;
        let r = (innovation / Real::sqrt(variance)).clamp(-limit, limit);
        let learnt = Real::exp(NOISE_SCALE_GAIN * (r * r - 1.0));
        let (low, high) = NOISE_SCALE_LIMITS;
        self.noise_scale = (self.noise_scale * learnt).clamp(low, high);
    }
}
