//! Settings of the window estimator.

use crate::error::{Result, check_range};
use crate::measured_slip::SlipLimits;
use crate::reference::Reference;
use crate::settings::{Field, check_fields};
use crate::wheel_track::TrackSettings;

/// Settings of the [`WindowEstimator`](super::WindowEstimator).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowSettings {
    /// What measures the robot's speed.
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
        }
    }

    /// Every number of the settings, in the order of the struct.
    pub const FIELDS: &[Field<Self>] = &[
        Row::new("window", "s", (1e-3, 100.0), |s| &mut s.window).key("window_s"),
        Row::new("standstill_speed", "m/s", (0.0, 100.0), |s| {
            &mut s.standstill_speed
        })
        .key("standstill_speed_m_per_s"),
        Row::new("low_speed", "m/s", (0.0, 100.0), |s| &mut s.low_speed).key("low_speed_m_per_s"),
        Row::new("max_sigma", "1", (0.0, 10.0), |s| &mut s.max_sigma).key("max_slip_sigma"),
        Row::new("max_speed", "m/s", (1e-3, 1e3), |s| &mut s.max_speed).key("max_speed_m_per_s"),
        Row::new("dropout", "s", (1e-3, 1e3), |s| &mut s.dropout).key("dropout_s"),
        Row::new("position_sigma", "m", SIGMA, |s| &mut s.position_sigma).key("position_sigma_m"),
        Row::new("yaw_sigma", "rad", SIGMA, |s| &mut s.yaw_sigma).key_in_degrees("yaw_sigma_deg"),
        Row::new("speed_sigma", "m/s", SIGMA, |s| &mut s.speed_sigma).key("speed_sigma_m_per_s"),
        Row::new("yaw_rate_sigma", "rad/s", SIGMA, |s| &mut s.yaw_rate_sigma)
            .key_in_degrees("yaw_rate_sigma_deg_per_s"),
        Row::new("lateral_sigma", "m/s", SIGMA, |s| &mut s.lateral_sigma)
            .key("lateral_sigma_m_per_s"),
    ];

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) that names the field.
    pub fn check(&self) -> Result<()> {
        check_fields("estimator", self, Self::FIELDS)?;
        check_range("estimator", "history", self.history as f64, (8.0, 1e6), "1")
    }
}

type Row = Field<WindowSettings>;

/// Limits of a standard deviation, in its unit.
const SIGMA: (f64, f64) = (1e-9, 1e3);
