//! Shear strength of the soil: Mohr-Coulomb.

use grouser_real::Real;

/// Shear strength by Mohr-Coulomb: τ_max = c + σ tan φ ((P2) and (P7) of \[Ani2012\]).
///
/// Gives Pa for a normal stress σ in Pa.
///
/// Source: Wong, *Theory of Ground Vehicles* \[Wong08\], chapter 2. Assumes: drained, no tension.
/// Sign: σ positive in compression.
///
/// ```
/// use grouser_terra::MohrCoulomb;
/// let sand = MohrCoulomb { cohesion: 1000.0, phi: 30_f64.to_radians() };
/// assert!((sand.strength(10e3) - 6773.50269).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MohrCoulomb<R = f64> {
    /// Cohesion c, Pa.
    pub cohesion: R,
    /// Angle of internal friction φ, rad.
    pub phi: R,
}

impl<R: Real> MohrCoulomb<R> {
    /// The strength in Pa under the normal stress `sigma` (Pa).
    pub fn strength(&self, sigma: R) -> R {
        self.cohesion + sigma * self.phi.tan()
    }
}
