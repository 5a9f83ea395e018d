//! When something is called an event: one value per line, each with its default.

use crate::error::{Result, check_range};

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
    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) with field, value, limits and unit.
    pub fn check(&self) -> Result<()> {
        let (share, time) = ((1e-3, 0.999), (0.0, 1e3));
        let rows = [
            ("certainty", self.certainty, (0.0, 10.0), "1"),
            ("high_slip", self.high_slip, share, "1"),
            ("high_slip_time", self.high_slip_time, time, "s"),
            ("dig_in", self.dig_in, share, "1"),
            ("dig_in_time", self.dig_in_time, time, "s"),
            ("immobilised", self.immobilised, share, "1"),
            ("immobilised_time", self.immobilised_time, time, "s"),
            ("release", self.release, share, "1"),
            ("stall_torque", self.stall_torque, (1e-9, f64::MAX), "N m"),
            ("stall_time", self.stall_time, time, "s"),
            ("lift_off", self.lift_off, share, "1"),
            ("lift_off_time", self.lift_off_time, time, "s"),
            (
                "standstill_speed",
                self.standstill_speed,
                (0.0, 10.0),
                "m/s",
            ),
        ];
        for (field, value, limits, unit) in rows {
            check_range("detector", field, value, limits, unit)?;
        }
        Ok(())
    }
}
