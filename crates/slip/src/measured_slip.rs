//! A slip from two measured speeds, with its sigma and the motion that they show.

use grouser_real::Real;
use grouser_terra::Slip;

use crate::speed::Measured;
use crate::state::{Degraded, Health, Motion};

/// The limits below which a slip is not a number, or not to be trusted.
///
/// ```
/// use grouser_slip::{Measured, MeasuredSlip, Motion, SlipLimits};
///
/// let mut limits = SlipLimits::default();
/// limits.standstill_speed = 0.05; // m/s
/// let slow = Measured { value: 0.02, variance: 0.0 };
/// assert_eq!(MeasuredSlip::from_speeds(slow, slow, &limits).motion, Motion::Standstill);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SlipLimits {
    /// A wheel or a robot slower than this stands still, m/s.
    pub standstill_speed: f64,
    /// Below this speed (the faster of the two) the slip is not computed, m/s.
    pub low_speed: f64,
    /// A slip with a larger sigma is marked as quantised.
    pub max_sigma: f64,
}

impl Default for SlipLimits {
    fn default() -> Self {
        Self {
            standstill_speed: 0.002,
            low_speed: 0.01,
            max_sigma: 0.25,
        }
    }
}

/// The slip of two measured speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeasuredSlip {
    /// The slip; `None` where the speeds define none worth a number.
    pub slip: Option<Slip>,
    /// Standard deviation of its error.
    pub sigma: Option<f64>,
    /// How the wheel moves.
    pub motion: Motion,
    /// How far the slip can be trusted.
    pub health: Health,
}

impl MeasuredSlip {
    /// The slip of a wheel that travels at `forward` while its rim runs at `rim`, both in m/s.
    ///
    /// A speed within its noise (two sigma, at least `standstill_speed`) may have any sign: both
    /// within it is a standstill; speeds of opposite sign, both outside it, are a roll-back. With
    /// q = v/(r ω), driving: σ_s² = (σ_v² + q² σ_u²)/u²; braking: σ_s² = (σ_u² + σ_v²/q²)/v².
    ///
    /// Assumes: errors small against the faster speed, which `max_sigma` marks.
    ///
    /// ```
    /// use grouser_slip::{Measured, MeasuredSlip, SlipLimits};
    /// let speed = |value, sigma: f64| Measured { value, variance: sigma * sigma };
    /// let s = MeasuredSlip::from_speeds(speed(0.08, 0.002), speed(0.10, 0.001), &SlipLimits::default());
    /// assert!((s.slip.unwrap().value() - 0.2).abs() < 1e-15);
    /// assert!((s.sigma.unwrap() - 0.021_541).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn from_speeds(forward: Measured, rim: Measured, limits: &SlipLimits) -> Self {
        let floor = limits.standstill_speed;
        let (noise_v, noise_u) = (
            (2.0 * forward.sigma()).max(floor),
            (2.0 * rim.sigma()).max(floor),
        );
        let (mut v, mut u) = (forward.value, rim.value);
        if v.abs() <= noise_v && u.abs() <= noise_u {
            return Self::without_slip(Motion::Standstill, Health::Ok);
        }
        if v * u < 0.0 {
            if v.abs() <= noise_v {
                v = 0.0;
            } else if u.abs() <= noise_u {
                u = 0.0;
            } else {
                return Self::without_slip(Motion::RollBack, Health::Ok);
            }
        }
        let Ok(slip) = Slip::from_speeds(v, u) else {
            return Self::without_slip(Motion::Standstill, Health::Ok);
        };
        let driving = slip.is_driving();
        let motion = if driving {
            Motion::Driving
        } else {
            Motion::Braking
        };
        if v.abs().max(u.abs()) < limits.low_speed {
            return Self::without_slip(motion, Health::Degraded(Degraded::LowSpeed));
        }
        let sigma = if driving {
            let q = v / u;
            Real::sqrt(forward.variance + q * q * rim.variance) / u.abs()
        } else {
            let inverse_q = u / v;
            Real::sqrt(rim.variance + inverse_q * inverse_q * forward.variance) / v.abs()
        };
        let health = if sigma <= limits.max_sigma {
            Health::Ok
        } else {
            Health::Degraded(Degraded::Quantised)
        };
        Self {
            slip: Some(slip),
            sigma: Some(sigma),
            motion,
            health,
        }
    }

    const fn without_slip(motion: Motion, health: Health) -> Self {
        Self {
            slip: None,
            sigma: None,
            motion,
            health,
        }
    }
}
