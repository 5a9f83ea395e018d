//! The stresses under one wheel at one operating point: every law put together.

mod angles;
mod breakpoints;
mod crossing;
#[cfg(all(test, feature = "std"))]
mod effort_tests;
mod integrals;
mod jump;
pub(crate) mod ladder;
pub(crate) mod lean;
mod panels;
pub(crate) mod quick;
mod rear;
mod stress_position;

use grouser_real::{Real, Scalar};

pub use angles::{ContactAngles, entry_angle, sinkage_from_entry_angle};
pub(crate) use crossing::crossing;
pub(crate) use integrals::{Integrals, Nodes, OneByOne, Order};
pub(crate) use ladder::ExponentTables;
pub(crate) use panels::Panel;
pub(crate) use rear::rear_share;
pub use stress_position::StressPosition;

use crate::kinematics::Kinematics;
use crate::lugs::{lug_mobilisation, lug_transport_layer};
use crate::shear::{Displacement, Restart, ShearLaw, ShearState, transition_angle_wong_reece};
use crate::side_disc::SideDisc;
use crate::soil::SoilLaws;
use crate::wheel::{GrouserRule, RigidWheel};

/// A wheel's sizes as the laws take them, in numbers of any kind, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSize<R = f64> {
    /// Radius for slip, forces, torque and the contact angles.
    pub radius: R,
    /// Radius for the shear displacement.
    pub shear_radius: R,
    /// Radius of the bare rim.
    pub rim_radius: R,
    /// Share of the stress that acts at `radius`; the rest acts at `rim_radius`.
    pub tip_share: R,
    /// Width.
    pub width: R,
    /// Layer of soil that lugs carry backwards ([`lug_transport_layer`]); 0 without lugs.
    pub lug_layer: R,
    /// What lugs add to the shear displacement where the wheel drives ([`lug_mobilisation`]), per unit; 0 without lugs.
    pub lug_mobilisation: R,
}

impl<R: Real> WheelSize<R> {
    /// A smooth wheel, of which all radii are one.
    pub fn smooth(radius: R, width: R) -> Self {
        Self {
            radius,
            shear_radius: radius,
            rim_radius: radius,
            tip_share: R::ONE,
            width,
            lug_layer: R::ZERO,
            lug_mobilisation: R::ZERO,
        }
    }

    /// A wheel of this rim with lugs by [`GrouserRule::Lugs`](crate::GrouserRule): `height` and `thickness` in
    /// m, `count` around the rim.
    #[must_use]
    pub fn with_lugs(self, height: R, count: R, thickness: R) -> Self {
        Self {
            lug_layer: lug_transport_layer(height, count, thickness, self.radius),
            lug_mobilisation: lug_mobilisation(height, count, self.radius),
            ..self
        }
    }
}

impl<R: Scalar> WheelSize<R> {
    /// μ r_sⁿ + (1 − μ) rⁿ with the share μ of the lugs' tips.
    pub(crate) fn radius_power(&self, n: R) -> R {
        let tips = self.radius.powf(n);
        if self.tip_share.value() < 1.0 {
            self.tip_share * tips + (R::ONE - self.tip_share) * self.rim_radius.powf(n)
        } else {
            tips
        }
    }
}

/// What no motion of a wheel changes, computed once for many contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactConstants<R = f64> {
    pub(crate) tan_phi: R,
    /// [`WheelSize::radius_power`] where the exponent does not depend on slip.
    pub(crate) radius_power: Option<R>,
}

/// What a wheel's way, and wheels before it, have made of the soil.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dug<'a, R = f64> {
    /// The motion whose slip-sinkage, n(s) and the transported layer, holds.
    pub(crate) by: &'a Motion<R>,
    /// Factor of the shear deformation modulus K, 1.
    pub(crate) k_shear_factor: R,
}

impl RigidWheel {
    /// The sizes as numbers of any kind.
    #[must_use]
    pub fn size<R: Real>(&self) -> WheelSize<R> {
        let r = R::from_f64;
        let size = WheelSize {
            radius: r(self.running_radius()),
            shear_radius: r(self.shear_radius()),
            rim_radius: r(self.radius()),
            tip_share: r(self.tip_share()),
            ..WheelSize::smooth(r(self.running_radius()), r(self.width()))
        };
        self.grousers()
            .map_or(size, |grousers| match grousers.rule {
                GrouserRule::Tips | GrouserRule::AreaShare { .. } => size,
                GrouserRule::Lugs { count, thickness } => {
                    size.with_lugs(r(grousers.height), r(count), r(thickness))
                }
            })
    }
}

