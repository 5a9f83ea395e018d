//! How much of its strength a soil shows after a shear displacement: Janosi and Hanamoto.

use grouser_real::Real;

/// The mobilised share of strength by Janosi and Hanamoto: x = 1 − e^(−|j|/K), in [0, 1).
///
/// `displacement` j and `k_shear` K in the same unit. τ = x·(c + σ tan φ) is (P1) of \[Ani2012\].
///
/// Source: Janosi & Hanamoto, 1st Int. Conf. Terrain-Vehicle Systems, Turin 1961 \[JH61\].
/// Valid range: soils without a peak of strength (loose sand, most disturbed ground). Assumes K is one
/// number for the soil, or depends on the slip angle (see `Soil`). Sign: a share, without one.
///
/// ```
/// use grouser_terra::mobilised_janosi;
/// // one shear modulus of displacement shows 1 − 1/e of the strength
/// assert!((mobilised_janosi(0.025_f64, 0.025) - 0.632_120_558_828_557_7).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn mobilised_janosi<R: Real>(displacement: R, k_shear: R) -> R {
    -(-displacement.abs() / k_shear).exp_m1()
}
