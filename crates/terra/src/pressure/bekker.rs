//! Bekker's pressure-sinkage law.

use grouser_real::Real;

/// Pressure under a plate by Bekker: p(z) = (k_c/b + k_phi) zⁿ.
///
/// Gives a pressure in Pa for a sinkage z in m; b is the smaller side of the contact, here the wheel's
/// width, in m.
///
/// Source: Bekker, *Introduction to Terrain-Vehicle Systems*, 1969 \[Bekker69\].
/// Valid range: monotonic loading of homogeneous ground; plates of a few centimetres and more.
/// Assumes: k_c and k_phi are constant in the units of their own n.
/// Sign: positive downwards. k_c may be negative in published fits as long as the sum is positive.
///
/// ```
/// use grouser_terra::Bekker;
/// // dry sand of the planetary-rover papers, 10 mm under a wheel 100 mm wide
/// let sand = Bekker { k_c: 0.9e3, k_phi: 1528.4e3 };
/// let p = sand.modulus(0.1) * 0.01_f64.powf(1.1);
/// assert!((p - 9700.34).abs() < 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bekker<R = f64> {
    /// Cohesive modulus, N/m^(n+1).
    pub k_c: R,
    /// Frictional modulus, N/m^(n+2).
    pub k_phi: R,
}

impl<R: Real> Bekker<R> {
    /// k_c/b + k_phi for a contact of `width` (m), in Pa/mⁿ.
    pub fn modulus(&self, width: R) -> R {
        self.k_c / width + self.k_phi
    }
}
