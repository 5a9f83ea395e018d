//! Soil ploughed aside by a wheel that drifts: Hegedus' bulldozing resistance.

use grouser_real::{Real, Scalar};

use crate::contact::{ContactAngles, Motion};
use crate::error::{Error, Result};
use crate::kernel::laws;
use crate::quadrature::LEGENDRE_16;
use crate::shear::MohrCoulomb;
use crate::side_disc::{MAX_FRICTION_RAD, sideways_weight};
use crate::soil::SoilParams;

/// How the bulldozing of a wheel's side enters the side force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bulldozing {
    /// Times κ = |sin β|: continuous as the drift vanishes. The default.
    #[default]
    Scaled,
    /// κ = 1 whenever the wheel drifts at all, as printed in \[Ishigami07\].
    Full,
    /// Times κ = |sin β|, over the whole chord w = 2 r sin θ_1 of the wheel's side below the ground, with the
    /// wedges that yield beyond its ends: ∫ D_1 [c h (1 + d/w) + D_2 γ h²/2 (1 + 2 d/3w)] dx with d = h cot X_c
    /// and x = r sin θ from −w/2 to w/2.
    ///
    /// The soil beside the rear half of a drifting wheel is as fresh as that beside its front half, whether
    /// the rim still presses on the rut there or not; and a wheel's side is a narrow blade. Source: ours, of
    /// Hegedus' resistance per width of blade \[Ishigami07\] (there counted over the arc [θ_2, θ_1] with the
    /// weight r − h cos θ) and the end wedges of McKyes & Ali, J. Terramechanics 14 (1977), for a vertical blade,
    /// strip by strip (from memory of later texts: unverified).
    Chord,
    /// As `Chord` up to slip angles of about 50°; beyond, passive pressure with friction on the leading side in its
    /// place, by the weight sin²⁴β (0.03 at 60°, 0.43 at 75°), also where the hub is buried, to a sinkage of 1.5 r beyond 60°.
    ///
    /// Soil that rises past the side lifts the wheel, and a rim that turns drags the soil along: friction then acts
    /// forwards, lifts less, and Coulomb's coefficient of the pressure falls with its share that lifts
    /// ([`passive_pressure_coulomb`](crate::passive_pressure_coulomb)). Lift, pull and torque enter the wheel's balance.
    /// Needs a unit weight, and φ up to 45°. Source: ours, of Coulomb's earth pressure. Tried on one wheel at 60 and 90°;
    /// axle and motor beside the wheel are not in it.
    Disc,
    /// Left out.
    Off,
}

impl Bulldozing {
    /// Does it act beside the hub too, where that is buried?
    pub(crate) const fn is_beside_hub(self) -> bool {
        match self {
            Self::Disc => true,
            Self::Scaled | Self::Full | Self::Chord | Self::Off => false,
        }
    }

    /// Can this law be used with these numbers of a soil?
    pub(crate) fn check(self, soil: &SoilParams) -> Result<()> {
        if !self.is_beside_hub() {
            return Ok(());
        }
        if soil.unit_weight.is_none() {
            return Err(Error::Missing {
                field: "unit_weight",
                needed_by: "bulldozing \"disc\"",
            });
        }
        Error::check_range("phi", soil.phi.rad(), 0.0, MAX_FRICTION_RAD, "rad")
    }

    /// κ, the weight of the ploughing in the side force.
    pub(crate) fn kappa<R: Real>(self, motion: &Motion<R>) -> R {
        match self {
            Self::Scaled | Self::Chord => motion.slip_angle.sin(),
            Self::Disc => motion.slip_angle.sin() * (R::ONE - sideways_weight(motion)),
            Self::Full => R::ONE,
            Self::Off => R::ZERO,
        }
    }

    /// The resistance before κ, N. `radius` in m, `gamma` in N/m³.
    pub(crate) fn resistance<R: Scalar>(
        self,
        strength: &MohrCoulomb<R>,
        gamma: R,
        radius: R,
        angles: &ContactAngles<R>,
    ) -> R {
        match self {
            Self::Scaled | Self::Full => side_resistance(strength, gamma, radius, angles),
            Self::Chord => chord_resistance(strength, gamma, radius, angles.theta_1),
            Self::Disc => {
                let to_hub = angles.theta_1.min(R::from_f64(0.5) * R::PI);
                chord_resistance(strength, gamma, radius, to_hub)
            }
            Self::Off => R::ZERO,
        }
    }
}

// without effect straight ahead
laws!(Bulldozing {
    Scaled: "scaled" => [General, Quick, Lanes, Tape, Remainder],
    Full: "full" => [General, Quick, Lanes, Tape, Remainder],
    Chord: "chord" => [General, Quick, Lanes, Tape, Remainder],
    Disc: "disc" => [General, Quick, Lanes, Tape, Remainder],
    Off: "off" => [General, Quick, Lanes, Tape, Remainder],
});

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
fn side_resistance<R: Scalar>(
    strength: &MohrCoulomb<R>,
    gamma: R,
    radius: R,
    angles: &ContactAngles<R>,
) -> R {
    // Behind −θ_1 (a rebound beyond the free surface) there is no soil above the contact.
    let from = angles.theta_2.max(-angles.theta_1);
    let arc = angles.theta_1 - from;
    let cos_1 = angles.theta_1.cos();
    let mut sum = R::ZERO;
    for (x, weight) in LEGENDRE_16.view().iter() {
        let cos = (from + R::from_f64(x) * arc).cos();
        let h = (radius * (cos - cos_1)).max(R::ZERO);
        sum +=
            R::from_f64(weight) * arc * bulldozing_hegedus(strength, gamma, h) * (radius - h * cos);
    }
    sum
}

