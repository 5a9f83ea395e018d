//! How the filter works: one value per line, each with its default.

use crate::error::{Result, check_range};

/// What is believed of a slip before it is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipPrior {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

impl SlipPrior {
    /// As 1 − v/u, the form in which the filter keeps a free wheel's skid: its rim, which is measured, stands below the
    /// line, so that the statement v = u (1 − x) is linear in v and x. In the skid s = u/v − 1 it would be their product, and
    /// an unknown skid would drift.
    pub(crate) fn by_rim(self) -> Self {
        if self.mean >= 0.0 {
            return self;
        }
        let ratio = 1.0 / (1.0 + self.mean.max(-0.95));
        Self {
            mean: 1.0 - ratio,
            sigma: self.sigma * ratio * ratio,
        }
    }

    /// The slip that [`SlipPrior::by_rim`] came from.
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

/// How the filter works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSettings {
    /// Samples that arrive within this time of one another are put in order, s.
    pub horizon: f64,
    /// A wheel's speed is its mean over at least this time, s.
    pub wheel_window: f64,
    /// How much the speed may change of itself, m/s per √s, where no accelerometer is heard.
    pub speed_walk: f64,
    /// The same where one is, m/s per √s: its noise.
    pub accelerometer_noise: f64,
    /// Bias of the accelerometer with the tilt of the ground in it, m/s².
    pub accelerometer_bias: f64,
    /// How much that bias may change, m/s² per √s.
    pub accelerometer_drift: f64,
    /// How much the yaw rate may change of itself, rad/s per √s.
    pub yaw_walk: f64,
    /// Standard deviation of a yaw rate, rad/s.
    pub yaw_rate_sigma: f64,
    /// Bias of the gyro, rad/s.
    pub gyro_bias: f64,
    /// How much that bias may change, rad/s per √s.
    pub gyro_drift: f64,
    /// How fast a robot whose wheels all point one way may drift sideways, m/s.
    pub lateral_sigma: f64,
    /// The powered wheels' common slip: the soil's doing.
    pub slip: SlipPrior,
    /// How long the common slip remembers, s.
    pub slip_memory: f64,
    /// How far one powered wheel's slip may be from the common one.
    pub wheel_slip_sigma: f64,
    /// How long that difference remembers, s.
    pub wheel_slip_memory: f64,
    /// Slip of a free wheel: its skid at no torque.
    pub free_slip: SlipPrior,
    /// How long a free wheel's slip remembers, s.
    pub free_slip_memory: f64,
    /// Standard deviation of a powered wheel's radius, as a share of it.
    pub radius_sigma: f64,
    /// Standard deviation of a measured position, m.
    pub position_sigma: f64,
    /// Standard deviation of a measured speed, m/s.
    pub speed_sigma: f64,
    /// A displacement, pose or speed comes this long after what it tells of, s.
    pub reference_latency: f64,
    /// A robot slower than this stands still, m/s.
    pub standstill_speed: f64,
    /// A wheel whose faster speed is below this has no slip worth a number, m/s.
    pub low_speed: f64,
    /// A slip whose sigma is above this is marked as such.
    pub max_sigma: f64,
    /// No part of the robot moves faster than this, m/s.
    pub max_speed: f64,
    /// A sensor silent for longer than this has dropped out, s.
    pub dropout: f64,
    /// Measurements further off than this, in sigma, are refused; a wheel's change its slip instead.
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
            gate: 4.5,
            failure: 0.3,
        }
    }
}

impl FilterSettings {
    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) with field, value, limits and unit.
    pub fn check(&self) -> Result<()> {
        let of = "filter";
        let time = (1e-4, 1e4);
        let sigma = (1e-9, 1e3);
        let rows = [
            ("horizon", self.horizon, (0.0, 1.0), "s"),
            ("wheel_window", self.wheel_window, (1e-4, 1.0), "s"),
            ("speed_walk", self.speed_walk, sigma, "m/s/√s"),
            (
                "accelerometer_noise",
                self.accelerometer_noise,
                sigma,
                "m/s/√s",
            ),
            ("accelerometer_bias", self.accelerometer_bias, sigma, "m/s²"),
            (
                "accelerometer_drift",
                self.accelerometer_drift,
                sigma,
                "m/s²/√s",
            ),
            ("yaw_walk", self.yaw_walk, sigma, "rad/s/√s"),
            ("yaw_rate_sigma", self.yaw_rate_sigma, sigma, "rad/s"),
            ("gyro_bias", self.gyro_bias, sigma, "rad/s"),
            ("gyro_drift", self.gyro_drift, (0.0, 1.0), "rad/s/√s"),
            ("lateral_sigma", self.lateral_sigma, sigma, "m/s"),
            ("slip mean", self.slip.mean, (-1.0, 1.0), "1"),
            ("slip sigma", self.slip.sigma, (1e-6, 2.0), "1"),
            ("slip_memory", self.slip_memory, time, "s"),
            ("wheel_slip_sigma", self.wheel_slip_sigma, (1e-6, 2.0), "1"),
            ("wheel_slip_memory", self.wheel_slip_memory, time, "s"),
            ("free_slip mean", self.free_slip.mean, (-0.95, 0.95), "1"),
            ("free_slip sigma", self.free_slip.sigma, (1e-6, 2.0), "1"),
            ("free_slip_memory", self.free_slip_memory, time, "s"),
            ("radius_sigma", self.radius_sigma, (1e-9, 0.5), "1"),
            ("position_sigma", self.position_sigma, sigma, "m"),
            ("speed_sigma", self.speed_sigma, sigma, "m/s"),
            ("reference_latency", self.reference_latency, (0.0, 1.0), "s"),
            (
                "standstill_speed",
                self.standstill_speed,
                (0.0, 100.0),
                "m/s",
            ),
            ("low_speed", self.low_speed, (0.0, 100.0), "m/s"),
            ("max_sigma", self.max_sigma, (0.0, 10.0), "1"),
            ("max_speed", self.max_speed, (1e-3, 1e3), "m/s"),
            ("dropout", self.dropout, (1e-3, 1e3), "s"),
            ("gate", self.gate, (1.0, 100.0), "1"),
            ("failure", self.failure, (1e-3, 1e3), "s"),
        ];
        for (field, value, limits, unit) in rows {
            check_range(of, field, value, limits, unit)?;
        }
        Ok(())
    }
}
