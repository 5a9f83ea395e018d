//! Slip-sinkage as transport: a driving rim carries a layer of soil backwards.

use grouser_real::Scalar;

use crate::contact::Motion;

/// Least travel over rim speed: a wheel that spins on the spot digs 10⁹ layers, not infinitely many.
const MIN_TRAVEL: f64 = 1e-9;

/// How much deeper a driving wheel sinks because it carries soil backwards: z_t = δ (rω − v_x)⁺/V, m.
///
/// A layer of thickness `layer` δ (m) moves with the wheel, so that over each metre of travel (rω − v_x)/V metres
/// of it pass under the wheel and are laid down behind; straight ahead that is s/(1 − s). The wheel rolls on the
/// ground of that rut: its sinkage is z_t and the depth of its contact, and no stress changes. There is no transport
/// below s = 0. Without bound as s → 1: a wheel that spins on the spot digs for ever.
///
/// Source: Reece's slip-sinkage of a lugged wheel, which adds h s/(1 − s) with the height h of the lug to the sinkage
/// (as restated in later texts; the original was not seen). That drift counts as travel is ours. Valid range: steady
/// driving. Assumes: nothing flows back into the rut. Sign: positive downwards. `layer` 0 switches it off.
///
/// ```
/// use grouser_terra::{Kinematics, Slip, transport_depth_reece};
/// let depth = |s| -> grouser_terra::Result<f64> {
///     Ok(transport_depth_reece(0.005, &Kinematics::straight(Slip::new(s)?).motion()))
/// };
/// assert!((depth(0.5)? - 0.005).abs() < 1e-15);
/// assert_eq!(depth(-0.5)?, 0.0);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
pub fn transport_depth_reece<R: Scalar>(layer: R, motion: &Motion<R>) -> R {
    let speeds = motion.speeds();
    let driving = (speeds.rim - speeds.forward).max(R::ZERO);
    layer * driving / speeds.travel.max(R::from_f64(MIN_TRAVEL))
}
