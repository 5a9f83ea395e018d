//! The integrals of the stresses over the contact.

use grouser_real::{Real, Scalar};

use super::ladder::{ExponentTables, Step};
use super::panels::Panel;
use super::{Contact, ContactAngles};
use crate::quadrature::RuleView;

/// Stress integrals over the contact, Pa·rad (per radius and width of the wheel).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integrals<R> {
    /// ∫ σ cos θ
    pub(crate) sigma_cos: R,
    /// ∫ σ sin θ
    pub(crate) sigma_sin: R,
    /// ∫ τ cos θ
    pub(crate) tau_cos: R,
    /// ∫ τ sin θ
    pub(crate) tau_sin: R,
    /// ∫ τ
    pub(crate) tau: R,
    /// ∫ |τ_y|
    pub(crate) tau_side: R,
    /// ∫ [τ (p − p q cos θ) + σ p q sin θ + |τ_y| p q_y], the work lost in the soil.
    pub(crate) lost: R,
}

/// How finely to integrate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Order {
    /// To 1e-6 of the forces by the quick kernel, else as `Standard`.
    Simulation,
    /// The coarsest rule that is good to 1e-9 of the forces.
    Standard,
    /// The next finer rule, to estimate the error of `Standard`.
    Check,
    /// To rounding.
    Reference,
    /// Finer still, to estimate the error of `Reference`.
    Beyond,
}

/// What evaluates the integrands of a contact at the nodes of rules: one node after the other, or eight at once.
pub(crate) trait Nodes<R> {
    /// Both pieces by a rule each that holds the power of the normal stress, and the cohesion by one rule over the arc.
    fn smooth(
        &self,
        contact: &Contact<R>,
        friction: RuleView<'_>,
        cohesion: RuleView<'_>,
    ) -> Integrals<R>;
    /// A part of a piece by a rule.
    fn panel(&self, contact: &Contact<R>, panel: Panel, rule: RuleView<'_>) -> Integrals<R>;
}

/// One node after the other, in any kind of number.
pub(crate) struct OneByOne;

impl<R: Scalar> Nodes<R> for OneByOne {
    fn smooth(
        &self,
        contact: &Contact<R>,
        friction: RuleView<'_>,
        cohesion: RuleView<'_>,
    ) -> Integrals<R> {
        let mut sum = Integrals::zero();
        for (t, weight) in friction.iter() {
            sum.add_friction(contact, R::from_f64(t), R::from_f64(weight));
        }
        for (x, weight) in cohesion.iter() {
            sum.add_cohesion(contact, R::from_f64(x), R::from_f64(weight));
        }
        sum
    }

    fn panel(&self, contact: &Contact<R>, panel: Panel, rule: RuleView<'_>) -> Integrals<R> {
        let mut sum = Integrals::zero();
        for (x, weight) in rule.iter() {
            let (t, weight) = panel.place(x, weight);
            sum.add_part(contact, panel.piece, R::from_f64(t), R::from_f64(weight));
        }
        sum
    }
}

impl<R: Scalar> Contact<R> {
    /// Integrates with the rule that `order` and the stiffness of the shear require; `rules` are those
    /// of this contact's exponent, if it is a constant.
    pub(crate) fn integrals(
        &self,
        rules: Option<&ExponentTables>,
        order: Order,
        nodes: &impl Nodes<R>,
    ) -> Integrals<R> {
        let smooth = match (rules, order) {
            (Some(rules), Order::Simulation | Order::Standard | Order::Check) => {
                self.smooth_rules(rules, order)
            }
            _ => None,
        };
        match smooth {
            Some((friction, cohesion)) => nodes.smooth(self, friction, cohesion),
            None => self.split(order, nodes),
        }
    }

    /// The (friction, cohesion) rules where the integrand is smooth over each piece.
    fn smooth_rules<'a>(
        &self,
        tables: &'a ExponentTables,
        order: Order,
    ) -> Option<(RuleView<'a>, RuleView<'static>)> {
        let arc = self.arc();
        if self.shear.restart.is_some() || !self.shear.is_one_signed(arc) || self.shear.swings(arc)
        {
            return None;
        }
        let stiffness = if self.shear.locked {
            0.0
        } else {
            self.shear.stiffness(arc)
        };
        let step = Step::for_stiffness(stiffness, self.angles.theta_1.value())?;
        // A stress whose direction turns along the contact is less smooth than its growth suggests.
        let step = if self.shear.sideways || self.shear.law.is_regular() {
            step.finer()?
        } else {
            step
        };
        let step = if order == Order::Check {
            step.finer()?
        } else {
            step
        };
        Some(tables.rules(step))
    }

