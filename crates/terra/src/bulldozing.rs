//! Soil ploughed aside by a wheel that drifts: Hegedus' bulldozing resistance.

use grouser_real::Real;

use crate::contact::ContactAngles;
use crate::quadrature::LEGENDRE_16;
use crate::shear::MohrCoulomb;

/// How the bulldozing of a wheel's side enters the side force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Bulldozing {
    /// Times κ = |sin β|: continuous as the drift vanishes. The default.
    #[default]
    Scaled,
    /// κ = 1 whenever the wheel drifts at all, as printed in \[Ishigami07\].
    Full,
    /// Left out.
    Off,
}

/// Bulldozing resistance per metre of blade by Hegedus: R_b(h) = D_1 (c h + D_2 γ h²/2) in N/m, with
/// D_1 = cot X_c + tan(X_c + φ), D_2 = cot X_c + cot² X_c tan φ and the destructive angle
/// X_c = π/4 − φ/2.
///
/// `h` is the depth of soil in front of the blade in m, `gamma` the unit weight in N/m³.
///
/// Source: Hegedus 1960, as given by Ishigami et al., J. Field Robotics 24 (2007) \[Ishigami07\].
/// Assumes: a vertical blade, no surcharge. Sign: a magnitude.
///
/// ```
/// use grouser_terra::{MohrCoulomb, bulldozing_hegedus};
/// let lunar = MohrCoulomb { cohesion: 800.0, phi: 37.2_f64.to_radians() };
/// assert_eq!(bulldozing_hegedus(&lunar, 15696.0, 0.0), 0.0);
/// assert!(bulldozing_hegedus(&lunar, 15696.0, 0.02) > 0.0);
/// ```
pub fn bulldozing_hegedus<R: Real>(strength: &MohrCoulomb<R>, gamma: R, h: R) -> R {
    let half = R::from_f64(0.5);
    let x_c = half * (half * R::PI - strength.phi);
    let cot = R::ONE / x_c.tan();
    let d_1 = cot + (x_c + strength.phi).tan();
    let d_2 = cot + cot * cot * strength.phi.tan();
    d_1 * (strength.cohesion * h + half * d_2 * gamma * h * h)
}

/// ∫ R_b(h) (r − h cos θ) dθ over the contact in N, h = r (cos θ − cos θ_1): the bulldozing part of the
/// side force before κ (\[Ishigami07\]). `radius` in m, `gamma` in N/m³.
pub(crate) fn side_resistance(
    strength: &MohrCoulomb<f64>,
    gamma: f64,
    radius: f64,
    angles: &ContactAngles<f64>,
) -> f64 {
    // Behind −θ_1 (a rebound beyond the free surface) there is no soil above the contact.
    let from = angles.theta_2.max(-angles.theta_1);
    let arc = angles.theta_1 - from;
    let (_, cos_1) = Real::sin_cos(angles.theta_1);
    LEGENDRE_16
        .view()
        .iter()
        .map(|(x, weight)| {
            let cos = Real::cos(from + x * arc);
            let h = (radius * (cos - cos_1)).max(0.0);
            weight * arc * bulldozing_hegedus(strength, gamma, h) * (radius - h * cos)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::entry_angle;

    #[test]
    fn the_pinned_integral() {
        // r .09, z .02, λ 0, φ 37.2°, c 800, γ 15696, by 30-digit quadrature
        let strength = MohrCoulomb {
            cohesion: 800.0,
            phi: 37.2_f64.to_radians(),
        };
        let angles = ContactAngles::new(entry_angle(0.02, 0.09), 0.0, 0.4);
        let integral = side_resistance(&strength, 15696.0, 0.09, &angles);
        assert!((integral - 3.854_406_756_4).abs() < 1e-9, "{integral}");
    }
}
