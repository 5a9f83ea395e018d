//! Slip: one definition, its named conversions, and what is not a slip at all.

use crate::error::{Error, Result};

/// Slip of a wheel, in [−1, 1]: positive driving, negative braking (skid).
///
/// With v the forward speed of the wheel's centre in its own plane and r ω its circumferential speed,
/// both positive forwards, and q = v/(r ω) the ratio that the mechanics needs:
///
/// - driving, |r ω| ≥ |v|: s = 1 − v/(r ω) = 1 − q, in [0, 1];
/// - braking, |r ω| < |v|: s = r ω/v − 1, so q = 1/(1 + s), in [−1, 0); s = −1 is the locked wheel.
///
/// Source: the convention of Wong, *Theory of Ground Vehicles*, for driving and braking alike.
/// Sign: positive when the wheel turns faster than it travels.
///
/// ```
/// use grouser_terra::Slip;
/// let driving = Slip::from_speeds(0.08, 0.10)?; // travels 8 cm/s, its rim runs 10 cm/s
/// assert!((driving.value() - 0.2).abs() < 1e-15);
/// let braking = Slip::from_speeds(0.10, 0.08)?;
/// assert!((braking.value() + 0.2).abs() < 1e-15);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Slip(f64);

impl Slip {
    /// The wheel rolls without slip.
    pub const ZERO: Self = Self(0.0);

    /// A slip of `value`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] outside [−1, 1] and for NaN.
    #[inline]
    pub fn new(value: f64) -> Result<Self> {
        Error::check_range("slip", value, -1.0, 1.0, "1")?;
        Ok(Self(value))
    }

    /// The slip of a wheel that travels at `forward_speed` while its rim runs at `rim_speed`, in m/s.
    ///
    /// Both speeds negative is the mirror image of both positive: the same slip. Measured speeds go
    /// through [`WheelMotion::from_speeds`], which recognises a standstill.
    ///
    /// # Errors
    /// [`Error::NoSlip`] when both are zero (standstill) or their signs are opposite (roll-back);
    /// [`Error::NotFinite`] for NaN and infinity.
    pub fn from_speeds(forward_speed: f64, rim_speed: f64) -> Result<Self> {
        Error::check_finite("forward_speed", forward_speed, "m/s")?;
        Error::check_finite("rim_speed", rim_speed, "m/s")?;
        if (forward_speed == 0.0 && rim_speed == 0.0)
            || (forward_speed > 0.0 && rim_speed < 0.0)
            || (forward_speed < 0.0 && rim_speed > 0.0)
        {
            return Err(Error::NoSlip {
                forward_speed,
                rim_speed,
            });
        }
        Ok(if rim_speed.abs() >= forward_speed.abs() {
            Self(1.0 - forward_speed / rim_speed)
        } else {
            Self(rim_speed / forward_speed - 1.0)
        })
    }

    /// The slip at the speed ratio q = v/(r ω) ≥ 0; q = ∞ is the locked wheel.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for q < 0 and NaN.
    pub fn from_speed_ratio(q: f64) -> Result<Self> {
        Error::check_range("q", q, 0.0, f64::INFINITY, "1")?;
        Ok(Self(if q <= 1.0 { 1.0 - q } else { 1.0 / q - 1.0 }))
    }

    /// The slip whose driving formula, continued below zero, gives `one_minus_q` = 1 − v/(r ω).
    ///
    /// \[Ani2012\] writes its analytical model in this form: S = 1 − q for driving and braking alike,
    /// so s = S for S ≥ 0 and s = S/(1 − S) for S < 0.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for S > 1 and NaN.
    pub fn from_driving_formula(one_minus_q: f64) -> Result<Self> {
        Error::check_range("one_minus_q", one_minus_q, f64::NEG_INFINITY, 1.0, "1")?;
        Self::from_speed_ratio(1.0 - one_minus_q)
    }

    /// The number, in [−1, 1].
    #[must_use]
    #[inline]
    pub const fn value(self) -> f64 {
        self.0
    }

