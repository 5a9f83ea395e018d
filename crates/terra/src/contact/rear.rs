//! How much of the contact behind the lowest point a slipping wheel keeps.

use grouser_real::Scalar;

use crate::slip_velocity::SlipVelocity;

/// The share of the rear contact's length that is left: (1 − ε_1 s_x⁺)⁺ (1 − ε_2 s_y)⁺.
///
/// Driving slip carries the soil away that would press against the rear of the rim (ε_1 = `driving`); drift
/// leaves it beside the wheel (ε_2 = `drift`, 1 where a wheel that only drifts has no rear). The rebound ratio
/// λ is that of a wheel without slip; the exit is θ_2 = −2 arcsin(f √λ sin(θ_1/2)) with this share f.
///
/// Source: ours; exit angles linear in slip are as old as \[Ding11\], where they may become positive, which a
/// rigid wheel in steady motion cannot have. Valid range: loose dry soil. ε_1 = ε_2 = 0 switches it off.
pub(crate) fn rear_share<R: Scalar>(slip: &SlipVelocity<R>, driving: R, drift: R) -> R {
    let left = |loss: R| (R::ONE - loss).max(R::ZERO);
    left(driving * slip.driving()) * left(drift * slip.across)
}