    /// Length of the contact, rad.
    pub(crate) fn arc(&self) -> R {
        self.angles.theta_1 - self.angles.theta_2
    }
}

impl<R> Integrals<R> {
    /// Every integral by a function.
    #[inline(always)]
    pub(crate) fn map<S>(self, f: impl Fn(R) -> S) -> Integrals<S> {
        Integrals {
            sigma_cos: f(self.sigma_cos),
            sigma_sin: f(self.sigma_sin),
            tau_cos: f(self.tau_cos),
            tau_sin: f(self.tau_sin),
            tau: f(self.tau),
            tau_side: f(self.tau_side),
            lost: f(self.lost),
        }
    }
}

impl<R: Real> Integrals<R> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        let zero = R::ZERO;
        Self {
            sigma_cos: zero,
            sigma_sin: zero,
            tau_cos: zero,
            tau_sin: zero,
            tau: zero,
            tau_side: zero,
            lost: zero,
        }
    }

    /// Adds another part of the contact.
    #[inline(always)]
    pub(crate) fn merge(&mut self, other: &Self) {
        self.sigma_cos += other.sigma_cos;
        self.sigma_sin += other.sigma_sin;
        self.tau_cos += other.tau_cos;
        self.tau_sin += other.tau_sin;
        self.tau += other.tau;
        self.tau_side += other.tau_side;
        self.lost += other.lost;
    }

    /// One node: σ and strength (both times their weight) at the arc `w` behind the entry.
    #[inline(always)]
    pub(super) fn add(&mut self, contact: &Contact<R>, w: R, sigma: R, strength: R) {
        let (sin, cos) = (contact.angles.theta_1 - w).sin_cos();
        let (along, across) = contact.shear.mobilised(w);
        let tau = strength * along;
        self.sigma_cos += sigma * cos;
        self.sigma_sin += sigma * sin;
        self.tau_cos += tau * cos;
        self.tau_sin += tau * sin;
        self.tau += tau;
        self.lost += tau * (contact.p - contact.pq * cos) + sigma * contact.pq * sin;
        if contact.shear.sideways {
            let side = (strength * across).abs();
            self.tau_side += side;
            self.lost += side * contact.drift();
        }
    }

    /// Friction of both pieces at a node of a Gauss-Jacobi rule: σ = tⁿ × analytic is the only singularity, and the
    /// rule's weight holds it.
    #[inline(always)]
    pub(crate) fn add_friction(&mut self, contact: &Contact<R>, t: R, weight: R) {
        let ContactAngles {
            theta_1,
            theta_2,
            theta_m,
        } = contact.angles;
        let (front, rear) = (theta_1 - theta_m, theta_m - theta_2);
        let u = t * front;
        let shape = contact.drop(u) / t;
        let positive = R::ZERO.lt(shape);
        let power = R::select(positive, shape, R::ONE).powf(contact.n);
        let sigma = R::select(positive, weight * contact.amplitude * power, R::ZERO);
        self.add(contact, u, sigma * front, sigma * front * contact.tan_phi);
        let w = theta_1 - (theta_2 + t * rear);
        self.add(contact, w, sigma * rear, sigma * rear * contact.tan_phi);
    }

    /// A node of both pieces, at the same stress, of a rule that holds tⁿ itself.
    #[inline(always)]
    pub(crate) fn add_pieces(&mut self, contact: &Contact<R>, t: R, weight: R) {
        let ContactAngles {
            theta_1,
            theta_2,
            theta_m,
        } = contact.angles;
        let (front, rear) = (theta_1 - theta_m, theta_m - theta_2);
        let sigma = weight * contact.sigma(t * front);
        let strength = weight.mul_add(contact.cohesion, sigma * contact.tan_phi);
        self.add(contact, t * front, sigma * front, strength * front);
        let w = theta_1 - (theta_2 + t * rear);
        self.add(contact, w, sigma * rear, strength * rear);
    }

    /// Cohesion at a node of a rule over the whole arc.
    #[inline(always)]
    pub(crate) fn add_cohesion(&mut self, contact: &Contact<R>, x: R, weight: R) {
        let arc = contact.angles.theta_1 - contact.angles.theta_2;
        self.add(contact, x * arc, R::ZERO, weight * contact.cohesion * arc);
    }
}

impl<R: Real> Contact<R> {
    /// |q_y| p: the sideways speed in the energy balance's unit.
    #[inline(always)]
    pub(crate) fn drift(&self) -> R {
        let lock = if self.shear.locked { R::ONE } else { self.p };
        self.shear.q_y.abs() * lock
    }
}