/// How the wheel moves, in numbers of any kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<R = f64> {
    /// Slip s.
    pub slip: R,
    /// q_y = v_y/(r ω); for a locked wheel v_y/v_x.
    pub q_y: R,
    /// |β|, rad.
    pub slip_angle: R,
}

impl Kinematics {
    /// The motion as numbers of any kind.
    #[must_use]
    #[inline]
    pub fn motion<R: Real>(&self) -> Motion<R> {
        Motion {
            slip: R::from_f64(self.slip().value()),
            q_y: R::from_f64(self.q_y()),
            slip_angle: R::from_f64(self.slip_angle().rad().abs()),
        }
    }
}

/// The stresses between a wheel and the soil at one operating point.
///
/// Normal stress by two pieces \[WR67\]: σ(θ) = k (r (cos θ_F − cos θ_1))ⁿ with θ_F = θ in front of θ_m and
/// θ_F = θ_1 − (θ − θ_2)/(θ_m − θ_2)·(θ_1 − θ_m) behind it; shear stress by a [`ShearLaw`].
///
/// Written in u, the arc from the entry in the front piece's measure, σ is the same function in both
/// pieces, A (cos(θ_1 − u) − cos θ_1)ⁿ, and nothing is divided by θ_1 − θ_m, which may be zero: then σ ≡ 0.
///
/// `R` is the kind of number: f64, f32, or a dual number for exact derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Contact<R = f64> {
    pub(crate) angles: ContactAngles<R>,
    /// A = k (μ r_sⁿ + (1 − μ) rⁿ), Pa.
    pub(crate) amplitude: R,
    pub(crate) n: R,
    pub(crate) cohesion: R,
    pub(crate) tan_phi: R,
    pub(crate) shear: ShearState<R>,
    pub(crate) size: WheelSize<R>,
    /// 1/max(1, q): what keeps the energy balance finite for a locked wheel.
    pub(crate) p: R,
    /// q/max(1, q).
    pub(crate) pq: R,
    /// What the soil beside a drifting wheel does, with [`Bulldozing::Disc`](crate::Bulldozing).
    pub(crate) disc: Option<SideDisc<R>>,
}

impl<R: Scalar> Contact<R> {
    /// The contact at the entry angle `theta_1` (rad), for sizes, soil and motion that have been checked
    /// ([`RigidWheel`], [`Soil`](crate::Soil), [`Kinematics`]).
    pub fn new(
        size: &WheelSize<R>,
        soil: &SoilLaws<R>,
        law: ShearLaw,
        motion: &Motion<R>,
        theta_1: R,
    ) -> Self {
        let constants = ContactConstants {
            tan_phi: soil.strength.phi.tan(),
            radius_power: None,
        };
        let dug = Dug {
            by: motion,
            k_shear_factor: R::ONE,
        };
        Self::digging(size, (soil, &constants), law, (motion, &dug), theta_1)
    }