/// ∫ D_1 [c h (1 + d/w) + D_2 γ h²/2 (1 + 2 d/3w)] dx over the chord w of a wheel's side below the ground in N,
/// with h = r (cos θ − cos θ_1), d = h cot X_c and x = r sin θ.
fn chord_resistance<R: Scalar>(strength: &MohrCoulomb<R>, gamma: R, radius: R, theta_1: R) -> R {
    let (sin_1, cos_1) = theta_1.sin_cos();
    if !(sin_1.value() > 0.0) {
        return R::ZERO;
    }
    let none = R::ZERO;
    let x_c = R::from_f64(0.5) * (R::from_f64(0.5) * R::PI - strength.phi);
    let ends_per_depth = R::ONE / (x_c.tan() * R::from_f64(2.0) * radius * sin_1); // d/(w h)
    let weightless = |h| bulldozing_hegedus(strength, none, h);
    let cohesionless = MohrCoulomb {
        cohesion: none,
        phi: strength.phi,
    };
    let mut half = R::ZERO;
    for (x, weight) in LEGENDRE_16.view().iter() {
        let cos = (R::from_f64(x) * theta_1).cos();
        let h = (radius * (cos - cos_1)).max(R::ZERO);
        let ends = ends_per_depth * h;
        let by_weight = bulldozing_hegedus(&cohesionless, gamma, h);
        let resistance =
            weightless(h) * (R::ONE + ends) + by_weight * (R::ONE + R::from_f64(2.0 / 3.0) * ends);
        half += R::from_f64(weight) * resistance * cos;
    }
    R::from_f64(2.0) * theta_1 * radius * half
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

    #[test]
    fn the_chord_by_its_closed_form() {
        // θ_1 = 90°: h = √(r² − x²) at each x, so ∫ h dx = π r²/2, ∫ h² dx = 4 r³/3, ∫ h³ dx = 3 π r⁴/8; w = 2 r
        let (radius, gamma) = (0.1_f64, 13e3);
        let strength = MohrCoulomb {
            cohesion: 500.0,
            phi: 0.5,
        };
        let at = |h: f64| bulldozing_hegedus(&strength, gamma, h);
        // R_b = a h + b h²
        let b = (at(2.0) - 2.0 * at(1.0)) / 2.0;
        let a = at(1.0) - b;
        let pi = core::f64::consts::PI;
        let (first, second) = (pi * radius * radius / 2.0, 4.0 * radius.powi(3) / 3.0);
        let third = 3.0 * pi * radius.powi(4) / 8.0;
        let ends = 1.0 / ((0.25 * pi - 0.25).tan() * 2.0 * radius); // cot X_c/w, φ = 0.5
        let exact = a * (first + ends * second) + b * (second + 2.0 / 3.0 * ends * third);
        let sum = chord_resistance(&strength, gamma, radius, core::f64::consts::FRAC_PI_2);
        assert!((sum - exact).abs() < 1e-12 * exact, "{sum} {exact}");
    }

    #[test]
    fn of_a_wheel_that_moves_sideways_the_disc_takes_over() {
        let strength = MohrCoulomb {
            cohesion: 500.0,
            phi: 0.5,
        };
        let at = |law: Bulldozing, theta_1: f64| {
            let angles = ContactAngles::new(theta_1, 0.2, 0.4);
            law.resistance(&strength, 13e3, 0.1, &angles)
        };
        let right = core::f64::consts::FRAC_PI_2;
        let chord = chord_resistance(&strength, 13e3, 0.1, 0.9);
        assert_eq!(
            (at(Bulldozing::Disc, 0.9), at(Bulldozing::Chord, 0.9)),
            (chord, chord)
        );
        // to the hub and no further
        let hub = chord_resistance(&strength, 13e3, 0.1, right);
        assert!((at(Bulldozing::Disc, 1.8) - hub).abs() < 1e-12 * hub);
        assert_eq!(chord_resistance(&strength, 13e3, 0.1, 0.0), 0.0);

        let kappa = |law: Bulldozing| {
            law.kappa(&Motion {
                slip: 0.0,
                q_y: 1.0,
                slip_angle: 1.2_f64,
            })
        };
        let sine = 1.2_f64.sin();
        assert_eq!(
            (kappa(Bulldozing::Off), kappa(Bulldozing::Full)),
            (0.0, 1.0)
        );
        assert_eq!(
            (kappa(Bulldozing::Scaled), kappa(Bulldozing::Chord)),
            (sine, sine)
        );
        let disc = sine * (1.0 - sine.powi(24));
        assert!((kappa(Bulldozing::Disc) - disc).abs() < 1e-15);
    }
}
