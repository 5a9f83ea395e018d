//! The direction and size of the shear stress, along and across the wheel.

use grouser_real::Real;

use super::{Displacement, mobilised_janosi};
use crate::kernel::laws;

/// How displacement along and across the wheel makes shear stress along and across it.
///
/// Straight ahead the first three are one law, τ = sign(j) (c + σ tan φ)(1 − e^(−|j|/K)). For s < 0 that
/// sign(j) is an extension beyond the literature: between velocity reversal and j = 0 the soil gives
/// work back, so the shear work alone may be negative; the total never is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShearLaw {
    /// τ from |j| = hypot(j, j_y) and one K, along the displacement (j, j_y). The default.
    #[default]
    Coupled,
    /// τ from |j| = hypot(j, j_y) and one K, along the slip velocity of the rim, as the
    /// 3d-terramechanics code of Carnegie Mellon's Robomechanics Lab has it.
    SlipVelocity,
    /// τ_x from j with K and τ_y from j_y with K_side, each on its own. The sum may exceed the soil's
    /// strength by √2, which a caution reports. Source: Ishigami et al., J. Field Robotics 24 (2007)
    /// \[Ishigami07\].
    Independent,
    /// As `SlipVelocity`, with the direction (x, y)/√(x² + y² + ε²) of the slip velocity (x, y) over the rim's speed,
    /// ε = 0.02 max(1, q): no jump where the slip velocity passes zero, and finite braking and cornering stiffness
    /// (side force per radian of slip angle, pull per unit of slip) of the order of 1/ε of the strength. For control
    /// loops and derivatives; where |(x, y)| exceeds 0.1 it is `SlipVelocity` to 2 %.
    ///
    /// Source: ours. ε is a numerical width, not a property of a soil: on measured drifting wheels 0.05 changes the
    /// errors by less than 2 %, but raises that of the pull at slip angle 0 by 40 %.
    SlipVelocityRegular,
    /// A towed wheel whose displacement starts anew at the transition angle
    /// ([`transition_angle_wong_reece`](crate::transition_angle_wong_reece)), s < 0 and no slip angle;
    /// elsewhere as `Coupled`. Source: the transition angle of \[WR67\] II without the rest of that law
    /// (`TowedWongReece`).
    TowedRestart,
    /// Wong and Reece's towed wheel, s < 0 and no slip angle; elsewhere as `Coupled`. At the transition angle θ_0 the
    /// normal stress is greatest (θ_m = θ_0), and j = 0. In front of it
    /// j = r [(θ_1 − θ)(1 + K_v q) − q (sin θ_1 − sin θ)] with K_v such that j = 0 at θ_0 as at θ_1; behind it
    /// j = r [(θ_0 − θ) − q (sin θ_0 − sin θ)]. Where θ_0 lies before the entry there is no normal stress, with a
    /// caution. Source: \[WR67\] II.
    TowedWongReece,
}

/// ε of [`ShearLaw::SlipVelocityRegular`], of the greater of rim and forward speed.
const REGULAR_WIDTH: f64 = 0.02;

/// Where the displacement of a towed wheel starts anew.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Restart<R> {
    /// The arc behind the entry, rad.
    pub(crate) arc: R,
    /// j/r there by the formula of a wheel without restart.
    pub(crate) displacement: R,
    /// K_v q of the whole law: what the displacement in front of it grows by per rad; `None` without it.
    pub(crate) front: Option<R>,
}

impl ShearLaw {
    /// Does the displacement of a towed wheel restart within the contact, and is the normal stress maximum there?
    pub(crate) const fn restart(self) -> (bool, bool) {
        match self {
            Self::TowedWongReece => (true, true),
            Self::TowedRestart => (true, false),
            Self::Coupled | Self::SlipVelocity | Self::Independent | Self::SlipVelocityRegular => {
                (false, false)
            }
        }
    }

    /// Does the stress point along the slip velocity, not along the displacement?
    pub(crate) const fn is_by_slip_velocity(self) -> bool {
        match self {
            Self::SlipVelocity | Self::SlipVelocityRegular => true,
            Self::Coupled | Self::Independent | Self::TowedRestart | Self::TowedWongReece => false,
        }
    }

    /// Does the stress turn by degrees straight ahead, too?
    pub(crate) const fn is_regular(self) -> bool {
        match self {
            Self::SlipVelocityRegular => true,
            Self::Coupled
            | Self::SlipVelocity
            | Self::Independent
            | Self::TowedRestart
            | Self::TowedWongReece => false,
        }
    }

    /// Do the two directions have a displacement and a K each, so that their sum may exceed the strength?
    pub(crate) const fn is_independent(self) -> bool {
        match self {
            Self::Independent => true,
            Self::Coupled
            | Self::SlipVelocity
            | Self::SlipVelocityRegular
            | Self::TowedRestart
            | Self::TowedWongReece => false,
        }
    }
}