    /// The contact of a wheel in `motion` on soil that has been `dug`.
    #[inline]
    pub(crate) fn digging(
        size: &WheelSize<R>,
        (soil, constants): (&SoilLaws<R>, &ContactConstants<R>),
        law: ShearLaw,
        (motion, dug): (&Motion<R>, &Dug<'_, R>),
        theta_1: R,
    ) -> Self {
        let Dug {
            by: dug_by,
            k_shear_factor,
        } = *dug;
        let slip = motion.slip;
        let driving = slip.value() >= 0.0;
        let locked = slip.value() <= -1.0;
        let skid = R::ONE + slip;
        let (q, one_minus_q, p, pq) = if driving {
            (R::ONE - slip, slip, R::ONE, R::ONE - slip)
        } else if locked {
            (R::ONE, R::ZERO, R::ZERO, R::ONE)
        } else {
            (R::ONE / skid, slip / skid, skid, R::ONE)
        };
        let n = soil.exponent_at(dug_by);
        let radius_power = constants
            .radius_power
            .unwrap_or_else(|| size.radius_power(n));
        let displacement = Displacement {
            theta_1,
            q,
            one_minus_q,
        };
        let sideways = motion.q_y.value() != 0.0;
        let (restarts, moves_maximum) = law.restart();
        let transition = (restarts && !sideways && !locked)
            .then(|| transition_angle_wong_reece(soil.strength.phi, q))
            .flatten();
        let restart = transition
            .map(|theta_0| theta_1 - theta_0)
            .filter(|arc| arc.value() > 0.0)
            .map(|arc| {
                let there = displacement.at(arc);
                Restart {
                    arc,
                    displacement: there,
                    // j = 0 at θ_0: arc·K_v q + j(arc) = 0
                    front: moves_maximum.then(|| -there / arc),
                }
            });
        let position = match transition {
            Some(theta_0) if moves_maximum => theta_0 / theta_1,
            _ => soil.position_at(motion),
        };
        let rebound = soil.rebound_at(motion);
        let angles = if rebound.value() > 0.0 {
            ContactAngles::new(theta_1, rebound, position)
        } else {
            ContactAngles::without_rebound(theta_1, position)
        };
        Self {
            angles,
            amplitude: soil.modulus(size.width, n) * radius_power * soil.support_at(motion),
            n,
            cohesion: soil.strength.cohesion,
            tan_phi: constants.tan_phi,
            shear: ShearState {
                law,
                displacement,
                radius: size.shear_radius,
                k_shear: k_shear_factor * (soil.k_shear + soil.k_shear_1 * motion.slip_angle),
                k_side: k_shear_factor
                    * (soil.k_shear_side + soil.k_shear_side_1 * motion.slip_angle),
                q_y: motion.q_y,
                locked,
                sideways,
                restart,
                lugs: size.lug_mobilisation,
            },
            size: *size,
            p,
            pq,
            disc: soil
                .choice
                .bulldozing
                .filter(|law| law.is_beside_hub())
                .and_then(|_| SideDisc::new(size, soil, motion, theta_1)),
        }
    }

    /// The contact angles, rad.
    pub fn angles(&self) -> ContactAngles<R> {
        self.angles
    }

    /// Normal stress σ at `theta` (rad), Pa; 0 outside the contact.
    pub fn normal_stress(&self, theta: R) -> R {
        let ContactAngles {
            theta_1,
            theta_2,
            theta_m,
        } = self.angles;
        if !(theta.value() >= theta_2.value() && theta.value() <= theta_1.value()) {
            return R::ZERO;
        }
        let length = theta_1 - theta_m;
        if theta.value() >= theta_m.value() {
            self.sigma(theta_1 - theta)
        } else {
            self.sigma((theta - theta_2) / (theta_m - theta_2) * length)
        }
    }

    /// Shear stress along and across the wheel at `theta` (rad), Pa; 0 outside the contact.
    ///
    /// Sign: positive along where the soil pushes the rim forwards; across, positive where the rim has
    /// moved to the left, so that the soil pushes it to the right.
    pub fn shear_stress(&self, theta: R) -> (R, R) {
        let ContactAngles {
            theta_1, theta_2, ..
        } = self.angles;
        if !(theta.value() >= theta_2.value() && theta.value() <= theta_1.value()) {
            return (R::ZERO, R::ZERO);
        }
        let strength = self.strength_at(theta);
        let (along, across) = self.shear.mobilised(theta_1 - theta);
        (strength * along, strength * across)
    }

    /// Shear strength c + σ tan φ at `theta` (rad), Pa: T(θ) of (P7).
    pub fn strength_at(&self, theta: R) -> R {
        self.cohesion + self.normal_stress(theta) * self.tan_phi
    }
}

impl Contact<f64> {
    /// The same contact in numbers of another kind, without derivatives: in every lane, say.
    #[inline(always)]
    pub(crate) fn spread<V: Real>(&self) -> Contact<V> {
        self.lifted(|of| V::from_f64(of(self)))
    }

