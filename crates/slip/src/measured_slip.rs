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
    /// q = v/(r ω), driving: σ_s² = (σ_v² + q² σ_u²)/u²; braking: σ_s² = (σ_u² + σ_v²/q²)/v², with v two sigma
    /// nearer to the rim's speed: the slip changes with v least where an error of v is greatest.
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
            // above 0, for one of the two is outside its noise
            let v = (v.abs() - 2.0 * forward.sigma()).max(u.abs());
            let inverse_q = u / v;
            Real::sqrt(rim.variance + inverse_q * inverse_q * forward.variance) / v
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

#[cfg(test)]
mod tests {
    use super::*;

    fn of(forward: (f64, f64), rim: (f64, f64)) -> MeasuredSlip {
        let speed = |(value, sigma): (f64, f64)| Measured {
            value,
            variance: sigma * sigma,
        };
        MeasuredSlip::from_speeds(speed(forward), speed(rim), &SlipLimits::default())
    }

    /// The limits are 2 mm/s, 10 mm/s and 0.25.
    #[test]
    fn a_speed_exactly_at_a_limit_is_within_it() {
        let motion = |v, u| of((v, 0.0), (u, 0.0)).motion;
        assert_eq!(motion(0.002, 0.001), Motion::Standstill);
        assert_eq!(motion(0.001, 0.002), Motion::Standstill);
        assert_eq!(motion(-0.002, 0.1), Motion::Driving);
        assert_eq!(motion(0.1, -0.002), Motion::Braking);
        assert_eq!(motion(-0.0021, 0.1), Motion::RollBack);
        assert_eq!(motion(0.1, -0.0021), Motion::RollBack);
        // two sigma are the limit where they are more
        assert_eq!(of((-0.0041, 0.002), (0.1, 0.0)).motion, Motion::RollBack);
        assert_eq!(of((-0.0039, 0.002), (0.1, 0.0)).motion, Motion::Driving);
        assert_eq!(of((0.1, 0.0), (-0.0041, 0.002)).motion, Motion::RollBack);
        assert_eq!(of((0.1, 0.0), (-0.0039, 0.002)).motion, Motion::Braking);
        let low = Health::Degraded(Degraded::LowSpeed);
        assert_eq!(of((0.008, 0.0), (0.0099, 0.0)).health, low);
        assert_eq!(of((0.008, 0.0), (0.01, 0.0)).health, Health::Ok);
        assert_eq!(of((0.5, 0.25), (1.0, 0.0)).health, Health::Ok);
        let quantised = Health::Degraded(Degraded::Quantised);
        assert_eq!(of((0.5, 0.251), (1.0, 0.0)).health, quantised);
    }

    /// First-order propagation of both errors, by differences of the slip itself; braking at the speed nearer to the rim's.
    #[test]
    fn a_sigma_is_that_of_both_speeds() {
        let slip = |v, u| Slip::from_speeds(v, u).unwrap().value();
        let expected = |at_v: f64, u: f64, (of_v, of_u): (f64, f64)| {
            let step = 1e-6;
            let by_v = (slip(at_v + step, u) - slip(at_v - step, u)) / (2.0 * step);
            let by_u = (slip(at_v, u + step) - slip(at_v, u - step)) / (2.0 * step);
            (by_v * of_v).hypot(by_u * of_u)
        };
        let sigmas = (0.02, 0.015);
        for (v, at_v, u) in [
            (0.06, 0.06, 0.12),
            (0.15, 0.15, 0.3),
            // two sigma nearer
            (0.2, 0.16, 0.1),
            (0.5, 0.46, 0.3),
        ] {
            for sign in [1.0, -1.0] {
                let seen = of((sign * v, sigmas.0), (sign * u, sigmas.1));
                assert_eq!(seen.slip.unwrap().value(), slip(v, u));
                let (sigma, expected) = (seen.sigma.unwrap(), expected(at_v, u, sigmas));
                assert!(
                    (sigma / expected - 1.0).abs() < 1e-6,
                    "{v}: {sigma}, {expected}"
                );
            }
        }
        // but not beyond the rim's, where both errors weigh the same
        let sigma = of((0.12, sigmas.0), (0.1, sigmas.1)).sigma.unwrap();
        assert!((sigma - 0.25).abs() < 1e-12);
        // a rim that stands shows its own error alone
        let standing = of((0.2, 0.05), (0.0, 0.01));
        assert_eq!(standing.slip.unwrap().value(), -1.0);
        assert!((standing.sigma.unwrap() - 0.1).abs() < 1e-12);
    }

    /// A noisy speed of the ground that comes out fast looks like a braking wheel, whose slip hardly depends on it.
    #[test]
    fn slips_by_a_noisy_speed_that_are_ok_are_within_their_sigmas() {
        let mut bits = 1_u64;
        let mut normal = || {
            let mut sum = -6.0;
            for _ in 0..12 {
                bits ^= bits << 13;
                bits ^= bits >> 7;
                bits ^= bits << 17;
                sum += (bits >> 11) as f64 / (1_u64 << 53) as f64;
            }
            sum
        };
        for (speed, rim, sigma) in [(0.2, 0.2, 0.28), (0.14, 0.2, 0.1), (0.3, 0.2, 0.05)] {
            let truth = Slip::from_speeds(speed, rim).unwrap().value();
            let (mut count, mut wrong) = (0, 0);
            for _ in 0..20_000 {
                let forward = Measured {
                    value: speed + sigma * normal(),
                    variance: sigma * sigma,
                };
                let rim = Measured {
                    value: rim,
                    variance: 0.0,
                };
                let seen = MeasuredSlip::from_speeds(forward, rim, &SlipLimits::default());
                if let (Some(slip), Some(sigma), Health::Ok) = (seen.slip, seen.sigma, seen.health)
                {
                    count += 1;
                    wrong += usize::from((slip.value() - truth).abs() > 4.0 * sigma);
                }
            }
            println!("{speed}, {sigma} m/s: {wrong} of {count}");
            // four sigma of the 20 000 are 1.3
            assert!(wrong <= 400, "{speed}, {sigma} m/s: {wrong} of {count}");
        }
    }
}
