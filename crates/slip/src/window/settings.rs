//! Settings of the window estimator.

use crate::error::{Result, check_range};
use crate::measured_slip::SlipLimits;
use crate::reference::Reference;
use crate::wheel_track::TrackSettings;

/// Settings of the [`WindowEstimator`](super::WindowEstimator).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowSettings {
    /// What tells how fast the robot travels.
    pub reference: Reference,
    /// Speeds are means over this time, s.
    pub window: f64,
    /// A wheel or a robot slower than this stands still, m/s.
    pub standstill_speed: f64,
    /// A wheel whose faster speed is below this has no slip worth a number, m/s.
    pub low_speed: f64,
    /// A slip whose sigma is above this is marked as quantised.
    pub max_sigma: f64,
    /// No part of the robot moves faster than this, m/s: what says so is a jump of its sensor.
    pub max_speed: f64,
    /// A sensor silent for longer than this has dropped out, s.
    pub dropout: f64,
    /// Error of a measured position or displacement (one sigma at each end of a window), m.
    pub position_sigma: f64,
    /// Error of a measured yaw angle or turn, rad.
    pub yaw_sigma: f64,
    /// Error of a measured speed over ground, m/s.
    pub speed_sigma: f64,
    /// Error of a measured yaw rate, as a mean over a window, rad/s.
    pub yaw_rate_sigma: f64,
    /// How far a robot whose wheels all point one way may drift sideways, m/s.
    pub lateral_sigma: f64,
    /// How many samples of each sensor a window may hold; faster sensors are thinned.
    pub history: usize,
}

impl Default for WindowSettings {
    fn default() -> Self {
        Self {
            reference: Reference::FreeWheel,
            window: 0.5,
            standstill_speed: 0.002,
            low_speed: 0.01,
            max_sigma: 0.25,
            max_speed: 20.0,
            dropout: 0.5,
            position_sigma: 0.001,
            yaw_sigma: 0.005,
            speed_sigma: 0.01,
            yaw_rate_sigma: 0.005,
            lateral_sigma: 0.01,
            history: 512,
        }
    }
}

impl WindowSettings {
    /// The limits below which a slip is not a number, or not to be trusted.
    pub(super) const fn limits(&self) -> SlipLimits {
        SlipLimits {
            standstill_speed: self.standstill_speed,
            low_speed: self.low_speed,
            max_sigma: self.max_sigma,
        }
    }

    pub(super) const fn track(&self) -> TrackSettings {
        TrackSettings {
            window: self.window,
            max_speed: self.max_speed,
            dropout: self.dropout,
            history: self.history,
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) that names the field.
    pub fn check(&self) -> Result<()> {
        let of = "estimator";
        check_range(of, "window", self.window, (1e-3, 100.0), "s")?;
        let speed = (0.0, 100.0);
        check_range(of, "standstill_speed", self.standstill_speed, speed, "m/s")?;
        check_range(of, "low_speed", self.low_speed, speed, "m/s")?;
        check_range(of, "max_sigma", self.max_sigma, (0.0, 10.0), "1")?;
        check_range(of, "max_speed", self.max_speed, (1e-3, 1e3), "m/s")?;
        check_range(of, "dropout", self.dropout, (1e-3, 1e3), "s")?;
        let sigma = (1e-9, 1e3);
        check_range(of, "position_sigma", self.position_sigma, sigma, "m")?;
        check_range(of, "yaw_sigma", self.yaw_sigma, sigma, "rad")?;
        check_range(of, "speed_sigma", self.speed_sigma, sigma, "m/s")?;
        check_range(of, "yaw_rate_sigma", self.yaw_rate_sigma, sigma, "rad/s")?;
        check_range(of, "lateral_sigma", self.lateral_sigma, sigma, "m/s")?;
        check_range(of, "history", self.history as f64, (8.0, 1e6), "1")
    }
}
