//! Settings of the slip filter.

use crate::error::Result;
use crate::settings::{Field, check_fields};

/// The prior of a slip: its distribution before it is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipPrior {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

impl SlipPrior {
    /// The same prior of x = 1 − v/u, the form in which the filter holds a free wheel's skid: v = u (1 − x) is linear in v
    /// and x, since the rim speed u is measured. The skid s = u/v − 1 would be a product of two unknowns and drift.
    #[must_use]
    pub fn by_wheel(self) -> Self {
        if self.mean >= 0.0 {
            return self;
        }
        let ratio = 1.0 / (1.0 + self.mean.max(-0.95));
        Self {
            mean: 1.0 - ratio,
            sigma: self.sigma * ratio * ratio,
        }
    }

    /// The inverse of [`SlipPrior::by_wheel`].
    pub(crate) fn by_faster(self) -> Self {
        if self.mean >= 0.0 {
            return self;
        }
        let ratio = 1.0 / (1.0 - self.mean);
        Self {
            mean: ratio - 1.0,
            sigma: self.sigma * ratio * ratio,
        }
    }
}

/// Settings of the [`SlipFilter`](super::SlipFilter).
///
/// ```
/// use grouser_slip::filter::FilterSettings;
///
/// let settings = FilterSettings { gyro_bias: 0.02, ..FilterSettings::default() }; // rad/s
/// settings.check()?;
/// assert!(FilterSettings { gyro_bias: f64::NAN, ..settings }.check().is_err());
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSettings {
    /// Samples that arrive within this time of one another are put in order, s.
    pub horizon: f64,
    /// A wheel's speed is its mean over at least this time, s.
    pub wheel_window: f64,
    /// Process noise density of the speed without an accelerometer, m/s per √s.
    pub speed_walk: f64,
    /// Process noise density of the speed with an accelerometer (its noise), m/s per √s.
    pub accelerometer_noise: f64,
    /// Standard deviation of the accelerometer's bias, the tilt of the ground included, m/s².
    pub accelerometer_bias: f64,
    /// Process noise density of that bias, m/s² per √s.
    pub accelerometer_drift: f64,
    /// Process noise density of the yaw rate, rad/s per √s.
    pub yaw_walk: f64,
    /// Standard deviation of a yaw rate, rad/s.
    pub yaw_rate_sigma: f64,
    /// Standard deviation of the gyro's bias, rad/s.
    pub gyro_bias: f64,
    /// Process noise density of that bias, rad/s per √s.
    pub gyro_drift: f64,
    /// Standard deviation of the sideways drift of a robot whose wheels all point one way, m/s.
    pub lateral_sigma: f64,
    /// Prior of the powered wheels' common slip, which the soil causes.
    pub slip: SlipPrior,
    /// Time constant with which the common slip decays to its prior, s.
    pub slip_memory: f64,
    /// Standard deviation of one powered wheel's slip about the common one.
    pub wheel_slip_sigma: f64,
    /// Time constant with which that difference decays, s.
    pub wheel_slip_memory: f64,
    /// Prior of a free wheel's slip: its skid at no torque.
    pub free_slip: SlipPrior,
    /// Time constant with which a free wheel's slip decays to its prior, s.
    pub free_slip_memory: f64,
    /// Standard deviation of a powered wheel's radius, as a share of it.
    pub radius_sigma: f64,
    /// Standard deviation of a measured position, m.
    pub position_sigma: f64,
    /// Standard deviation of a measured speed, m/s.
    pub speed_sigma: f64,
    /// The delay of a displacement, pose or speed behind the motion that it measures, s.
    pub reference_latency: f64,
    /// A robot slower than this stands still, m/s.
    pub standstill_speed: f64,
    /// Below this speed of wheel and rim no slip is computed, m/s.
    pub low_speed: f64,
    /// A slip with a larger sigma is marked as quantised.
    pub max_sigma: f64,
    /// No part of the robot moves faster than this, m/s.
    pub max_speed: f64,
    /// A sensor silent for longer than this has dropped out, s: a wheel has no slip until it is read again. One that is silent for
    /// longer than twice this, and than eight `wheel_window`, begins anew: wheels that are read as seldom never have a slip.
    pub dropout: f64,
    /// The filter keeps memory for sensors of at most this rate, Hz; entries of faster ones are merged. At 100 Hz six wheels
    /// need 27 kB less than at the default of 1000 Hz.
    pub max_rate: f64,
    /// Measurements with an innovation beyond this many sigma are refused; a wheel's change its slip instead.
    pub gate: f64,
    /// A reference that is refused for this long has failed, s.
    pub failure: f64,
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            horizon: 0.02,
            wheel_window: 0.05,
            speed_walk: 0.1,
            accelerometer_noise: 0.03,
            accelerometer_bias: 0.3,
            accelerometer_drift: 0.03,
            yaw_walk: 0.5,
            yaw_rate_sigma: 0.005,
            gyro_bias: 0.02,
            gyro_drift: 2e-4,
            lateral_sigma: 0.01,
            slip: SlipPrior {
                mean: 0.1,
                sigma: 0.2,
            },
            slip_memory: 20.0,
            wheel_slip_sigma: 0.08,
            wheel_slip_memory: 0.5,
            free_slip: SlipPrior {
                mean: 0.0,
                sigma: 0.01,
            },
            free_slip_memory: 1000.0,
            radius_sigma: 0.01,
            position_sigma: 0.001,
            speed_sigma: 0.01,
            reference_latency: 0.0,
            standstill_speed: 0.002,
            low_speed: 0.02,
            max_sigma: 0.25,
            max_speed: 20.0,
            dropout: 0.1,
            max_rate: 1000.0,
            gate: 4.5,
            failure: 0.3,
        }
    }
}

