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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_counts_within_the_dropout_time_where_it_beats_the_speed_walk() {
        const READ_NS: i64 = 3_000_000;
        const LAST_NS: i64 = 128_000_000;
        let settings = FilterSettings {
            accelerometer_noise: 0.25,
            speed_walk: 0.5,
            dropout: seconds_between(READ_NS, LAST_NS),
            ..FilterSettings::default()
        };
        let current = |noise_scale, time_ns| {
            let force = SpecificForce {
                time_ns: READ_NS,
                force: [0.2, -0.3],
            };
            let last = Some(force);
            let reading = Accelerometer { last, noise_scale }.current(time_ns, &settings);
            reading.map(|reading| reading.force)
        };
        // 0.25 √4 is the speed walk
        for (noise_scale, time_ns, counts) in [
            (3.9, LAST_NS, true),
            (3.9, LAST_NS + 1, false),
            (4.0, LAST_NS, false),
            (4.1, READ_NS, false),
        ] {
            let expected = counts.then_some([0.2, -0.3]);
            assert_eq!(
                current(noise_scale, time_ns),
                expected,
                "{noise_scale} {time_ns}"
            );
        }
    }

    #[test]
    fn the_noise_scale_grows_by_the_square_of_the_clamped_innovation() {
        const INNOVATION_VARIANCE_M2_PER_S2: f64 = 0.04;
        // 3 σ, and 50 σ that count as 4 σ
        for (innovation, scale, expected) in [
            (0.6, 5.0, 5.0 * f64::exp(8.0 * NOISE_SCALE_GAIN)),
            (-10.0, 5.0, 5.0 * f64::exp(15.0 * NOISE_SCALE_GAIN)),
            (0.1, 5.0, 5.0 * f64::exp(-0.75 * NOISE_SCALE_GAIN)),
            (0.0, NOISE_SCALE_LIMITS.0, NOISE_SCALE_LIMITS.0),
            (0.6, NOISE_SCALE_LIMITS.1, NOISE_SCALE_LIMITS.1),
        ] {
            let mut accelerometer = Accelerometer {
                last: None,
                noise_scale: scale,
            };
            accelerometer.learn_noise(innovation, INNOVATION_VARIANCE_M2_PER_S2);
            let off = accelerometer.noise_scale / expected - 1.0;
            assert!(off.abs() < 1e-12, "{innovation}: {off}");
        }
    }
}
