//! What is known of the sensors of a robot.

use crate::error::Result;
use crate::reference::Reference;
use crate::settings::{Field, check_fields};

/// The reference of a robot and the limits and errors of its sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorSettings {
    /// What measures the robot's speed.
    pub reference: Reference,
    /// A wheel or a robot slower than this stands still, m/s.
    pub standstill_speed: f64,
    /// A wheel whose faster speed is below this has no slip worth a number, m/s.
    pub low_speed: f64,
    /// No part of the robot moves faster than this, m/s: what says so is a jump of its sensor.
    pub max_speed: f64,
    /// A sensor silent for longer than this has dropped out, s.
    pub dropout: f64,
    /// Error of a measured position or displacement (one sigma at each end of the time), m.
    pub position_sigma: f64,
    /// Error of a measured yaw angle or turn, rad.
    pub yaw_sigma: f64,
    /// Error of a measured speed over ground, m/s.
    pub speed_sigma: f64,
}

impl Default for SensorSettings {
    fn default() -> Self {
        Self {
            reference: Reference::FreeWheel,
            standstill_speed: 0.002,
            low_speed: 0.01,
            max_speed: 20.0,
            dropout: 0.5,
            position_sigma: 0.001,
            yaw_sigma: 0.005,
            speed_sigma: 0.01,
        }
    }
}

impl SensorSettings {
    /// Every number of the settings, in the order of the struct.
    pub const FIELDS: &[Field<Self>] = &[
        Row::new("standstill_speed", "m/s", (0.0, 100.0), |s| {
            &mut s.standstill_speed
        })
        .key("standstill_speed_m_per_s"),
        Row::new("low_speed", "m/s", (0.0, 100.0), |s| &mut s.low_speed).key("low_speed_m_per_s"),
        Row::new("max_speed", "m/s", (1e-3, 1e3), |s| &mut s.max_speed).key("max_speed_m_per_s"),
        Row::new("dropout", "s", (1e-3, 1e3), |s| &mut s.dropout).key("dropout_s"),
        Row::new("position_sigma", "m", SIGMA, |s| &mut s.position_sigma).key("position_sigma_m"),
        Row::new("yaw_sigma", "rad", SIGMA, |s| &mut s.yaw_sigma).key_in_degrees("yaw_sigma_deg"),
        Row::new("speed_sigma", "m/s", SIGMA, |s| &mut s.speed_sigma).key("speed_sigma_m_per_s"),
    ];

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) that names the field.
    pub fn check(&self) -> Result<()> {
        check_fields("estimator", self, Self::FIELDS)
    }
}

type Row = Field<SensorSettings>;

/// Limits of a standard deviation, in its unit.
const SIGMA: (f64, f64) = (1e-9, 1e3);