impl FilterSettings {
    /// The preset for a recorded log of unknown ground: some wheels may be in a soft patch that the others have not
    /// reached, so that a wheel's slip may be far from the common one, for seconds.
    #[must_use]
    pub fn any_ground() -> Self {
        Self {
            wheel_slip_sigma: 0.3,
            wheel_slip_memory: 5.0,
            ..Self::default()
        }
    }

    /// The prior of a wheel's own slip: of a powered one beside the common slip, of a free one its skid by the rim.
    pub(super) fn own_slip_prior(&self, free: bool) -> SlipPrior {
        if free {
            self.free_slip.by_wheel()
        } else {
            SlipPrior {
                mean: 0.0,
                sigma: self.wheel_slip_sigma,
            }
        }
    }

    /// Every number of the settings, in the order of the struct.
    pub const FIELDS: &[Field<Self>] = &[
        Row::new("horizon", "s", (0.0, 1.0), |s| &mut s.horizon),
        Row::new("max_rate", "Hz", (50.0, 1e4), |s| &mut s.max_rate),
        Row::new("wheel_window", "s", (1e-4, 1.0), |s| &mut s.wheel_window).key("wheel_window_s"),
        Row::new("speed_walk", "m/s/√s", SIGMA, |s| &mut s.speed_walk)
            .key("speed_walk_m_per_s_sqrt_s"),
        Row::new("accelerometer_noise", "m/s/√s", SIGMA, |s| {
            &mut s.accelerometer_noise
        })
        .key("accelerometer_noise_m_per_s_sqrt_s"),
        Row::new("accelerometer_bias", "m/s²", SIGMA, |s| {
            &mut s.accelerometer_bias
        })
        .key("accelerometer_bias_m_per_s2"),
        Row::new("accelerometer_drift", "m/s²/√s", SIGMA, |s| {
            &mut s.accelerometer_drift
        })
        .key("accelerometer_drift_m_per_s2_sqrt_s"),
        Row::new("yaw_walk", "rad/s/√s", SIGMA, |s| &mut s.yaw_walk)
            .key_in_degrees("yaw_walk_deg_per_s_sqrt_s"),
        Row::new("yaw_rate_sigma", "rad/s", SIGMA, |s| &mut s.yaw_rate_sigma),
        Row::new("gyro_bias", "rad/s", SIGMA, |s| &mut s.gyro_bias)
            .key_in_degrees("gyro_bias_deg_per_s"),
        Row::new("gyro_drift", "rad/s/√s", (0.0, 1.0), |s| {
            &mut s.gyro_drift
        }),
        Row::new("lateral_sigma", "m/s", SIGMA, |s| &mut s.lateral_sigma),
        Row::new("slip mean", "1", (-1.0, 1.0), |s| &mut s.slip.mean).key("slip_mean"),
        Row::new("slip sigma", "1", (1e-6, 2.0), |s| &mut s.slip.sigma).key("slip_sigma"),
        Row::new("slip_memory", "s", TIME, |s| &mut s.slip_memory).key("slip_memory_s"),
        Row::new("wheel_slip_sigma", "1", (1e-6, 2.0), |s| {
            &mut s.wheel_slip_sigma
        })
        .key("wheel_slip_sigma"),
        Row::new("wheel_slip_memory", "s", TIME, |s| &mut s.wheel_slip_memory)
            .key("wheel_slip_memory_s"),
        Row::new("free_slip mean", "1", (-0.95, 0.95), |s| {
            &mut s.free_slip.mean
        })
        .key("free_slip_mean"),
        Row::new("free_slip sigma", "1", (1e-6, 2.0), |s| {
            &mut s.free_slip.sigma
        })
        .key("free_slip_sigma"),
        Row::new("free_slip_memory", "s", TIME, |s| &mut s.free_slip_memory),
        Row::new("radius_sigma", "1", (1e-9, 0.5), |s| &mut s.radius_sigma).key("radius_sigma"),
        Row::new("position_sigma", "m", SIGMA, |s| &mut s.position_sigma),
        Row::new("speed_sigma", "m/s", SIGMA, |s| &mut s.speed_sigma),
        Row::new("reference_latency", "s", (0.0, 1.0), |s| {
            &mut s.reference_latency
        })
        .key("reference_latency_s"),
        Row::new("standstill_speed", "m/s", (0.0, 100.0), |s| {
            &mut s.standstill_speed
        }),
        Row::new("low_speed", "m/s", (0.0, 100.0), |s| &mut s.low_speed),
        Row::new("max_sigma", "1", (0.0, 10.0), |s| &mut s.max_sigma),
        Row::new("max_speed", "m/s", (1e-3, 1e3), |s| &mut s.max_speed),
        Row::new("dropout", "s", (1e-3, 1e3), |s| &mut s.dropout),
        Row::new("gate", "1", (1.0, 100.0), |s| &mut s.gate),
        Row::new("failure", "s", (1e-3, 1e3), |s| &mut s.failure),
    ];

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) with field, value, limits and unit.
    pub fn check(&self) -> Result<()> {
        check_fields("filter", self, Self::FIELDS)
    }
}