    /// A contact of which `number` gives every number; how the wheel moves and the laws are this one's.
    #[inline(always)]
    pub(crate) fn lifted<V: Real>(&self, number: impl Fn(fn(&Self) -> f64) -> V) -> Contact<V> {
        let shear = &self.shear;
        Contact {
            angles: ContactAngles {
                theta_1: number(|of| of.angles.theta_1),
                theta_2: number(|of| of.angles.theta_2),
                theta_m: number(|of| of.angles.theta_m),
            },
            amplitude: number(|of| of.amplitude),
            n: number(|of| of.n),
            cohesion: number(|of| of.cohesion),
            tan_phi: number(|of| of.tan_phi),
            shear: ShearState {
                law: shear.law,
                displacement: Displacement {
                    theta_1: number(|of| of.shear.displacement.theta_1),
                    q: number(|of| of.shear.displacement.q),
                    one_minus_q: number(|of| of.shear.displacement.one_minus_q),
                },
                radius: number(|of| of.shear.radius),
                k_shear: number(|of| of.shear.k_shear),
                k_side: number(|of| of.shear.k_side),
                q_y: number(|of| of.shear.q_y),
                locked: shear.locked,
                sideways: shear.sideways,
                restart: shear.restart.map(|restart| Restart {
                    arc: number(|of| of.shear.restart.map_or(0.0, |restart| restart.arc)),
                    displacement: number(|of| {
                        of.shear.restart.map_or(0.0, |restart| restart.displacement)
                    }),
                    front: restart.front.map(|_| {
                        number(|of| {
                            let front = of.shear.restart.and_then(|restart| restart.front);
                            front.unwrap_or(0.0)
                        })
                    }),
                }),
                lugs: number(|of| of.shear.lugs),
            },
            size: WheelSize {
                radius: number(|of| of.size.radius),
                shear_radius: number(|of| of.size.shear_radius),
                rim_radius: number(|of| of.size.rim_radius),
                tip_share: number(|of| of.size.tip_share),
                width: number(|of| of.size.width),
                lug_layer: number(|of| of.size.lug_layer),
                lug_mobilisation: number(|of| of.size.lug_mobilisation),
            },
            p: number(|of| of.p),
            pq: number(|of| of.pq),
            // counts once, not at each node
            disc: None,
        }
    }
}

impl<R: Real> Contact<R> {
    /// cos(θ_1 − u) − cos θ_1 = 2 sin(θ_1 − u/2) sin(u/2), without cancellation.
    #[inline(always)]
    pub(crate) fn drop(&self, u: R) -> R {
        let half = R::from_f64(0.5) * u;
        R::from_f64(2.0) * (self.angles.theta_1 - half).sin() * half.sin()
    }

