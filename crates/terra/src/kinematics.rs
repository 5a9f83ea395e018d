//! How a wheel moves over the ground: its slip along and its drift across.

use grouser_real::Real;

use crate::angle::Angle;
use crate::error::{Error, Result};
use crate::slip::{Slip, WheelMotion};

/// The motion of a wheel at one operating point.
///
/// y points to the left of travel; the slip angle is β = atan2(v_y, v_x) and q_y = v_y/(r ω) the
/// lateral counterpart of q, finite where β is 90°.
///
/// ```
/// use grouser_terra::{Angle, Kinematics, Slip};
///
/// let straight = Kinematics::straight(Slip::new(0.2)?);
/// assert_eq!(straight.slip_angle().rad(), 0.0);
/// let drifting = Kinematics::with_slip_angle(Slip::new(0.2)?, Angle::from_deg(45.0))?;
/// assert!((drifting.q_y() - 0.8).abs() < 1e-12); // v_y = v_x = 0.8 r ω
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinematics {
    slip: Slip,
    /// `None`: that of slip and q_y, computed where a law asks for it.
    slip_angle: Option<f64>,
    q_y: f64,
    reversed: bool,
}

impl Kinematics {
    /// Straight ahead at `slip`.
    #[must_use]
    pub const fn straight(slip: Slip) -> Self {
        Self {
            slip,
            slip_angle: Some(0.0),
            q_y: 0.0,
            reversed: false,
        }
    }

    /// At `slip` in the wheel's own plane, drifting at the slip angle `beta`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless |β| < 90°: there the forward speed is zero, whatever the drift, so
    /// the speeds are needed ([`Kinematics::from_speeds`]).
    pub fn with_slip_angle(slip: Slip, beta: Angle) -> Result<Self> {
        let limit = 89.9_f64.to_radians();
        Error::check_range("slip_angle", beta.rad(), -limit, limit, "rad")?;
        let tangent = beta.tan();
        let q = slip.speed_ratio();
        let q_y = if q.is_infinite() {
            tangent
        } else {
            q * tangent
        };
        Ok(Self {
            slip,
            slip_angle: Some(beta.rad()),
            q_y,
            reversed: false,
        })
    }

    /// From the speed of the wheel's centre along and across its plane and the speed of its rim, m/s.
    ///
    /// # Errors
    /// [`Error::NoSlip`] at standstill and when the wheel travels against its rotation;
    /// [`Error::NotFinite`] for NaN and infinity.
    ///
    /// ```
    /// use grouser_terra::Kinematics;
    ///
    /// let motion = Kinematics::from_speeds(0.08, 0.0, 0.1)?;
    /// assert!((motion.slip().value() - 0.2).abs() < 1e-12);
    /// assert!(Kinematics::from_speeds(0.0, 0.0, 0.0).is_err()); // no slip at standstill
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn from_speeds(v_x: f64, v_y: f64, rim_speed: f64) -> Result<Self> {
        Error::check_finite("v_y", v_y, "m/s")?;
        let WheelMotion::Rolling { slip, reversed } =
            WheelMotion::from_speeds(v_x, rim_speed, 0.0)?
        else {
            return Err(Error::NoSlip {
                forward_speed: v_x,
                rim_speed,
            });
        };
        // A wheel that rolls backwards is the mirror image of one that rolls forwards; left stays left.
        let (forward, rim) = (v_x.abs(), rim_speed.abs());
        let q_y = if rim == 0.0 { v_y / forward } else { v_y / rim };
        Ok(Self {
            slip,
            slip_angle: Some(Real::atan2(v_y, forward)),
            q_y,
            reversed,
        })
    }

    /// At `slip`, drifting at `drift` = v_y/max(|v_x|, |r ω|), forwards: what slips over time are made of.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a drift of NaN or infinity.
    ///
    /// ```
    /// use grouser_terra::{Kinematics, Slip};
    ///
    /// let motion = Kinematics::with_drift(Slip::new(0.2)?, 0.1)?;
    /// let speeds = Kinematics::from_speeds(0.8, 0.1, 1.0)?;
    /// assert!((motion.slip_angle().rad() - speeds.slip_angle().rad()).abs() < 1e-15);
    /// assert!((motion.q_y() - speeds.q_y()).abs() < 1e-15);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[inline]
    pub fn with_drift(slip: Slip, drift: f64) -> Result<Self> {
        Error::check_finite("drift", drift, "1")?;
        let rim = 1.0 + slip.value().min(0.0);
        Ok(Self {
            slip,
            slip_angle: None,
            q_y: if rim == 0.0 { drift } else { drift / rim },
            reversed: false,
        })
    }

    /// Slip in the wheel's plane.
    #[must_use]
    #[inline]
    pub const fn slip(&self) -> Slip {
        self.slip
    }

    /// Slip angle β, positive when the wheel drifts to its left.
    #[must_use]
    #[inline]
    pub fn slip_angle(&self) -> Angle {
        Angle::from_rad(self.slip_angle.unwrap_or_else(|| {
            let s = self.slip.value();
            let (forward, rim) = (1.0 - s.max(0.0), 1.0 + s.min(0.0));
            let drift = if rim == 0.0 { self.q_y } else { self.q_y * rim };
            Real::atan2(drift, forward)
        }))
    }

    /// q_y = v_y/(r ω); for a locked wheel v_y/v_x.
    #[must_use]
    #[inline]
    pub const fn q_y(&self) -> f64 {
        self.q_y
    }

    /// Does the wheel roll backwards?
    #[must_use]
    #[inline]
    pub const fn is_reversed(&self) -> bool {
        self.reversed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slip_and_drift_show_the_slip_angle() {
        for s in [-1.0, -0.6, 0.0, 0.3, 0.999, 1.0] {
            for drift in [-3.0, -0.2, 0.0, 1e-9, 0.7] {
                let motion = Kinematics::with_drift(Slip::new(s).unwrap(), drift).unwrap();
                let (forward, rim) = if s < 0.0 {
                    (1.0, 1.0 + s)
                } else {
                    (1.0 - s, 1.0)
                };
                let speeds = Kinematics::from_speeds(forward, drift, rim).unwrap();
                let off = motion.slip_angle().rad() - speeds.slip_angle().rad();
                assert!(off.abs() < 1e-15, "{s} {drift}: {off:e}");
            }
        }
    }
}