type Row = Field<FilterSettings>;

/// Limits of a time, s.
const TIME: (f64, f64) = (1e-4, 1e4);
/// Limits of a standard deviation, in its unit.
const SIGMA: (f64, f64) = (1e-9, 1e3);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_skid_is_its_share_of_the_rim_and_back() {
        const SKID_SIGMA: f64 = 0.03;
        for mean in [-0.9, -0.3, 0.0, 0.4] {
            let prior = SlipPrior {
                mean,
                sigma: SKID_SIGMA,
            };
            // x = 1 − v/u: of a slip s = 1 − v/u driving, s = u/v − 1 braking
            let by_wheel = |s: f64| if s < 0.0 { 1.0 - 1.0 / (1.0 + s) } else { s };
            let found = prior.by_wheel();
            let by = 1e-6;
            let slope = (by_wheel(mean + by) - by_wheel(mean - by)) / (2.0 * by);
            assert!((found.mean - by_wheel(mean)).abs() < 1e-12);
            assert!((found.sigma - SKID_SIGMA * slope).abs() < 1e-6, "{mean}");
            let back = found.by_faster();
            assert!((back.mean - mean).abs() < 1e-12 && (back.sigma - SKID_SIGMA).abs() < 1e-12);
        }
        // no more than 20 times the rim
        let prior = SlipPrior {
            mean: -1.0,
            sigma: SKID_SIGMA,
        };
        assert!((prior.by_wheel().mean + 19.0).abs() < 1e-9);
    }

    #[test]
    fn wheels_on_any_ground_slip_more_unlike_and_for_longer() {
        let (usual, any) = (FilterSettings::default(), FilterSettings::any_ground());
        let same = FilterSettings {
            wheel_slip_sigma: usual.wheel_slip_sigma,
            wheel_slip_memory: usual.wheel_slip_memory,
            ..any
        };
        assert_eq!(same, usual);
        assert!(any.wheel_slip_sigma > usual.wheel_slip_sigma);
        assert!(any.wheel_slip_memory > usual.wheel_slip_memory);
        let free_slip = SlipPrior {
            mean: -0.2,
            sigma: 0.05,
        };
        let settings = FilterSettings { free_slip, ..any };
        assert_eq!(settings.own_slip_prior(true), free_slip.by_wheel());
        let own = settings.own_slip_prior(false);
        assert_eq!((own.mean, own.sigma), (0.0, any.wheel_slip_sigma));
    }
}
