//! Where the contact begins, ends and presses hardest.

use grouser_real::Real;

/// Entry angle θ_1 of a wheel sunk by `sinkage` at `radius` (both m), rad:
/// θ_1 = arccos(1 − z/r) = 2 arcsin √(z/2r) ((P18) of \[Ani2012\]).
///
/// The second form keeps its digits at small sinkage. Valid range: 0 ≤ z < r. Sign: from the vertical,
/// positive towards travel.
///
/// ```
/// use grouser_terra::entry_angle;
/// assert!((entry_angle(0.05_f64, 0.1).to_degrees() - 60.0).abs() < 1e-12);
/// ```
pub fn entry_angle<R: Real>(sinkage: R, radius: R) -> R {
    let two = R::from_f64(2.0);
    two * (sinkage / (two * radius)).sqrt().asin()
}

/// Sinkage in m at the entry angle `theta_1` (rad): z = r (1 − cos θ_1) = 2 r sin²(θ_1/2), the inverse
/// of [`entry_angle`].
///
/// It is also how a contact angle measured by a camera becomes a sinkage (\[Ani2012\], section 5).
pub fn sinkage_from_entry_angle<R: Real>(theta_1: R, radius: R) -> R {
    let sine = (R::from_f64(0.5) * theta_1).sin();
    R::from_f64(2.0) * radius * sine * sine
}

/// The three angles of a contact, rad: θ_2 ≤ 0 ≤ θ_m ≤ θ_1, from the vertical, positive towards travel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactAngles<R = f64> {
    /// Entry: where the rim meets the undisturbed ground.
    pub theta_1: R,
    /// Exit: where it leaves the ground.
    pub theta_2: R,
    /// Where the normal stress is greatest.
    pub theta_m: R,
}

impl<R: Real> ContactAngles<R> {
    /// From the entry angle: θ_2 = −2 arcsin √(λ z/2r) = −2 arcsin(√λ sin(θ_1/2)) with the rebound ratio
    /// λ, and θ_m = clamp(`position`, 0, 1)·θ_1, where `position` is c_1 + c_2 s \[WR67\].
    pub fn new(theta_1: R, rebound: R, position: R) -> Self {
        let rises = R::ZERO.lt(rebound);
        let root = R::select(rises, rebound, R::ONE).sqrt();
        let exit = R::from_f64(-2.0) * (root * (R::from_f64(0.5) * theta_1).sin()).asin();
        Self {
            theta_1,
            theta_2: R::select(rises, exit, R::ZERO),
            theta_m: position.clamp(R::ZERO, R::ONE) * theta_1,
        }
    }

    /// [`ContactAngles::new`] on soil without rebound: θ_2 = 0.
    pub(crate) fn without_rebound(theta_1: R, position: R) -> Self {
        Self {
            theta_1,
            theta_2: R::ZERO,
            theta_m: position.clamp(R::ZERO, R::ONE) * theta_1,
        }
    }
}
