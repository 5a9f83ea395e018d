//! Quantities that are formulas of the parameters, as operations on a tape.
//!
//! Where a quantity has no value (a buried hub) the formula may have one: a bound over a box then counts points that
//! the solver would refuse, which makes it weaker but never wrong.

use grouser_opt::{Binary, Node, Tape, Unary};
use grouser_terra::Pressure;

use super::taped_contact::TapedContact;
use super::{Fixed, Parameter, Quantity};

/// A wheel's numbers as nodes of a tape.
pub(crate) struct Taped<'t> {
    pub(crate) tape: &'t mut Tape,
    pub(crate) fixed: &'t Fixed,
    /// One node per parameter, where there is one.
    pub(crate) parameters: [Option<Node>; Parameter::COUNT],
    /// The wheel under its load.
    pub(crate) contact: Option<TapedContact>,
}

impl Taped<'_> {
    pub(super) fn get(&self, parameter: Parameter) -> Option<Node> {
        self.parameters[parameter as usize]
    }

    fn number(&mut self, value: f64) -> Node {
        self.tape.constant(value)
    }

    fn two(&mut self, function: Binary, a: Node, b: Node) -> Node {
        self.tape.binary(function, a, b)
    }

    fn scaled(&mut self, parameter: Parameter, factor: f64) -> Option<Node> {
        let own = self.get(parameter)?;
        let factor = self.number(factor);
        Some(self.two(Binary::Mul, own, factor))
    }

    pub(super) fn radians(&mut self, parameter: Parameter) -> Option<Node> {
        self.scaled(parameter, std::f64::consts::PI / 180.0)
    }

    /// Height and number of the lugs that are counted; a number that varies is above 0.
    pub(super) fn lugs(&self) -> Option<(Node, Node)> {
        let has_lugs = self
            .fixed
            .get(Parameter::GrouserCount)
            .is_none_or(|count| count > 0.0);
        let lugs = (
            self.get(Parameter::GrouserHeight)?,
            self.get(Parameter::GrouserCount)?,
        );
        has_lugs.then_some(lugs)
    }

    /// The radius for slip and sinkage: r of a smooth wheel and of one with lugs that are counted, else r + h.
    pub(super) fn radius(&mut self) -> Option<Node> {
        let rim = self.get(Parameter::Radius)?;
        let height = self.get(Parameter::GrouserHeight)?;
        if self.lugs().is_some() || self.fixed.get(Parameter::GrouserHeight) == Some(0.0) {
            return Some(rim);
        }
        Some(self.two(Binary::Add, rim, height))
    }

    /// The sinkage, given or under the load.
    fn sinkage(&mut self) -> Option<Node> {
        let depth = self.contact_depth()?;
        match self.contact.and_then(|contact| contact.carried_away) {
            Some(carried_away) => Some(self.two(Binary::Add, depth, carried_away)),
            None => Some(depth),
        }
    }

    /// The depth of the contact: the given sinkage, or under the load the sinkage less what is carried away.
    fn contact_depth(&mut self) -> Option<Node> {
        match (self.contact, self.get(Parameter::Load)) {
            (Some(contact), _) => Some(self.depth_of(contact.theta_1, contact.radius)),
            (None, Some(_)) => None,
            (None, None) => self.get(Parameter::Sinkage),
        }
    }

    /// The entry angle under the load, else θ_1 = 2 asin √(z/2r).
    fn entry(&mut self) -> Option<Node> {
        if let Some(contact) = self.contact {
            return Some(contact.theta_1);
        }
        let (z, r) = (self.contact_depth()?, self.radius()?);
        let two = self.number(2.0);
        let twice = self.two(Binary::Mul, two, r);
        let ratio = self.two(Binary::Div, z, twice);
        let root = self.tape.unary(Unary::Sqrt, ratio);
        let half = self.tape.unary(Unary::Asin, root);
        Some(self.two(Binary::Mul, two, half))
    }

    /// The modulus k of p = k zⁿ: k_c/b + k_phi, or Reece's (c k_c′ + γ b k_phi′)/bⁿ.
    pub(super) fn modulus_at(&mut self, n: Node) -> Option<Node> {
        let width = self.get(Parameter::Width)?;
        match self.fixed.pressure() {
            Some(Pressure::Reece(law)) => {
                let cohesion = self.cohesion()?;
                let own = self.number(law.k_c_prime);
                let cohesive = self.two(Binary::Mul, cohesion, own);
                let weight = self.number(self.fixed.unit_weight()? * law.k_phi_prime);
                let frictional = self.two(Binary::Mul, width, weight);
                let sum = self.two(Binary::Add, cohesive, frictional);
                let reach = self.two(Binary::Power, width, n);
                return Some(self.two(Binary::Div, sum, reach));
            }
            Some(Pressure::Bekker(_)) | None => {}
        }
        let (k_c, k_phi) = (
            self.scaled(Parameter::KC, 1e3)?,
            self.scaled(Parameter::KPhi, 1e3)?,
        );
        let per_width = self.two(Binary::Div, k_c, width);
        Some(self.two(Binary::Add, per_width, k_phi))
    }

    /// k zⁿ.
    pub(super) fn pressure(&mut self, sinkage: Node) -> Option<Node> {
        let n = self.get(Parameter::Exponent)?;
        let modulus = self.modulus_at(n)?;
        let power = self.two(Binary::Power, sinkage, n);
        Some(self.two(Binary::Mul, modulus, power))
    }

    pub(super) fn cohesion(&mut self) -> Option<Node> {
        self.scaled(Parameter::Cohesion, 1e3)
    }

    pub(super) fn tan_phi(&mut self) -> Option<Node> {
        let phi = self.radians(Parameter::Phi)?;
        Some(self.tape.unary(Unary::Tan, phi))
    }

    /// c + σ tan φ.
    pub(super) fn strength(&mut self, sigma: Node) -> Option<Node> {
        let cohesion = self.cohesion()?;
        let tan = self.tan_phi()?;
        let friction = self.two(Binary::Mul, sigma, tan);
        Some(self.two(Binary::Add, cohesion, friction))
    }

    /// The depth of the rim below the surface at θ, z − r (1 − cos θ), 0 above it: 2 r sin²(θ/2) for r (1 − cos θ).
    fn depth(&mut self) -> Option<Node> {
        let (z, r) = (self.contact_depth()?, self.radius()?);
        let theta = self.radians(Parameter::Theta)?;
        let (half, two, zero) = (self.number(0.5), self.number(2.0), self.number(0.0));
        let angle = self.two(Binary::Mul, half, theta);
        let sine = self.tape.unary(Unary::Sin, angle);
        let square = self.tape.whole_power(sine, 2);
        let twice = self.two(Binary::Mul, two, r);
        let above = self.two(Binary::Mul, twice, square);
        let depth = self.two(Binary::Sub, z, above);
        Some(self.two(Binary::Max, depth, zero))
    }

    /// S_0(θ, z/r) = 1 − 1/(sinc((θ_1 − θ)/2) cos((θ_1 + θ)/2)).
    fn s_0(&mut self) -> Option<Node> {
        let theta_1 = self.entry()?;
        let theta = self.radians(Parameter::Theta)?;
        let (half, one) = (self.number(0.5), self.number(1.0));
        let difference = self.two(Binary::Sub, theta_1, theta);
        let difference = self.two(Binary::Mul, half, difference);
        let sum = self.two(Binary::Add, theta_1, theta);
        let sum = self.two(Binary::Mul, half, sum);
        let sinc = self.tape.unary(Unary::Sinc, difference);
        let cosine = self.tape.unary(Unary::Cos, sum);
        let product = self.two(Binary::Mul, sinc, cosine);
        let reciprocal = self.two(Binary::Div, one, product);
        Some(self.two(Binary::Sub, one, reciprocal))
    }

    /// The quantity's node; `None` where it is no formula of the parameters.
    pub(crate) fn quantity(&mut self, quantity: Quantity) -> Option<Node> {
        match quantity {
            Quantity::Theta1 => {
                let theta_1 = self.entry()?;
                let degrees = self.number(180.0 / std::f64::consts::PI);
                Some(self.two(Binary::Mul, theta_1, degrees))
            }
            Quantity::Sinkage => self.sinkage(),
            Quantity::SigmaMax => {
                let z = self.contact_depth()?;
                self.pressure(z)
            }
            Quantity::TauMax => {
                let z = self.contact_depth()?;
                let sigma = self.pressure(z)?;
                self.strength(sigma)
            }
            Quantity::Strength => {
                let depth = self.depth()?;
                let sigma = self.pressure(depth)?;
                self.strength(sigma)
            }
            Quantity::S0 => self.s_0(),
            Quantity::SMobilised if self.fixed.get(Parameter::Mobilised) == Some(0.0) => self.s_0(),
            Quantity::ThetaM
            | Quantity::VerticalForce
            | Quantity::DrawbarPull
            | Quantity::Torque
            | Quantity::Thrust
            | Quantity::CompactionResistance
            | Quantity::TractiveEfficiency
            | Quantity::Energy
            | Quantity::PullCoefficient
            | Quantity::Gradeability => {
                let contact = self.contact?;
                self.under_load(&contact, quantity)
            }
            // searches over slip, and a mobilised share above 0
            Quantity::SlipDemand
            | Quantity::MaxPull
            | Quantity::MaxEfficiency
            | Quantity::MaxGradeability
            | Quantity::SMobilised => None,
        }
    }
}
