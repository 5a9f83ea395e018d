//! The quantities of a wheel on soil that a formula can use, by name.
// a new law or quantity has to be led to every `match`
#![cfg_attr(not(test), warn(clippy::wildcard_enum_match_arm))]

mod fixed;
mod inputs;
mod parameter;
mod point;
mod rule_error;
mod taped;
mod taped_contact;
mod taped_laws;

use grouser_real::Scalar;
use grouser_terra::{entry_angle, sinkage_from_entry_angle, slip_ani};

pub(crate) use fixed::Fixed;
pub(crate) use inputs::Inputs;
pub use parameter::{Parameter, Place};
pub(crate) use point::NoValue;
pub(crate) use rule_error::{ContactShape, RuleError, log_width};
pub(crate) use taped::Taped;
pub(crate) use taped_contact::{CONTACT_VARIABLES, QUADRATURE_REMAINDER_SHARE, rule};

use point::{Point, efficiency};

/// A quantity that is computed from the parameters.
///
/// ```
/// use grouser_design::Quantity;
///
/// assert!(Quantity::names().any(|name| name == "drawbar_pull_n"));
/// assert_eq!(Quantity::named("sinkage_m").map(Quantity::name), Some("sinkage_m"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Quantity {
    /// Entry angle θ_1, degrees.
    Theta1,
    /// Angle of the greatest stress θ_m, degrees.
    ThetaM,
    /// Sinkage under the load, m.
    Sinkage,
    /// Vertical force, N.
    VerticalForce,
    /// Drawbar pull, N.
    DrawbarPull,
    /// Torque, N m.
    Torque,
    /// Thrust, N.
    Thrust,
    /// Compaction resistance, N.
    CompactionResistance,
    /// Tractive efficiency η = DP q r/T.
    TractiveEfficiency,
    /// Energy per metre of travel T/(q r), J/m.
    Energy,
    /// DP/W.
    PullCoefficient,
    /// Slope that this pull holds under this load at this slip, atan(DP/W), degrees.
    Gradeability,
    /// The least slip that holds the slope of the state.
    SlipDemand,
    /// The greatest drawbar pull over slip, N.
    MaxPull,
    /// The greatest tractive efficiency over slip.
    MaxEfficiency,
    /// The steepest slope held at any slip, degrees.
    MaxGradeability,
    /// Pressure (k_c/b + k_phi) zⁿ at the sinkage, Pa: our reading of the paper's σ_max.
    SigmaMax,
    /// c + σ_max tan φ, Pa (P2).
    TauMax,
    /// T(θ) = c + σ(θ) tan φ, Pa (P7), σ by the front law inside the contact, 0 outside.
    Strength,
    /// S_0(θ, z/r) (P19).
    S0,
    /// S(θ, x), the slip that mobilises the share x at θ (P16).
    SMobilised,
}

impl Quantity {
    /// Every quantity with its name in formulas, and the parameters that it needs beyond its own.
    const ALL: [(Self, &'static str, Need); 21] = [
        (Self::Theta1, "theta_1_deg", Need::Geometry),
        (Self::ThetaM, "theta_m_deg", Need::Point),
        (Self::Sinkage, "sinkage_m", Need::Depth),
        (Self::VerticalForce, "vertical_force_n", Need::Point),
        (Self::DrawbarPull, "drawbar_pull_n", Need::Point),
        (Self::Torque, "torque_nm", Need::Point),
        (Self::Thrust, "thrust_n", Need::Point),
        (
            Self::CompactionResistance,
            "compaction_resistance_n",
            Need::Point,
        ),
        (Self::TractiveEfficiency, "tractive_efficiency", Need::Point),
        (Self::Energy, "energy_j_per_m", Need::Point),
        (Self::PullCoefficient, "pull_coefficient", Need::Point),
        (Self::Gradeability, "gradeability_deg", Need::Point),
        (Self::SlipDemand, "slip_demand", Need::Search),
        (Self::MaxPull, "max_drawbar_pull_n", Need::Search),
        (Self::MaxEfficiency, "max_tractive_efficiency", Need::Search),
        (Self::MaxGradeability, "max_gradeability_deg", Need::Search),
        (Self::SigmaMax, "sigma_max_pa", Need::Pressure),
        (Self::TauMax, "tau_max_pa", Need::Strength),
        (
            Self::Strength,
            "strength_at_theta_pa",
            Need::StrengthAtTheta,
        ),
        (Self::S0, "s_0", Need::SlipModel),
        (Self::SMobilised, "s_mobilised", Need::SlipModelShear),
    ];

    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    pub(crate) fn at(index: usize) -> Option<Self> {
        Self::ALL.get(index).map(|(quantity, ..)| *quantity)
    }

    /// The quantity of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .find(|(_, known, _)| *known == name)
            .map(|(quantity, ..)| *quantity)
    }

