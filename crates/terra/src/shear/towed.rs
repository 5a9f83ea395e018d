//! Where the soil parts under a towed wheel: Wong and Reece's transition angle.

use grouser_real::Scalar;

/// The transition angle θ_0 of a towed wheel, rad: tan(45° − φ/2) = (cos θ_0 − 1/q)/sin θ_0.
///
/// In front of θ_0 the soil flows forwards with the wheel, behind it backwards; the shear displacement
/// starts anew there. With a = tan(45° − φ/2) and R = √(1 + a²): cos(θ_0 + atan a) = 1/(q R).
/// `None` where the equation has no positive root (s ≥ 0).
///
/// Source: Wong & Reece, J. Terramechanics 4 (1967) II \[WR67\]. Valid range: s < 0, rigid wheel.
/// Sign: from the vertical, positive towards travel.
///
/// ```
/// use grouser_terra::transition_angle_wong_reece;
/// let (phi, q) = (30_f64.to_radians(), 1.25); // skid of 20 %
/// let theta_0 = transition_angle_wong_reece(phi, q).expect("a skidding wheel has one");
/// let left = (std::f64::consts::FRAC_PI_4 - phi / 2.0).tan();
/// assert!((left - (theta_0.cos() - 1.0 / q) / theta_0.sin()).abs() < 1e-14);
/// ```
#[must_use]
pub fn transition_angle_wong_reece<R: Scalar>(phi: R, q: R) -> Option<R> {
    if !(q.value() > 1.0) {
        return None;
    }
    let half = R::from_f64(0.5);
    let a = (half * half * R::PI - half * phi).tan();
    Some((R::ONE / (q * R::ONE.hypot(a))).acos() - a.atan())
}