// driving straight ahead, every law but the regular one is the coupled law
laws!(ShearLaw {
    Coupled: "coupled" => [General, Quick, Lanes, Tape, Remainder],
    SlipVelocity: "slip-velocity" => [General, Quick, Lanes, Tape, Remainder],
    SlipVelocityRegular: "slip-velocity-regular" => [General, Quick],
    Independent: "independent" => [General, Lanes, Tape, Remainder],
    TowedRestart: "towed-restart" => [General, Lanes, Tape, Remainder],
    TowedWongReece: "towed-wong-reece" => [General, Lanes, Tape, Remainder],
});

/// Everything the shear at one angle depends on, apart from the strength there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearState<R> {
    pub(crate) law: ShearLaw,
    pub(crate) displacement: Displacement<R>,
    /// Radius whose rim shears the soil, m.
    pub(crate) radius: R,
    /// K along (and, but for `Independent`, across), m.
    pub(crate) k_shear: R,
    /// K across, m.
    pub(crate) k_side: R,
    /// q_y = v_y/(r ω); for a locked wheel the tangent of the slip angle.
    pub(crate) q_y: R,
    /// A locked wheel: displacement is infinite and the soil saturated.
    pub(crate) locked: bool,
    /// Does anything move sideways?
    pub(crate) sideways: bool,
    /// Where the displacement starts anew.
    pub(crate) restart: Option<Restart<R>>,
    /// What lugs add to displacement and slip speed along the wheel where its circumference drives, per unit
    /// ([`lug_mobilisation`](crate::lug_mobilisation)); 0 without lugs.
    pub(crate) lugs: R,
}

impl<R: Real> ShearState<R> {
    /// `x` along the wheel with what lugs add to it where it drives.
    #[inline(always)]
    pub(crate) fn with_lugs(&self, x: R) -> R {
        x + self.lugs * R::select(R::ZERO.lt(x), x, R::ZERO)
    }

    /// 1 − q cos θ along the wheel at the arc `w` behind the entry, with lugs.
    #[inline(always)]
    fn speed(&self, w: R) -> R {
        self.with_lugs(self.displacement.slope(w))
    }

    /// j at the arc `w` behind the entry with lugs, m (not for a locked wheel).
    #[inline(always)]
    pub(crate) fn along(&self, w: R) -> R {
        let j = self.displacement.at(w);
        let j = match self.restart {
            Some(restart) => {
                let before = match restart.front {
                    Some(front) => front * w,
                    None => R::ZERO,
                };
                j + R::select(restart.arc.lt(w), -restart.displacement, before)
            }
            None => j,
        };
        self.radius * self.with_lugs(j)
    }

    /// j_y at the arc `w` behind the entry, m.
    #[inline(always)]
    pub(crate) fn across(&self, w: R) -> R {
        self.radius * self.q_y * w
    }

    /// The signed shares of strength mobilised along and across at the arc `w` behind the entry.
    #[inline(always)]
    pub(crate) fn mobilised(&self, w: R) -> (R, R) {
        if self.locked {
            return self.mobilised_locked(w);
        }
        let along = self.along(w);
        if !self.sideways {
            let share = mobilised_janosi(along, self.k_shear);
            let sign = match self.law {
                ShearLaw::SlipVelocityRegular => {
                    return self.regular(share, self.speed(w), R::ZERO);
                }
                ShearLaw::SlipVelocity => self.speed(w),
                ShearLaw::Coupled
                | ShearLaw::Independent
                | ShearLaw::TowedRestart
                | ShearLaw::TowedWongReece => along,
            };
            return (with_sign(share, sign), R::ZERO);
        }
        let across = self.across(w);
        match self.law {
            ShearLaw::Independent => (
                with_sign(mobilised_janosi(along, self.k_shear), along),
                with_sign(mobilised_janosi(across, self.k_side), across),
            ),
            ShearLaw::SlipVelocity => {
                let share = mobilised_janosi(along.hypot(across), self.k_shear);
                directed(share, self.speed(w), self.q_y)
            }
            ShearLaw::SlipVelocityRegular => {
                let share = mobilised_janosi(along.hypot(across), self.k_shear);
                self.regular(share, self.speed(w), self.q_y)
            }
            ShearLaw::Coupled | ShearLaw::TowedRestart | ShearLaw::TowedWongReece => {
                let share = mobilised_janosi(along.hypot(across), self.k_shear);
                directed(share, along, across)
            }
        }
    }

    /// ε, where the law has one.
    #[inline(always)]
    pub(crate) fn width(&self) -> R {
        let q = self.displacement.q;
        let greater = R::select(q.lt(R::ONE), R::ONE, q);
        R::from_f64(REGULAR_WIDTH) * greater
    }

