//! The soil: its parameters, checked once.

use grouser_real::{Real, Scalar};

use crate::angle::Angle;
use crate::bulldozing::Bulldozing;
use crate::contact::{
    ExponentTables, Motion, StressPosition, WheelSize, entry_angle, rear_share,
    sinkage_from_entry_angle,
};
use crate::error::{Error, Result};
use crate::fitted_range::FittedRange;
use crate::pressure::{Pressure, SinkageExponent, SlipSinkage, transport_depth_reece};
use crate::shear::{MohrCoulomb, ShearLaw};
use crate::side_disc::sideways_weight;
use crate::slip_velocity::{SlipNorm, SlipVelocity};

/// The sinkage exponents that the laws are used with.
pub(crate) const EXPONENT: (f64, f64) = (0.1, 3.0);
/// Legal moduli of Bekker's law, N/m^(n+1) and N/m^(n+2), and of Reece's, pure numbers.
pub(crate) const MODULUS: [(f64, f64); 2] = [(-1e12, 1e12), (-1e9, 1e9)];
/// Legal cohesion, Pa.
pub(crate) const COHESION: (f64, f64) = (0.0, 1e8);
/// Legal angle of friction, rad. 89°: beyond it tan φ is no soil any more, and degrees taken for radians end here.
pub(crate) const PHI: (f64, f64) = (0.0, 89_f64.to_radians());
/// Legal shear modulus, m.
pub(crate) const K_SHEAR: (f64, f64) = (1e-6, 10.0);
/// Legal c_1 and c_2.
pub(crate) const POSITION: (f64, f64) = (-2.0, 2.0);
/// Slip angle below which moving sideways takes nothing of the pressure, rad: sin²⁴β is 1.5e-17 there, and 1 − sin²⁴β rounds
/// to 1.
const MIN_SUPPORT_ANGLE_RAD: f64 = 0.2;

/// Everything a soil is to a wheel; each number is checked by [`Soil::new`].
///
/// Start from [`Soil::bekker`] and set what differs:
///
/// ```
/// use grouser_terra::{Angle, Soil, SoilParams};
/// let dry_sand = Soil::bekker(0.9e3, 1528.4e3, 1.1)
///     .cohesion(1000.0)
///     .phi(Angle::from_deg(30.0))
///     .k_shear(0.025)
///     .stress_position(0.18, 0.32);
/// let deeper = Soil::new(SoilParams { n_1: 0.3, ..dry_sand.params()? })?;
/// assert!(Soil::new(SoilParams { cohesion: f64::NAN, ..*deeper.params() }).is_err());
/// # Ok::<(), grouser_terra::Error>(())
/// ```
///
/// `N` and `A` are the numbers and the angle that every wheel needs; in an [`OpenSoil`](crate::OpenSoil) they may be open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoilParams<N = f64, A = Angle> {
    /// Pressure against sinkage.
    pub pressure: Pressure<N>,
    /// Sinkage exponent n without slip, in [0.1, 3].
    pub n: N,
    /// Growth of n with driving slip.
    pub n_1: f64,
    /// Growth of n with braking slip.
    pub n_2: f64,
    /// Cohesion c, Pa.
    pub cohesion: N,
    /// Angle of internal friction φ.
    pub phi: A,
    /// Shear deformation modulus K straight ahead, m.
    pub k_shear: N,
    /// Growth of K with the slip angle, K = K_0 + K_1 |β|, m/rad.
    pub k_shear_1: f64,
    /// K across the wheel, m, for laws that take the two directions apart; `None`: as along.
    pub k_shear_side: Option<f64>,
    /// Growth of K across with the slip angle, m/rad.
    pub k_shear_side_1: f64,
    /// Maximum stress at θ_m = (c_1 + c_2 s) θ_1.
    pub c_1: N,
    /// Maximum stress at θ_m = (c_1 + c_2 s) θ_1.
    pub c_2: N,
    /// Rebound ratio λ: the soil behind the wheel rises by λ z; 0 for dry sand.
    pub rebound: f64,
    /// Unit weight γ = ρ g, N/m³. Used by Reece's law and by bulldozing only.
    pub unit_weight: Option<f64>,
    /// Loss of the rear contact with driving slip, ε_1; 0 for none.
    pub rear_driving: f64,
    /// Loss of the rear contact with drift, ε_2; 0 for none.
    pub rear_drift: f64,
    /// Thickness δ of the layer that a driving wheel carries backwards, m; 0 for none.
    pub transport_layer: f64,
    /// Share of the rim's pressure that is left where the wheel moves sideways (slip angle 90°); 1 for all of it. The
    /// pressure is multiplied by 1 − (1 − this) sin²⁴β: a rim that does not roll onto the soil does not compact it.
    pub sideways_support: f64,
    /// The laws that these numbers were identified with.
    pub laws: LawChoice,
    /// The tests that these numbers were fitted on; `None` where that is not known.
    pub fitted: Option<FittedRange>,
}