    /// q = v/(r ω), from 0 (spinning) by 1 (no slip) to ∞ (locked).
    ///
    /// ```
    /// # use grouser_terra::Slip;
    /// assert_eq!(Slip::new(0.25)?.speed_ratio(), 0.75);
    /// assert_eq!(Slip::new(-0.5)?.speed_ratio(), 2.0); // the wheel turns at half of the ground's speed
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[must_use]
    pub fn speed_ratio(self) -> f64 {
        if self.0 >= 0.0 {
            1.0 - self.0
        } else {
            1.0 / (1.0 + self.0)
        }
    }

    /// Is the wheel driving (s ≥ 0)?
    #[must_use]
    pub fn is_driving(self) -> bool {
        self.0 >= 0.0
    }
}

/// What a wheel's two speeds say of its motion.
///
/// Opposite signs and standstill are states of their own and never a clamped number.
///
/// ```
/// use grouser_terra::WheelMotion;
///
/// assert_eq!(WheelMotion::from_speeds(0.001, -0.001, 0.01)?, WheelMotion::Standstill);
/// assert_eq!(WheelMotion::from_speeds(0.1, -0.1, 0.01)?, WheelMotion::RollBack);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WheelMotion {
    /// The wheel rolls, with slip; `reversed` when both speeds are negative (the mirror image: contact
    /// angles, drawbar pull and torque change sign).
    Rolling {
        /// Its slip.
        slip: Slip,
        /// Does it roll backwards?
        reversed: bool,
    },
    /// Both speeds are below their noise.
    Standstill,
    /// The wheel travels against its own rotation.
    RollBack,
}

impl WheelMotion {
    /// The motion of a wheel whose speeds (m/s) are known to within `speed_noise` (m/s): a speed below
    /// it counts as zero.
    ///
    /// # Errors
    /// [`Error::NotFinite`] and [`Error::OutOfRange`] for what is not a number or a negative noise.
    pub fn from_speeds(forward_speed: f64, rim_speed: f64, speed_noise: f64) -> Result<Self> {
        Error::check_finite("forward_speed", forward_speed, "m/s")?;
        Error::check_finite("rim_speed", rim_speed, "m/s")?;
        Error::check_range("speed_noise", speed_noise, 0.0, f64::MAX, "m/s")?;
        let settle = |speed: f64| {
            if speed.abs() <= speed_noise {
                0.0
            } else {
                speed
            }
        };
        let (forward, rim) = (settle(forward_speed), settle(rim_speed));
        match Slip::from_speeds(forward, rim) {
            Ok(slip) => Ok(Self::Rolling {
                slip,
                reversed: forward < 0.0 || rim < 0.0,
            }),
            Err(_) if forward == 0.0 => Ok(Self::Standstill),
            Err(_) => Ok(Self::RollBack),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_branches_meet_at_zero_and_invert_their_speed_ratio() {
        for i in -1000..=1000 {
            let s = f64::from(i) / 1000.0;
            let slip = Slip::new(s).unwrap();
            let back = Slip::from_speed_ratio(slip.speed_ratio()).unwrap();
            assert!((back.value() - s).abs() < 4e-16);
        }
        assert_eq!(Slip(-1.0).speed_ratio(), f64::INFINITY);
    }

    #[test]
    fn states_that_are_no_slip() {
        assert!(matches!(
            Slip::from_speeds(0.0, 0.0),
            Err(Error::NoSlip { .. })
        ));
        assert!(matches!(
            Slip::from_speeds(0.1, -0.1),
            Err(Error::NoSlip { .. })
        ));
        assert!(matches!(Slip::new(f64::NAN), Err(Error::OutOfRange(_))));
        assert_eq!(
            WheelMotion::from_speeds(0.001, -0.001, 0.002),
            Ok(WheelMotion::Standstill)
        );
        assert_eq!(
            WheelMotion::from_speeds(0.1, -0.1, 0.002),
            Ok(WheelMotion::RollBack)
        );
        assert_eq!(
            WheelMotion::from_speeds(-0.001, 0.1, 0.002),
            Ok(WheelMotion::Rolling {
                slip: Slip(1.0),
                reversed: false
            })
        );
        assert_eq!(
            WheelMotion::from_speeds(-0.1, 0.0, 0.002),
            Ok(WheelMotion::Rolling {
                slip: Slip(-1.0),
                reversed: true
            })
        );
    }
}