    /// σ at the front piece's arc `u` from the entry.
    #[inline(always)]
    pub(crate) fn sigma(&self, u: R) -> R {
        let drop = self.drop(u);
        let positive = R::ZERO.lt(drop);
        let base = R::select(positive, drop, R::ONE);
        R::select(positive, self.amplitude * base.powf(self.n), R::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pressure, Soil, SoilParams, catalogue};

    #[test]
    fn tips_and_rim_share_the_pressure() {
        let size = WheelSize {
            rim_radius: 0.1,
            tip_share: 0.3,
            ..WheelSize::smooth(0.12, 0.05)
        };
        let expected = 0.3 * 0.12_f64.powf(1.2) + 0.7 * 0.1_f64.powf(1.2);
        assert!((size.radius_power(1.2) - expected).abs() < 1e-15);
        let smooth = WheelSize::smooth(0.12_f64, 0.05);
        assert!((smooth.radius_power(1.2) - 0.12_f64.powf(1.2)).abs() < 1e-15);
    }

    /// The stresses as the formulas are printed, with rebound and drift.
    #[test]
    fn stresses_by_their_formulas() {
        let soil = Soil::new(SoilParams {
            rebound: 0.3,
            ..*catalogue::find("dry-sand")
                .unwrap()
                .soil()
                .unwrap()
                .params()
        })
        .unwrap();
        let (p, r, b) = (soil.params(), 0.1, 0.05);
        let (theta_1, slip, q_y) = (0.6_f64, 0.2, 0.3);
        let motion = Motion {
            slip,
            q_y,
            slip_angle: f64::atan(q_y / 0.8),
        };
        let size = WheelSize::smooth(r, b);
        let contact = Contact::new(&size, &soil.laws(), ShearLaw::Coupled, &motion, theta_1);
        let theta_2 = -2.0 * f64::asin(0.3_f64.sqrt() * f64::sin(0.3));
        let theta_m = (p.c_1 + p.c_2 * slip) * theta_1;
        let Pressure::Bekker(law) = p.pressure else {
            panic!("the catalogue has Bekker's numbers");
        };
        let modulus = law.k_c / b + law.k_phi;
        for i in 1..100 {
            let theta = theta_2 + (theta_1 - theta_2) * f64::from(i) / 100.0;
            let front = if theta >= theta_m {
                theta
            } else {
                theta_1 - (theta - theta_2) / (theta_m - theta_2) * (theta_1 - theta_m)
            };
            let sigma = modulus * (r * (front.cos() - theta_1.cos())).powf(p.n);
            assert!((contact.normal_stress(theta) - sigma).abs() < 1e-9 * sigma);
            let strength = p.cohesion + sigma * p.phi.tan();
            assert!((contact.strength_at(theta) - strength).abs() < 1e-9 * strength);
            let j = r * (theta_1 - theta - 0.8 * (theta_1.sin() - theta.sin()));
            let j_y = r * q_y * (theta_1 - theta);
            let tau = strength * (1.0 - f64::exp(-j.hypot(j_y) / p.k_shear));
            let (along, across) = contact.shear_stress(theta);
            assert!((along - tau * j / j.hypot(j_y)).abs() < 1e-9 * strength);
            assert!((across - tau * j_y / j.hypot(j_y)).abs() < 1e-9 * strength);
        }
        // outside the contact there is nothing, however far the angle goes round
        for i in 1..4000 {
            let beyond = 0.005 * f64::from(i);
            for theta in [theta_1 + beyond, theta_2 - beyond] {
                assert_eq!(contact.normal_stress(theta), 0.0);
                assert_eq!(contact.shear_stress(theta), (0.0, 0.0));
            }
        }
        assert!(contact.shear_stress(theta_2).0 > 100.0);
    }

    /// K across grows with the slip angle as K along does, and has the factor of the soil's history.
    #[test]
    fn the_shear_modulus_grows_with_the_slip_angle() {
        let soil = Soil::new(SoilParams {
            k_shear_1: 0.01,
            k_shear_side: Some(0.03),
            k_shear_side_1: 0.05,
            ..*catalogue::find("dry-sand")
                .unwrap()
                .soil()
                .unwrap()
                .params()
        })
        .unwrap();
        let motion = Motion {
            slip: 0.2,
            q_y: 0.3,
            slip_angle: 0.4,
        };
        let laws = soil.laws();
        let constants = ContactConstants {
            tan_phi: 0.5,
            radius_power: None,
        };
        let dug = Dug {
            by: &motion,
            k_shear_factor: 0.5,
        };
        let size = WheelSize::smooth(0.1, 0.05);
        let law = ShearLaw::Independent;
        let contact = Contact::digging(&size, (&laws, &constants), law, (&motion, &dug), 0.6);
        assert!((contact.shear.k_shear - 0.5 * (soil.params().k_shear + 0.004)).abs() < 1e-15);
        assert!((contact.shear.k_side - 0.5 * (0.03 + 0.02)).abs() < 1e-15);
    }

    /// Only the whole law of Wong and Reece puts the greatest stress at the transition angle.
    #[test]
    fn towed_laws_differ_in_where_the_stress_is_greatest() {
        let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
        let motion = Motion {
            slip: -0.2,
            q_y: 0.0,
            slip_angle: 0.0,
        };
        let of = |law| {
            let size = WheelSize::smooth(0.1, 0.05);
            Contact::new(&size, &soil.laws(), law, &motion, 0.6)
                .angles()
                .theta_m
        };
        let plain = (soil.params().c_1 - 0.2 * soil.params().c_2) * 0.6;
        assert!((of(ShearLaw::TowedRestart) - plain).abs() < 1e-15);
        let theta_0 = transition_angle_wong_reece(soil.params().phi.rad(), 1.25).unwrap();
        assert!((of(ShearLaw::TowedWongReece) - theta_0).abs() < 1e-15);
    }
}