/// The laws that go with a soil's numbers, where they are not the usual ones: a number identified with one
/// law means nothing to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LawChoice {
    /// By which speed a slip velocity is divided in n(s), θ_m and the rear contact.
    pub slip_norm: SlipNorm,
    /// Which slip the sinkage exponent grows with.
    pub slip_sinkage: SlipSinkage,
    /// Which slip moves the greatest stress.
    pub stress_position: StressPosition,
    /// How displacement makes shear stress; `None`: as the [`Settings`](crate::Settings) say.
    pub shear: Option<ShearLaw>,
    /// How ploughed soil enters the side force; `None`: as the [`Settings`](crate::Settings) say.
    pub bulldozing: Option<Bulldozing>,
}

impl SoilParams {
    /// These numbers as the laws take them, unchecked.
    pub(crate) fn laws<R: Real>(&self) -> SoilLaws<R> {
        let p = self;
        let r = R::from_f64;
        SoilLaws {
            pressure: p.pressure.lifted(),
            exponent: SinkageExponent {
                n_0: r(p.n),
                n_1: r(p.n_1),
                n_2: r(p.n_2),
            },
            strength: MohrCoulomb {
                cohesion: r(p.cohesion),
                phi: r(p.phi.rad()),
            },
            k_shear: r(p.k_shear),
            k_shear_1: r(p.k_shear_1),
            k_shear_side: r(p.k_shear_side.unwrap_or(p.k_shear)),
            k_shear_side_1: r(p.k_shear_side.map_or(p.k_shear_1, |_| p.k_shear_side_1)),
            c_1: r(p.c_1),
            c_2: r(p.c_2),
            rebound: r(p.rebound),
            unit_weight: r(p.unit_weight.unwrap_or(0.0)),
            rear_driving: r(p.rear_driving),
            rear_drift: r(p.rear_drift),
            transport_layer: r(p.transport_layer),
            sideways_support: r(p.sideways_support),
            choice: p.laws,
        }
    }
}

/// A soil whose every number has been checked, and what its sinkage exponent prepares for the integrals.
///
/// ```
/// use grouser_terra::{Angle, Soil};
///
/// let sand = Soil::bekker(990.0, 1.528e6, 1.1)
///     .cohesion(1040.0) // Pa
///     .phi(Angle::from_deg(28.0))
///     .k_shear(0.018) // m
///     .stress_position(0.4, 0.2);
/// assert!((sand.soil()?.params().phi.deg() - 28.0).abs() < 1e-12);
/// // An angle of friction in degrees is refused.
/// let error = sand.phi(Angle::from_rad(28.0)).soil().unwrap_err();
/// assert_eq!(error.field(), Some("phi"));
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Soil {
    params: SoilParams,
    /// `None` where the exponent depends on slip.
    tables: Option<ExponentTables>,
}

