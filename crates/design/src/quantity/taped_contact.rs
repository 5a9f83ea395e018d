//! A wheel under a load as operations on a tape: the forces by a fixed rule over both pieces of the contact, with the
//! entry angle as a variable of its own that must carry the load.
//!
//! Laws: those of the kernel for a wheel that drives straight ahead (s ≥ 0), where every shear displacement is positive:
//! those that list [`Kernel::Tape`], with rebound and lugs.
//! The rule is Gauss-Legendre in v with t = v³, where t is the share of a piece's arc from its end without stress: the
//! stress grows like tⁿ there. Each integral carries a relative remainder, a variable in ±[`QUADRATURE_REMAINDER_SHARE`].

use grouser_opt::{Binary, Node, Unary};
use grouser_real::Real;
use grouser_terra::Kernel;

use super::rule_error::ContactShape;
use super::taped::Taped;
use super::{Parameter, Quantity};

/// Nodes of the rule on each piece.
const NODES: usize = 13;
/// What the rule may leave out of an integral, as a share of it. `Design::force_remainder` proves it over the box of a
/// problem; the test `taped_forces_are_those_of_the_kernel` compares it with the kernel over random wheels and soils.
pub(crate) const QUADRATURE_REMAINDER_SHARE: f64 = 1e-8;

/// What a contact adds to the variables of a problem: the entry angle, then one remainder per integral.
pub(crate) const CONTACT_VARIABLES: usize = 1 + INTEGRALS;
const INTEGRALS: usize = 4;
/// The place of ∫ σ sin θ among the integrals.
const COMPACTION: usize = 2;

/// The forces on a wheel as nodes.
#[derive(Clone, Copy)]
pub(crate) struct TapedContact {
    pub(super) theta_1: Node,
    theta_m: Node,
    slip: Node,
    pub(super) radius: Node,
    /// The depth to which soil is carried away.
    pub(super) carried_away: Option<Node>,
    pub(crate) load: Node,
    vertical_force: Node,
    thrust: Node,
    compaction_resistance: Node,
    torque: Node,
    /// What the error of the rule depends on; `None` with rebound.
    pub(crate) shape: Option<ContactShape<Node>>,
}