    /// `share` along (x, y)/√(x² + y² + ε²).
    #[inline(always)]
    fn regular(&self, share: R, x: R, y: R) -> (R, R) {
        let width = self.width();
        let scale = share / (x * x + y * y + width * width).sqrt();
        (scale * x, scale * y)
    }

    /// The limit q → ∞: everything mobilised, backwards, along (−(sin θ_1 − sin θ), tan β·w).
    #[inline(always)]
    fn mobilised_locked(&self, w: R) -> (R, R) {
        let theta = self.displacement.theta_1 - w;
        if !self.sideways {
            return match self.law {
                ShearLaw::SlipVelocityRegular => self.regular(R::ONE, -theta.cos(), R::ZERO),
                ShearLaw::Coupled
                | ShearLaw::SlipVelocity
                | ShearLaw::Independent
                | ShearLaw::TowedRestart
                | ShearLaw::TowedWongReece => (-R::ONE, R::ZERO),
            };
        }
        match self.law {
            ShearLaw::Independent => (-R::ONE, with_sign(R::ONE, self.q_y)),
            ShearLaw::SlipVelocity => directed(R::ONE, -theta.cos(), self.q_y),
            ShearLaw::SlipVelocityRegular => self.regular(R::ONE, -theta.cos(), self.q_y),
            ShearLaw::Coupled | ShearLaw::TowedRestart | ShearLaw::TowedWongReece => {
                let half = R::from_f64(0.5) * w;
                let chord =
                    R::from_f64(2.0) * (self.displacement.theta_1 - half).cos() * half.sin();
                directed(R::ONE, -chord, self.q_y * w)
            }
        }
    }
}

/// `share` with the sign of `of`.
#[inline(always)]
fn with_sign<R: Real>(share: R, of: R) -> R {
    R::select(of.lt(R::ZERO), -share, share)
}

/// `share` along the direction (x, y); nothing where there is no direction.
#[inline(always)]
fn directed<R: Real>(share: R, x: R, y: R) -> (R, R) {
    let length = x.hypot(y);
    let known = R::ZERO.lt(length);
    let scale = R::select(known, share / R::select(known, length, R::ONE), R::ZERO);
    (scale * x, scale * y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// θ_1 = 0.8 and K = 1.
    fn state(law: ShearLaw, q: f64, q_y: f64, locked: bool) -> ShearState<f64> {
        ShearState {
            law,
            displacement: Displacement {
                theta_1: 0.8,
                q,
                one_minus_q: 1.0 - q,
            },
            radius: 1.0,
            k_shear: 1.0,
            k_side: 1.0,
            q_y,
            locked,
            sideways: q_y != 0.0,
            restart: None,
            lugs: 0.0,
        }
    }

    fn check((x, y): (f64, f64), direction: (f64, f64), width: f64, share: f64) {
        let length = (direction.0 * direction.0 + direction.1 * direction.1 + width * width).sqrt();
        assert!(
            (x - share * direction.0 / length).abs() < 1e-14,
            "{x} {direction:?}"
        );
        assert!(
            (y - share * direction.1 / length).abs() < 1e-14,
            "{y} {direction:?}"
        );
    }

    /// All of the strength, along what the rim's displacement or its velocity tends to as its speed vanishes.
    #[test]
    fn a_locked_wheel_drags_the_soil_forwards() {
        let (w, cos) = (0.3, 0.5_f64.cos());
        for q_y in [0.0, 0.4, -0.4] {
            let at = |law| state(law, 1.0, q_y, true).mobilised(w);
            check(at(ShearLaw::SlipVelocity), (-cos, q_y), 0.0, 1.0);
            check(at(ShearLaw::SlipVelocityRegular), (-cos, q_y), 0.02, 1.0);
            let chord = 0.8_f64.sin() - 0.5_f64.sin();
            for law in [
                ShearLaw::Coupled,
                ShearLaw::TowedRestart,
                ShearLaw::TowedWongReece,
            ] {
                check(at(law), (-chord, q_y * w), 0.0, 1.0);
            }
            let side = if q_y == 0.0 { 0.0 } else { q_y.signum() };
            assert_eq!(at(ShearLaw::Independent), (-1.0, side));
        }
    }

    /// A width of 0.02 of the rim's speed, or of the greater forward speed.
    #[test]
    fn the_regular_law_has_a_width() {
        for (q, width) in [(0.7, 0.02), (2.5, 0.05)] {
            for q_y in [0.0, 0.3] {
                let state = state(ShearLaw::SlipVelocityRegular, q, q_y, false);
                let w = 0.3;
                let j = w - q * (0.8_f64.sin() - 0.5_f64.sin());
                let share = 1.0 - f64::exp(-j.hypot(q_y * w));
                check(
                    state.mobilised(w),
                    (1.0 - q * 0.5_f64.cos(), q_y),
                    width,
                    share,
                );
            }
        }
    }
}