impl Soil {
    /// Checks each parameter.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::NotAbove`] with the field, its value, the limit and the unit;
    /// NaN is never in range. Reece's law without a unit weight is [`Error::Missing`].
    pub fn new(params: SoilParams) -> Result<Self> {
        let p = &params;
        let check = |name, value, (min, max): (f64, f64), unit| {
            Error::check_range(name, value, min, max, unit)
        };
        match p.pressure {
            Pressure::Bekker(law) => {
                check("k_c", law.k_c, MODULUS[0], "N/m^(n+1)")?;
                check("k_phi", law.k_phi, MODULUS[0], "N/m^(n+2)")?;
            }
            Pressure::Reece(law) => {
                check("k_c_prime", law.k_c_prime, MODULUS[1], "1")?;
                check("k_phi_prime", law.k_phi_prime, MODULUS[1], "1")?;
                if p.unit_weight.is_none() {
                    return Err(Error::Missing {
                        field: "unit_weight",
                        needed_by: "Reece's law",
                    });
                }
            }
        }
        check("n", p.n, EXPONENT, "1")?;
        Error::check_range("n_1", p.n_1, -EXPONENT.1, EXPONENT.1, "1")?;
        Error::check_range("n_2", p.n_2, -EXPONENT.1, EXPONENT.1, "1")?;
        check("cohesion", p.cohesion, COHESION, "Pa")?;
        check("phi", p.phi.rad(), PHI, "rad")?;
        check("k_shear", p.k_shear, K_SHEAR, "m")?;
        Error::check_range("k_shear_1", p.k_shear_1, 0.0, 10.0, "m/rad")?;
        if let Some(k_side) = p.k_shear_side {
            check("k_shear_side", k_side, K_SHEAR, "m")?;
        }
        Error::check_range("k_shear_side_1", p.k_shear_side_1, 0.0, 10.0, "m/rad")?;
        check("c_1", p.c_1, POSITION, "1")?;
        check("c_2", p.c_2, POSITION, "1")?;
        Error::check_range("rebound", p.rebound, 0.0, 100.0, "1")?;
        if let Some(gamma) = p.unit_weight {
            Error::check_range("unit_weight", gamma, 0.0, 1e6, "N/m^3")?;
        }
        Error::check_range("rear_driving", p.rear_driving, 0.0, 100.0, "1")?;
        Error::check_range("rear_drift", p.rear_drift, 0.0, 100.0, "1")?;
        Error::check_range("transport_layer", p.transport_layer, 0.0, 1.0, "m")?;
        Error::check_range("sideways_support", p.sideways_support, 0.0, 1.0, "1")?;
        if let Some(bulldozing) = p.laws.bulldozing {
            bulldozing.check(p)?;
        }
        if let Some(fitted) = &p.fitted {
            fitted.check()?;
        }
        let constant = p.n_1 == 0.0 && p.n_2 == 0.0;
        Ok(Self {
            params,
            tables: constant.then(|| ExponentTables::with_exponent(p.n)),
        })
    }

    /// The parameters.
    #[must_use]
    pub const fn params(&self) -> &SoilParams {
        &self.params
    }

    /// The same soil with another rebound ratio.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] outside [0, 100].
    pub fn with_rebound(self, rebound: f64) -> Result<Self> {
        Error::check_range("rebound", rebound, 0.0, 100.0, "1")?;
        Ok(Self {
            params: SoilParams {
                rebound,
                ..self.params
            },
            ..self
        })
    }

    /// What the exponent prepares; `None` where it depends on slip.
    pub(crate) const fn tables(&self) -> Option<&ExponentTables> {
        self.tables.as_ref()
    }

    /// The laws' parameters as numbers of any kind, for example dual numbers whose derivative is
    /// wanted: take them, replace one by a variable, and put them in a
    /// [`Contact`](crate::Contact).
    #[must_use]
    pub fn laws<R: Real>(&self) -> SoilLaws<R> {
        self.params.laws()
    }
}

/// A soil's parameters as the laws take them, in numbers of any kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoilLaws<R = f64> {
    /// Pressure against sinkage.
    pub pressure: Pressure<R>,
    /// The sinkage exponent against slip.
    pub exponent: SinkageExponent<R>,
    /// Shear strength.
    pub strength: MohrCoulomb<R>,
    /// K along, m.
    pub k_shear: R,
    /// Growth of K along with |β|, m/rad.
    pub k_shear_1: R,
    /// K across, m.
    pub k_shear_side: R,
    /// Growth of K across with |β|, m/rad.
    pub k_shear_side_1: R,
    /// θ_m = (c_1 + c_2 s) θ_1.
    pub c_1: R,
    /// θ_m = (c_1 + c_2 s) θ_1.
    pub c_2: R,
    /// Rebound ratio λ.
    pub rebound: R,
    /// Unit weight, N/m³; 0 where unknown.
    pub unit_weight: R,
    /// Loss of the rear contact with driving slip.
    pub rear_driving: R,
    /// Loss of the rear contact with drift.
    pub rear_drift: R,
    /// Thickness of the layer that a driving rim carries backwards, m.
    pub transport_layer: R,
    /// Share of the rim's pressure that is left where the wheel moves sideways.
    pub sideways_support: R,
    /// The laws that go with these numbers.
    pub choice: LawChoice,
}

