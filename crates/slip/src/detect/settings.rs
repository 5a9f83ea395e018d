//! When something is called an event: one value per line, each with its default.

use crate::error::Result;
use crate::settings::{Field, check_fields};

/// When something is called an event.
///
/// A slip counts only as far as it stands above its own noise: by `certainty` sigma, and the sigma knows of the
/// encoder's ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectSettings {
    /// How many sigma a slip must stand above a threshold, 1.
    pub certainty: f64,
    /// A wheel's slip is high from here on, 1.
    pub high_slip: f64,
    /// It must last this long, s.
    pub high_slip_time: f64,
    /// The robot digs in when the mean of its powered wheels' slips is above this, 1.
    pub dig_in: f64,
    /// It must last this long, s.
    pub dig_in_time: f64,
    /// The robot is immobilised when it goes less than this share of what its rims run, 1.
    pub immobilised: f64,
    /// It must last this long, s.
    pub immobilised_time: f64,
    /// An event ends when its quantity has been below this share of its threshold for its time, 1.
    pub release: f64,
    /// Torque on a standing wheel from which it is stalled, N m.
    pub stall_torque: f64,
    /// It must last this long, s.
    pub stall_time: f64,
    /// A turning wheel whose torque falls below this share of its usual one has lifted off, 1.
    pub lift_off: f64,
    /// It must last this long, s.
    pub lift_off_time: f64,
    /// A rim slower than this stands, m/s.
    pub standstill_speed: f64,
}

impl Default for DetectSettings {
    fn default() -> Self {
        Self {
            certainty: 2.0,
            high_slip: 0.5,
            high_slip_time: 0.3,
            dig_in: 0.6,
            dig_in_time: 1.0,
            immobilised: 0.15,
            immobilised_time: 0.5,
            release: 0.8,
            stall_torque: f64::MAX,
            stall_time: 0.05,
            lift_off: 0.25,
            lift_off_time: 0.1,
            standstill_speed: 0.005,
        }
    }
}

impl DetectSettings {
    /// Every number of the settings, in the order of the struct.
    pub const FIELDS: &[Field<Self>] = &[
        Row::new("certainty", "1", (0.0, 10.0), |s| &mut s.certainty),
        Row::new("high_slip", "1", SHARE, |s| &mut s.high_slip),
        Row::new("high_slip_time", "s", TIME, |s| &mut s.high_slip_time),
        Row::new("dig_in", "1", SHARE, |s| &mut s.dig_in),
        Row::new("dig_in_time", "s", TIME, |s| &mut s.dig_in_time),
        Row::new("immobilised", "1", SHARE, |s| &mut s.immobilised),
        Row::new("immobilised_time", "s", TIME, |s| &mut s.immobilised_time),
        Row::new("release", "1", SHARE, |s| &mut s.release),
        Row::new("stall_torque", "N m", (1e-9, f64::MAX), |s| {
            &mut s.stall_torque
        }),
        Row::new("stall_time", "s", TIME, |s| &mut s.stall_time),
        Row::new("lift_off", "1", SHARE, |s| &mut s.lift_off),
        Row::new("lift_off_time", "s", TIME, |s| &mut s.lift_off_time),
        Row::new("standstill_speed", "m/s", (0.0, 10.0), |s| {
            &mut s.standstill_speed
        }),
    ];

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) with field, value, limits and unit.
    pub fn check(&self) -> Result<()> {
        check_fields("detector", self, Self::FIELDS)
    }
}

type Row = Field<DetectSettings>;

/// Limits of a share that is neither nothing nor all.
const SHARE: (f64, f64) = (1e-3, 0.999);
/// Limits of a time, s.
const TIME: (f64, f64) = (0.0, 1e3);