    /// Every name.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Self::ALL.iter().map(|(_, name, _)| *name)
    }

    /// Its name in formulas.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// What it cannot do without.
    pub(crate) fn needs(self) -> Vec<Parameter> {
        Self::ALL[self as usize].2.parameters()
    }

    /// Does it need a sinkage, given or solved for from a load?
    pub(crate) fn needs_sinkage_or_load(self) -> bool {
        Self::ALL[self as usize].2 != Need::Search
    }

    /// Does it follow from the forces at one slip?
    pub(crate) fn is_of_forces(self) -> bool {
        Self::ALL[self as usize].2 == Need::Point
    }
}

/// Groups of quantities by what they need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Need {
    Geometry,
    Pressure,
    Strength,
    StrengthAtTheta,
    SlipModel,
    SlipModelShear,
    Point,
    Depth,
    Search,
}

/// What forces at a slip, and the sinkage under a load, need; pressure and strength need the numbers from the width on.
pub(crate) const POINT: [Parameter; 11] = [
    Parameter::Radius,
    Parameter::Width,
    Parameter::Exponent,
    Parameter::KC,
    Parameter::KPhi,
    Parameter::Cohesion,
    Parameter::Phi,
    Parameter::KShear,
    Parameter::C1,
    Parameter::C2,
    Parameter::Slip,
];

impl Need {
    fn parameters(self) -> Vec<Parameter> {
        use Parameter as P;
        match self {
            Self::Geometry => POINT[..1].to_vec(),
            Self::Pressure => POINT[1..5].to_vec(),
            Self::Strength => POINT[1..7].to_vec(),
            Self::StrengthAtTheta => [&POINT[..7], &[P::Theta]].concat(),
            Self::SlipModel => vec![P::Radius, P::Theta],
            Self::SlipModelShear => vec![P::Radius, P::Theta, P::KShear],
            Self::Point => POINT.to_vec(),
            Self::Depth => Vec::new(),
            Self::Search => [&POINT[..10], &[P::Load]].concat(),
        }
    }
}

/// Quantities at one set of inputs; the stresses are integrated at most once.
pub(crate) struct Evaluation<'i, R> {
    inputs: &'i Inputs<R>,
    point: Option<Result<Point<R>, NoValue>>,
}

const DEG_PER_RAD: f64 = 180.0 / std::f64::consts::PI;

impl<'i, R: Scalar> Evaluation<'i, R> {
    pub(crate) fn new(inputs: &'i Inputs<R>) -> Self {
        Self {
            inputs,
            point: None,
        }
    }

    fn point(&mut self) -> Result<Point<R>, NoValue> {
        self.point
            .get_or_insert_with(|| self.inputs.point())
            .clone()
    }

    /// The sinkage: given, or under the load.
    fn sinkage(&mut self) -> Result<R, NoValue> {
        let depth = self.depth()?;
        if !self.inputs.has(Parameter::Load) {
            return Ok(depth);
        }
        let motion = Inputs::motion(self.point()?.slip);
        Ok(depth
            + self
                .inputs
                .laws()
                .transport_depth(&motion, &self.inputs.size()))
    }

    /// The depth of the contact: the given sinkage, or under the load the sinkage less what is carried away.
    fn depth(&mut self) -> Result<R, NoValue> {
        if self.inputs.has(Parameter::Load) {
            let point = self.point()?;
            Ok(sinkage_from_entry_angle(point.theta_1, point.radius))
        } else {
            Ok(self.inputs.get(Parameter::Sinkage))
        }
    }