impl<R: Scalar> SoilLaws<R> {
    /// The slip velocity in the norm that these numbers were identified with.
    fn slip_velocity(&self, motion: &Motion<R>) -> SlipVelocity<R> {
        motion.slip_velocity_by(self.choice.slip_norm)
    }

    /// The sinkage exponent in this motion.
    #[inline]
    pub fn exponent_at(&self, motion: &Motion<R>) -> R {
        match self.choice.slip_sinkage {
            SlipSinkage::InPlane => self.exponent.at(motion.slip),
            SlipSinkage::Whole => self.exponent.at_whole(&self.slip_velocity(motion)),
            SlipSinkage::Saturating => self.exponent.at_saturating(&self.slip_velocity(motion)),
            SlipSinkage::Ploughing => {
                let sideways = motion.sideways_ploughing(self.choice.slip_norm);
                self.exponent
                    .at_ploughing(&self.slip_velocity(motion), sideways)
            }
        }
    }

    /// θ_m/θ_1 in this motion, before it is held in [0, 1].
    #[inline]
    pub fn position_at(&self, motion: &Motion<R>) -> R {
        let slip = self
            .choice
            .stress_position
            .slip_of(motion, self.choice.slip_norm);
        self.c_1 + self.c_2 * slip
    }

    /// The rebound ratio in this motion: λ times the square of the share of the rear that is left.
    #[inline]
    pub fn rebound_at(&self, motion: &Motion<R>) -> R {
        if self.rebound.value() == 0.0 {
            return self.rebound;
        }
        let share = rear_share(
            &self.slip_velocity(motion),
            self.rear_driving,
            self.rear_drift,
        );
        self.rebound * share * share
    }

    /// What moving sideways leaves of the pressure: 1 − (1 − `sideways_support`) sin²⁴β.
    #[inline]
    pub(crate) fn support_at(&self, motion: &Motion<R>) -> R {
        if motion.slip_angle.value().abs() < MIN_SUPPORT_ANGLE_RAD {
            return R::ONE;
        }
        R::ONE - (R::ONE - self.sideways_support) * sideways_weight(motion)
    }

    /// The depth to which a driving wheel carries soil away, m ([`transport_depth_reece`]): its sinkage is this and the
    /// depth of its contact.
    #[inline]
    pub fn transport_depth(&self, motion: &Motion<R>, size: &WheelSize<R>) -> R {
        let layer = self.transport_layer + size.lug_layer;
        if layer.value() == 0.0 {
            return R::ZERO;
        }
        transport_depth_reece(layer, motion)
    }

    /// The sinkage of a contact that begins at `theta_1` (rad), m.
    #[inline]
    pub fn sinkage_at(&self, theta_1: R, motion: &Motion<R>, size: &WheelSize<R>) -> R {
        sinkage_from_entry_angle(theta_1, size.radius) + self.transport_depth(motion, size)
    }

    /// The entry angle of a sinkage (m), rad: 0 where the soil is carried away deeper than that.
    #[inline]
    pub fn entry_at(&self, sinkage: R, motion: &Motion<R>, size: &WheelSize<R>) -> R {
        let depth = sinkage - self.transport_depth(motion, size);
        if depth.value() > 0.0 {
            entry_angle(depth, size.radius)
        } else {
            R::ZERO
        }
    }
}

impl<R: Real> SoilLaws<R> {
    /// The modulus k of p = k zⁿ under a wheel of `width` (m) at the exponent `n`, Pa/mⁿ.
    #[inline]
    pub fn modulus(&self, width: R, n: R) -> R {
        match &self.pressure {
            Pressure::Bekker(law) => law.modulus(width),
            Pressure::Reece(law) => law.modulus(self.strength.cohesion, self.unit_weight, width, n),
        }
    }
}