/// Nodes and weights of the Gauss-Legendre rule on [0, 1], by Newton's method on the polynomial.
fn legendre() -> Vec<(f64, f64)> {
    let n = NODES as f64;
    (0..NODES)
        .map(|i| {
            let mut x = Real::cos(std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5));
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut p, mut before) = (1.0, 0.0);
                for k in 0..NODES {
                    let k = k as f64;
                    (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
                }
                slope = n * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The rule in t: shares of a piece's arc from its end without stress, with their weights.
pub(crate) fn rule() -> Vec<(f64, f64)> {
    let in_t = |(v, weight): (f64, f64)| (v * v * v, weight * 3.0 * v * v);
    legendre().into_iter().map(in_t).collect()
}

impl Taped<'_> {
    pub(super) fn add(&mut self, a: Node, b: Node) -> Node {
        self.tape.binary(Binary::Add, a, b)
    }
    pub(super) fn sub(&mut self, a: Node, b: Node) -> Node {
        self.tape.binary(Binary::Sub, a, b)
    }
    pub(super) fn mul(&mut self, a: Node, b: Node) -> Node {
        self.tape.binary(Binary::Mul, a, b)
    }
    pub(super) fn div(&mut self, a: Node, b: Node) -> Node {
        self.tape.binary(Binary::Div, a, b)
    }
    pub(super) fn times(&mut self, factor: f64, a: Node) -> Node {
        let factor = self.tape.constant(factor);
        self.tape.binary(Binary::Mul, factor, a)
    }

    fn sin_cos(&mut self, x: Node) -> (Node, Node) {
        (
            self.tape.unary(Unary::Sin, x),
            self.tape.unary(Unary::Cos, x),
        )
    }

    /// sin of a share of θ_1.
    fn sine_of_share(&mut self, share: Node, theta_1: Node) -> Node {
        let angle = self.mul(share, theta_1);
        self.tape.unary(Unary::Sin, angle)
    }

    /// The depth of the front piece's rim by its arc u = `arc` θ_1 from the entry, over r:
    /// cos(θ_1 − u) − cos θ_1 = 2 sin(θ_1 − u/2) sin(u/2).
    fn drop(&mut self, theta_1: Node, arc: Node) -> Node {
        let one = self.tape.constant(1.0);
        let half = self.times(0.5, arc);
        let upper = self.sub(one, half);
        let upper = self.sine_of_share(upper, theta_1);
        let lower = self.sine_of_share(half, theta_1);
        let product = self.mul(upper, lower);
        self.times(2.0, product)
    }

    /// j/r at θ = `share` θ_1, the arc w = `arc` θ_1 behind the entry: w (1 − q cos((θ_1 + θ)/2) sinc(w/2)).
    fn displacement(&mut self, theta_1: Node, q: Node, share: Node, arc: Node) -> Node {
        let one = self.tape.constant(1.0);
        let w = self.mul(arc, theta_1);
        let half = self.times(0.5, w);
        let sinc = self.tape.unary(Unary::Sinc, half);
        let sum = self.add(one, share);
        let mean = self.times(0.5, sum);
        let middle = self.mul(mean, theta_1);
        let cosine = self.tape.unary(Unary::Cos, middle);
        let chord = self.mul(cosine, sinc);
        let moved = self.mul(q, chord);
        let slid = self.sub(one, moved);
        self.mul(w, slid)
    }

    /// The contact, whose entry angle and remainders are the variables from `first` on.
    pub(crate) fn contact(&mut self, first: usize) -> Option<TapedContact> {
        if self.fixed.law_unserved_by(Kernel::Tape).is_some() {
            return None;
        }
        let (slip, load) = (self.get(Parameter::Slip)?, self.carried()?);
        let (radius, width) = (self.radius()?, self.get(Parameter::Width)?);
        let (one, zero) = (self.tape.constant(1.0), self.tape.constant(0.0));
        let theta_1 = self.tape.variable(first);
        let q = self.sub(one, slip);
        let velocity = self.slip_velocity(slip, q);
        let n = self.exponent(slip, velocity)?;
        let position = self.position(slip, velocity)?;
        let exit = self.exit(theta_1, velocity);
        let theta_m = self.mul(position, theta_1);
        let rest = self.sub(one, position);
        let front = self.mul(rest, theta_1);
        let rear_share = exit.map_or(position, |exit| self.sub(position, exit));
        let rear = self.mul(rear_share, theta_1);
        let amplitude = self.amplitude(radius, n)?;
        let carried_away = self.carried_away(radius, (slip, q));
        let cohesion = self.cohesion()?;
        let tan_phi = self.tan_phi()?;
        let k_shear = self.get(Parameter::KShear)?;
        let sheared = self.shear_radius(radius)?;
        let mut stiffness = self.div(sheared, k_shear);
        // a driving wheel drags the soil backwards everywhere
        if let Some(sooner) = self.lug_mobilisation(radius) {
            stiffness = self.mul(stiffness, sooner);
        }
        let mut sums = [zero; INTEGRALS];
        // of an integral whose parts before and behind the axle have different signs
        let mut resisted = zero;
        // every angle is a share of θ_1 between 0 and 1, so that nothing changes its sign over a wide box
        for (t, weight) in rule() {
            let ahead_arc = self.times(t, rest);
            let ahead = self.sub(one, ahead_arc);
            let along = self.times(t, rear_share);
            let behind = exit.map_or(along, |exit| self.add(exit, along));
            let behind_arc = self.sub(one, behind);
            let drop = self.drop(theta_1, ahead_arc);
            let power = self.tape.binary(Binary::Power, drop, n);
            let sigma = self.mul(amplitude, power);
            let friction = self.mul(sigma, tan_phi);
            let strength = self.add(cohesion, friction);
            for (share, arc, length) in [(ahead, ahead_arc, front), (behind, behind_arc, rear)] {
                let theta = self.mul(share, theta_1);
                let (sin, cos) = self.sin_cos(theta);
                let displacement = self.displacement(theta_1, q, share, arc);
                let ratio = self.mul(stiffness, displacement);
                let falling = self.tape.unary(Unary::Neg, ratio);
                let lacking = self.tape.unary(Unary::ExpM1, falling);
                let mobilised = self.tape.unary(Unary::Neg, lacking);
                let tau = self.mul(strength, mobilised);
                let measure = self.times(weight, length);
                let parts = {
                    let (sigma_cos, tau_sin) = (self.mul(sigma, cos), self.mul(tau, sin));
                    let vertical = self.add(sigma_cos, tau_sin);
                    [vertical, self.mul(tau, cos), self.mul(sigma, sin), tau]
                };
                for (sum, part) in sums.iter_mut().zip(parts) {
                    let term = self.mul(measure, part);
                    *sum = self.add(*sum, term);
                }
                if exit.is_some() {
                    let size = self.tape.unary(Unary::Abs, sin);
                    let part = self.mul(sigma, size);
                    let term = self.mul(measure, part);
                    resisted = self.add(resisted, term);
                }
            }
        }
        let area = self.mul(radius, width);
        for (index, sum) in sums.iter_mut().enumerate() {
            let remainder = self.tape.variable(first + 1 + index);
            let size = (exit.is_some() && index == COMPACTION).then_some(resisted);
            *sum = self.with_remainder(area, *sum, size, remainder);
        }
        let torque = self.mul(radius, sums[3]);
        let has_bounded_rule =
            exit.is_none() && self.fixed.law_unserved_by(Kernel::Remainder).is_none();
        Some(TapedContact {
            theta_1,
            theta_m,
            slip,
            radius,
            carried_away,
            load,
            vertical_force: sums[0],
            thrust: sums[1],
            compaction_resistance: sums[COMPACTION],
            torque,
            shape: has_bounded_rule.then_some(ContactShape {
                theta_1,
                position,
                q,
                stiffness,
                n,
                amplitude,
                area,
            }),
        })
    }

    /// area · (sum + remainder · size); the size is the sum's own where none is given.
    fn with_remainder(
        &mut self,
        area: Node,
        sum: Node,
        size: Option<Node>,
        remainder: Node,
    ) -> Node {
        if let Some(size) = size {
            let lacking = self.mul(remainder, size);
            let sum = self.add(sum, lacking);
            self.mul(area, sum)
        } else {
            let one = self.tape.constant(1.0);
            let factor = self.add(one, remainder);
            let force = self.mul(area, sum);
            self.mul(force, factor)
        }
    }

    /// W cos α.
    fn carried(&mut self) -> Option<Node> {
        let weight = self.get(Parameter::Load)?;
        if self.fixed.get(Parameter::Slope) == Some(0.0) {
            return Some(weight);
        }
        let slope = self.radians(Parameter::Slope)?;
        let cosine = self.tape.unary(Unary::Cos, slope);
        Some(self.mul(weight, cosine))
    }

    /// (vertical force − load)/load, which must be 0.
    pub(crate) fn balance(&mut self, contact: &TapedContact) -> Node {
        let excess = self.sub(contact.vertical_force, contact.load);
        self.div(excess, contact.load)
    }

    /// A quantity of the forces on a loaded wheel; `None` for those that search over slip.
    pub(super) fn under_load(
        &mut self,
        contact: &TapedContact,
        quantity: Quantity,
    ) -> Option<Node> {
        let degrees = 180.0 / std::f64::consts::PI;
        let one = self.tape.constant(1.0);
        let q = self.sub(one, contact.slip);
        let pull = self.sub(contact.thrust, contact.compaction_resistance);
        Some(match quantity {
            Quantity::ThetaM => self.times(degrees, contact.theta_m),
            Quantity::VerticalForce => contact.load,
            Quantity::DrawbarPull => pull,
            Quantity::Torque => contact.torque,
            Quantity::Thrust => contact.thrust,
            Quantity::CompactionResistance => contact.compaction_resistance,
            Quantity::TractiveEfficiency => {
                let way = self.mul(q, contact.radius);
                let work = self.mul(pull, way);
                self.div(work, contact.torque)
            }
            Quantity::Energy => {
                let way = self.mul(q, contact.radius);
                self.div(contact.torque, way)
            }
            Quantity::PullCoefficient => self.div(pull, contact.load),
            Quantity::Gradeability => {
                let coefficient = self.div(pull, contact.load);
                let angle = self.tape.unary(Unary::Atan, coefficient);
                self.times(degrees, angle)
            }
            Quantity::Theta1
            | Quantity::Sinkage
            | Quantity::SlipDemand
            | Quantity::MaxPull
            | Quantity::MaxEfficiency
            | Quantity::MaxGradeability
            | Quantity::SigmaMax
            | Quantity::TauMax
            | Quantity::Strength
            | Quantity::S0
            | Quantity::SMobilised => return None,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]
mod tests {
    use grouser_opt::Tape;
    use grouser_real::Interval;
    use grouser_terra::{
        GrouserRule, Grousers, Kernel, Pressure, Reece, RigidWheel, ShearLaw, SlipNorm,
        SlipSinkage, Soil, StressPosition, catalogue,
    };

    use super::*;
    use crate::quantity::{Evaluation, Fixed, Inputs};
    use crate::scope::Scope;

    /// Numbers in [0, 1) from a seed (SplitMix64).
    struct Stream(u64);

    impl Stream {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small number that is not negative"
        )]
        fn below(&mut self, count: usize) -> usize {
            (self.within(0.0, 1.0) * count as f64) as usize
        }

        fn within(&mut self, low: f64, high: f64) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// Wheels and soils with every law that has bounds.
    fn random_contact(stream: &mut Stream, soil: &Soil) -> Fixed {
        let mut fixed = Fixed::default();
        let (radius, width) = (stream.within(0.05, 0.25), stream.within(0.03, 0.2));
        let wheel = RigidWheel::new(radius, width).unwrap();
        let height = stream.within(0.01, 0.1) * radius;
        let rule = match stream.below(4) {
            0 => None,
            1 => Some(GrouserRule::Tips),
            2 => Some(GrouserRule::AreaShare {
                tips: stream.within(0.0, 1.0),
            }),
            _ => Some(GrouserRule::Lugs {
                count: stream.within(4.0, 30.0),
                thickness: 0.0015,
            }),
        };
        fixed.set_wheel(&match rule {
            None => wheel,
            Some(rule) => wheel.with_grousers(Grousers { height, rule }).unwrap(),
        });
        let mut params = *soil.params();
        if stream.below(2) == 0 {
            params.rebound = stream.within(0.01, 0.5);
            params.rear_driving = stream.within(0.0, 1.5);
        }
        if stream.below(3) == 0 {
            params.transport_layer = stream.within(0.0, 0.004);
        }
        if stream.below(3) == 0 {
            params.n_1 = stream.within(0.0, 0.4);
            params.n_2 = 0.2;
        }
        if stream.below(3) == 0 {
            params.unit_weight = Some(16e3);
            params.pressure = Pressure::Reece(Reece {
                k_c_prime: stream.within(0.0, 20.0),
                k_phi_prime: stream.within(20.0, 500.0),
            });
        }
        let laws = &mut params.laws;
        laws.slip_norm = [SlipNorm::Greater, SlipNorm::Root][stream.below(2)];
        laws.slip_sinkage = SlipSinkage::ALL[stream.below(4)];
        laws.stress_position = StressPosition::ALL[stream.below(5)];
        let taped = |law: &ShearLaw| law.kernels().contains(&Kernel::Tape);
        let shear: Vec<_> = ShearLaw::ALL.into_iter().filter(taped).collect();
        laws.shear = Some(shear[stream.below(shear.len())]);
        fixed.set_soil(&Soil::new(params).unwrap());
        fixed.set(Parameter::Load, stream.within(5.0, 200.0));
        fixed.set(Parameter::Slip, stream.within(0.0, 0.9));
        fixed
    }

    /// The kernel's forces (accurate to 1e-9) and this rule's, at the kernel's entry angle. The compaction resistance counts
    /// beside the load: what resists before and behind the axle nearly cancels with much rebound.
    #[test]
    fn taped_forces_are_those_of_the_kernel() {
        let quantities = [
            Quantity::Sinkage,
            Quantity::Thrust,
            Quantity::CompactionResistance,
            Quantity::Torque,
            Quantity::ThetaM,
            Quantity::TauMax,
        ];
        let mut stream = Stream(2012);
        let mut worst = 0.0_f64;
        let mut compared = 0;
        for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
            let soil = catalogue::find(key).unwrap().soil().unwrap();
            for _ in 0..200 {
                let fixed = random_contact(&mut stream, &soil);
                let scope = Scope::new(Vec::new());
                let mut tape = Tape::new();
                let (numbers, balance) = scope.taped(&mut tape, &fixed, &quantities, Some(0));
                let inputs = Inputs::<f64>::new(&fixed);
                let mut kernel = Evaluation::new(&inputs);
                let Ok(degrees) = kernel.quantity(Quantity::Theta1) else {
                    continue;
                };
                let mut x = [Interval::ZERO; CONTACT_VARIABLES];
                x[0] = Interval::point(degrees.to_radians());
                let excess = tape.enclose(&x, balance.unwrap().balance);
                worst = worst.max(excess.magnitude());
                for quantity in quantities {
                    let node = numbers[scope.place(quantity)].unwrap();
                    let exact = kernel.quantity(quantity).unwrap();
                    let own = tape.enclose(&x, node).middle();
                    let size = match quantity {
                        Quantity::CompactionResistance => {
                            exact.abs().max(0.1 * fixed.get(Parameter::Load).unwrap())
                        }
                        _ => exact.abs(),
                    };
                    let off = (own - exact).abs() / size;
                    if off > 1e-8 {
                        println!("{quantity:?} {off:e} {own} {exact} {fixed:?}");
                    }
                    worst = worst.max(off);
                    compared += 1;
                }
            }
        }
        println!("{compared} values, the worst is off by {worst:e}");
        assert!(compared > 3000, "{compared}");
        assert!(worst < QUADRATURE_REMAINDER_SHARE, "{worst:e}");
    }
}
