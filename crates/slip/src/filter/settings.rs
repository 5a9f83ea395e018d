//! Settings of the slip filter.

use grouser_real::Real;

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
    /// The same prior of x = 1 − v/u, the form in which the filter uses a free wheel's skid: v = u (1 − x) is linear in v
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
}

/// A prior whose mean is beyond this counts as this: the logarithm of full slip is infinite.
const MAX_PRIOR_SLIP: f64 = 0.95;

/// A prior of a slip as one of the logarithmic slip.
pub(super) fn log_prior(prior: SlipPrior) -> SlipPrior {
    let mean = prior.mean.clamp(-MAX_PRIOR_SLIP, MAX_PRIOR_SLIP);
    let share = 1.0 - mean.abs();
    SlipPrior {
        mean: (-Real::ln(share)).copysign(mean),
        sigma: prior.sigma / share,
    }
}

/// Settings of the [`SlipFilter`](super::SlipFilter).
///
/// ```
/// use grouser_slip::filter::FilterSettings;
///
/// let settings = FilterSettings { speed_sigma: 0.02, ..FilterSettings::default() }; // m/s
/// settings.check()?;
/// assert!(FilterSettings { speed_sigma: f64::NAN, ..settings }.check().is_err());
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSettings {
    /// Samples that arrive within this time of one another are put in order, s.
    pub horizon: f64,
    /// Prior of the powered wheels' common slip, which the soil causes.
    pub slip: SlipPrior,
    /// Prior of a free wheel's slip: its skid at no torque.
    pub free_slip: SlipPrior,
    /// Random walk of what the accelerometer shows besides the robot's acceleration (its bias, gravity on slopes), m/s² per √s.
    pub accelerometer_drift: f64,
    /// Standard deviation of a measured position, m.
    pub position_sigma: f64,
    /// Standard deviation of a measured heading, rad.
    pub yaw_sigma: f64,
    /// Standard deviation of a measured speed, m/s.
    pub speed_sigma: f64,
    /// The delay of a displacement, pose or speed behind the motion that it measures, s.
    pub reference_latency: f64,
    /// No part of the robot moves faster than this, m/s.
    pub max_speed: f64,
    /// A sensor that is silent for longer than this, and than three of its periods, has dropped out, s.
    pub dropout: f64,
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            horizon: 0.02,
            slip: SlipPrior {
                mean: 0.1,
                sigma: 0.2,
            },
            free_slip: SlipPrior {
                mean: 0.0,
                sigma: 0.01,
            },
            accelerometer_drift: 0.03,
            position_sigma: 0.02,
            yaw_sigma: 0.005,
            speed_sigma: 0.01,
            reference_latency: 0.0,
            max_speed: 20.0,
            dropout: 0.1,
        }
    }
}

/// Sigma of a free wheel's skid on unknown ground, in addition to that of its prior: published laws of soft soil differ by a few
/// hundredths in it.
const SKID_SIGMA: f64 = 0.03;

impl FilterSettings {
    /// The prior of a free wheel's skid by its own speed, on ground that nobody knows.
    #[must_use]
    pub fn skid(&self) -> SlipPrior {
        let skid = self.free_slip.by_wheel();
        SlipPrior {
            sigma: Real::hypot(skid.sigma, SKID_SIGMA),
            ..skid
        }
    }

    /// Every number of the settings, in the order of the struct.
    pub const FIELDS: &[Field<Self>] = &[
        Row::new("horizon", "s", (0.0, 1.0), |s| &mut s.horizon),
        Row::new("slip mean", "1", (-1.0, 1.0), |s| &mut s.slip.mean).key("slip_mean"),
        Row::new("slip sigma", "1", (1e-6, 2.0), |s| &mut s.slip.sigma).key("slip_sigma"),
        Row::new("free_slip mean", "1", (-0.95, 0.95), |s| {
            &mut s.free_slip.mean
        })
        .key("free_slip_mean"),
        Row::new("free_slip sigma", "1", (1e-6, 2.0), |s| {
            &mut s.free_slip.sigma
        })
        .key("free_slip_sigma"),
        Row::new("accelerometer_drift", "m/s²/√s", SIGMA, |s| {
            &mut s.accelerometer_drift
        })
        .key("accelerometer_drift_m_per_s2_sqrt_s"),
        Row::new("position_sigma", "m", SIGMA, |s| &mut s.position_sigma),
        Row::new("yaw_sigma", "rad", SIGMA, |s| &mut s.yaw_sigma),
        Row::new("speed_sigma", "m/s", SIGMA, |s| &mut s.speed_sigma),
        Row::new("reference_latency", "s", (0.0, 1.0), |s| {
            &mut s.reference_latency
        })
        .key("reference_latency_s"),
        Row::new("max_speed", "m/s", (1e-3, 1e3), |s| &mut s.max_speed),
        Row::new("dropout", "s", (1e-3, 1e3), |s| &mut s.dropout),
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

/// Limits of a standard deviation, in its unit.
const SIGMA: (f64, f64) = (1e-6, 1e3);
