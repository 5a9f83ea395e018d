//! Slip-sinkage as transport: a driving rim carries a layer of soil backwards.

use grouser_real::Scalar;

/// How much deeper a driving wheel sits because it carries soil backwards: z_t = δ s/(1 − s), m.
///
/// A layer of thickness `layer` δ (m) moves with the rim, so that over each metre of travel s/(1 − s) metres
/// of it pass under the wheel and are laid down behind. `slip` is the driving part of the slip; there is no
/// transport below 0. Without bound as s → 1: a wheel that spins on the spot digs for ever.
///
/// Source: Reece's slip-sinkage of a lugged wheel, h s/(1 − s) with the height h of the lug (as restated in
/// later texts; the original was not seen). Valid range: steady driving. Assumes: nothing flows back into
/// the rut. Sign: positive downwards. `layer` 0 switches it off.
///
/// ```
/// use grouser_terra::transport_depth_reece;
/// assert!((transport_depth_reece(0.005, 0.5_f64) - 0.005).abs() < 1e-15);
/// assert_eq!(transport_depth_reece(0.005, -0.5), 0.0);
/// ```
pub fn transport_depth_reece<R: Scalar>(layer: R, slip: R) -> R {
    let driving = slip.max(R::ZERO);
    let rest = (R::ONE - driving).max(R::from_f64(1e-9));
    layer * driving / rest
}

/// What is left of the pressure where the ground has been lowered by `dug` under a wheel sunk by `sinkage`
/// (both m): (1 − z_t/z)ⁿ, the same for every point of the contact.
pub(crate) fn share_left<R: Scalar>(dug: R, sinkage: R, n: R) -> R {
    let left = R::ONE - dug / sinkage;
    if left.value() > 0.0 {
        left.powf(n)
    } else {
        R::ZERO
    }
}
