//! The multi-pass effect: what a wheel leaves for the wheel behind it.

use grouser_real::Real;

use crate::error::{Error, Result};

/// The law is linear in the number of passes and holds for the wheels of one vehicle; this share is never exceeded, so
/// that K stays positive.
const MAX_CHANGE: f64 = 0.9;

/// How passes of wheels change the soil of a rut, by Senatore and Sandu: with
/// x = (1 − e^(−s_0/k_1)) k_2 + k_3 n_p, s_0 the slip of the pass before and n_p the number of passes,
/// unit weight and cohesion become γ (1 + x) and c (1 + x), the shear modulus K (1 − x). φ stays.
///
/// Unit weight and cohesion together scale Reece's pressure, so that the same factor serves Bekker's moduli. The
/// height of the rut itself is not part of it. Without passes nothing changes.
///
/// Source: Senatore & Sandu, J. Terramechanics 48 (2011), multi-pass effect, after measurements by Holm (1969); the
/// equations are restated from later texts, the original and its coefficients were not seen (unverified). The
/// coefficients are thus always given by the user. Valid range: few passes of loose soil; x is held at 0.9. Assumes:
/// the slip's magnitude counts, driving or braking. Sign: x ≥ 0 strengthens.
///
/// ```
/// use grouser_terra::MultiPass;
/// let law = MultiPass::new(0.1, 0.2, 0.03)?;
/// let change = law.change(0.3, 1);
/// assert!((change.strength_factor - (1.0 + 0.2 * (1.0 - f64::exp(-3.0)) + 0.03)).abs() < 1e-15);
/// assert!((change.strength_factor + change.k_shear_factor - 2.0).abs() < 1e-15);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(
    clippy::struct_field_names,
    reason = "the literature's names of the coefficients"
)]
pub struct MultiPass {
    k_1: f64,
    k_2: f64,
    k_3: f64,
}

/// What passes have made of a soil.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PassChange {
    /// Factor of cohesion and of the pressure-sinkage modulus, 1 + x.
    pub strength_factor: f64,
    /// Factor of the shear deformation modulus, 1 − x.
    pub k_shear_factor: f64,
}

impl MultiPass {
    /// The law with its coefficients: `k_1` the slip over which the effect of slip levels off, `k_2` that effect, `k_3`
    /// the effect of each pass.
    ///
    /// # Errors
    /// [`Error::OutOfRange`]: k_1 outside [0.001, 100], k_2 or k_3 outside [0, 1].
    pub fn new(k_1: f64, k_2: f64, k_3: f64) -> Result<Self> {
        Error::check_range("k_1", k_1, 1e-3, 100.0, "1")?;
        Error::check_range("k_2", k_2, 0.0, 1.0, "1")?;
        Error::check_range("k_3", k_3, 0.0, 1.0, "1")?;
        Ok(Self { k_1, k_2, k_3 })
    }

    /// k_1, k_2 and k_3.
    #[must_use]
    pub const fn numbers(&self) -> [f64; 3] {
        [self.k_1, self.k_2, self.k_3]
    }

    /// The change after `passes`, the last of them at `slip`.
    #[must_use]
    pub fn change(&self, slip: f64, passes: u32) -> PassChange {
        let x = if passes == 0 {
            0.0
        } else {
            // 1 − e^(−a) without cancellation at small slip
            let slipped = -Real::exp_m1(-slip.abs() / self.k_1);
            (slipped * self.k_2 + self.k_3 * f64::from(passes)).min(MAX_CHANGE)
        };
        PassChange {
            strength_factor: 1.0 + x,
            k_shear_factor: 1.0 - x,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn against_values_of_thirty_digits() {
        // Python decimals, 40 digits: (1 - exp(-s/k1)) k2 + k3 n for (k1, k2, k3) = (0.12, 0.17, 0.035)
        let law = MultiPass::new(0.12, 0.17, 0.035).unwrap();
        for (slip, passes, x) in [
            (0.05, 1, 0.092_929_092_865_924_56),
            (0.2, 1, 0.172_891_147_517_614_5),
            (-0.2, 3, 0.242_891_147_517_614_5),
            (1.0, 2, 0.239_959_137_189_008_7),
        ] {
            let change = law.change(slip, passes);
            assert!(
                (change.strength_factor - 1.0 - x).abs() < 1e-15,
                "{slip} {change:?}"
            );
            assert!((change.k_shear_factor - 1.0 + x).abs() < 1e-15);
        }
        let untouched = law.change(0.5, 0);
        assert_eq!(
            (untouched.strength_factor, untouched.k_shear_factor),
            (1.0, 1.0)
        );
        assert!((law.change(0.5, 1000).k_shear_factor - (1.0 - MAX_CHANGE)).abs() < 1e-15);
        for bad in [[0.0, 0.1, 0.1], [0.1, -0.1, 0.1], [0.1, 0.1, f64::NAN]] {
            assert!(MultiPass::new(bad[0], bad[1], bad[2]).is_err());
        }
    }
}