    /// The entry angle, for a sinkage inside the wheel.
    fn entry(&mut self) -> Result<R, NoValue> {
        if self.inputs.has(Parameter::Load) {
            return Ok(self.point()?.theta_1);
        }
        let (z, r) = (self.inputs.get(Parameter::Sinkage), self.inputs.radius());
        if !(z.value() > 0.0) {
            return Err(NoValue::Undefined("the sinkage is not positive"));
        }
        if !(z.value() < r.value()) {
            return Err(NoValue::Law(grouser_terra::Error::HubBuried {
                sinkage: z.value(),
                radius: r.value(),
            }));
        }
        Ok(entry_angle(z, r))
    }

    fn pressure(&mut self, sinkage: R) -> R {
        let n = self.inputs.get(Parameter::Exponent);
        let width = self.inputs.get(Parameter::Width);
        self.inputs.laws().modulus(width, n) * sinkage.powf(n)
    }

    /// The quantity, or why it has no value here.
    pub(crate) fn quantity(&mut self, quantity: Quantity) -> Result<R, NoValue> {
        let forces = |point: Point<R>| point.forces;
        Ok(match quantity {
            Quantity::Theta1 => self.entry()? * R::from_f64(DEG_PER_RAD),
            Quantity::ThetaM => self.point()?.theta_m * R::from_f64(DEG_PER_RAD),
            Quantity::Sinkage => self.sinkage()?,
            Quantity::VerticalForce => self.point().map(forces)?.vertical_force,
            Quantity::DrawbarPull => self.point().map(forces)?.drawbar_pull,
            Quantity::Torque => self.point().map(forces)?.torque,
            Quantity::Thrust => self.point().map(forces)?.thrust,
            Quantity::CompactionResistance => self.point().map(forces)?.compaction_resistance,
            Quantity::TractiveEfficiency => efficiency(&self.point()?)?,
            Quantity::Energy => {
                let point = self.point()?;
                let q = point.speed_ratio();
                if !(q.value() > 0.0) {
                    return Err(NoValue::Undefined("the wheel spins on the spot"));
                }
                point.forces.torque / (q * point.radius)
            }
            Quantity::PullCoefficient => {
                let forces = self.point()?.forces;
                forces.drawbar_pull / forces.vertical_force
            }
            Quantity::Gradeability => {
                let forces = self.point()?.forces;
                (forces.drawbar_pull / forces.vertical_force).atan() * R::from_f64(DEG_PER_RAD)
            }
            Quantity::SlipDemand => self.inputs.slip_demand()?,
            Quantity::MaxPull => self.inputs.greatest_pull()?,
            Quantity::MaxEfficiency => self.inputs.greatest_efficiency()?,
            Quantity::MaxGradeability => self.inputs.greatest_slope()?,
            Quantity::SigmaMax => {
                let z = self.depth()?;
                self.pressure(z)
            }
            Quantity::TauMax => {
                let z = self.depth()?;
                let sigma = self.pressure(z);
                self.inputs.strength().strength(sigma)
            }
            Quantity::Strength => {
                let theta_1 = self.entry()?;
                let theta = self.inputs.radians(Parameter::Theta);
                // z − r (1 − cos θ), the depth of the rim below the surface at θ.
                let depth = self.inputs.radius() * (theta.cos() - theta_1.cos());
                let sigma = if theta.value().abs() <= theta_1.value() && depth.value() > 0.0 {
                    self.pressure(depth)
                } else {
                    R::ZERO
                };
                self.inputs.strength().strength(sigma)
            }
            Quantity::S0 => {
                let theta_1 = self.entry()?;
                slip_ani(self.inputs.radians(Parameter::Theta), theta_1)
            }
            Quantity::SMobilised => self.mobilised()?,
        })
    }

    /// S(θ, x) = S_0 − (K/r) ln(1 − x)/(sin θ_1 − sin θ).
    fn mobilised(&mut self) -> Result<R, NoValue> {
        let theta_1 = self.entry()?;
        let theta = self.inputs.radians(Parameter::Theta);
        let s_0 = slip_ani(theta, theta_1);
        let share = self.inputs.get(Parameter::Mobilised);
        if share.value() == 0.0 {
            return Ok(s_0);
        }
        if !(theta.value() < theta_1.value()) {
            return Err(NoValue::Undefined("theta_deg is not inside the contact"));
        }
        let k_over_r = self.inputs.get(Parameter::KShear) / self.inputs.radius();
        Ok(s_0 - k_over_r * (-share).ln_1p() / (theta_1.sin() - theta.sin()))
    }
}
