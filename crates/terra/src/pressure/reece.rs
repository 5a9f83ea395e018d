//! Reece's pressure-sinkage law.

use grouser_real::Real;

/// Pressure under a plate by Reece: p(z) = (c k_c′ + γ b k_phi′) (z/b)ⁿ.
///
/// Gives a pressure in Pa; the moduli are pure numbers, so they do not change with n.
///
/// Source: Reece, Proc. Inst. Mech. Engrs 180 (1965), as restated by Wong & Reece \[WR67\].
/// Valid range: as Bekker's law. Assumes: γ is the unit weight ρ g in N/m³ (what papers print as ρ is
/// often ρ g). Sign: positive downwards.
///
/// ```
/// use grouser_terra::Reece;
/// let soil = Reece { k_c_prime: 0.0, k_phi_prime: 10.0 };
/// // c = 0, γ = 16 kN/m³, b = 0.1 m: 16 kPa at z = b, whatever n
/// assert!((soil.modulus(0.0, 16e3, 0.1, 1.3) * 0.1_f64.powf(1.3) - 16e3).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reece<R = f64> {
    /// Cohesive modulus k_c′, a pure number.
    pub k_c_prime: R,
    /// Frictional modulus k_phi′, a pure number.
    pub k_phi_prime: R,
}

impl<R: Real> Reece<R> {
    /// (c k_c′ + γ b k_phi′)/bⁿ in Pa/mⁿ, with `cohesion` in Pa, `gamma` in N/m³ and `width` in m.
    pub fn modulus(&self, cohesion: R, gamma: R, width: R, n: R) -> R {
        (cohesion * self.k_c_prime + gamma * width * self.k_phi_prime) / width.powf(n)
    }
}
