//! The integrals of the stresses over the contact.

use grouser_real::{Real, Scalar};

use super::ladder::{ExponentTables, Step};
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
    /// The coarsest rule that is good to 1e-9 of the forces.
    Standard,
    /// The next finer rule, to estimate the error of `Standard`.
    Check,
    /// To rounding.
    Reference,
    /// Finer still, to estimate the error of `Reference`.
    Beyond,
}

impl<R: Scalar> Contact<R> {
    /// Integrates with the rule that `order` and the stiffness of the shear ask for; `rules` are those
    /// of this contact's exponent, if it is a constant. Returns the number of nodes too.
    pub(crate) fn integrals(
        &self,
        rules: Option<&ExponentTables>,
        order: Order,
    ) -> (Integrals<R>, u32) {
        let smooth = match (rules, order) {
            (Some(rules), Order::Standard | Order::Check) => self.smooth_rules(rules, order),
            _ => None,
        };
        let mut sum = Integrals::zero();
        let nodes = match smooth {
            Some((friction, cohesion)) => {
                sum.add_smooth(self, friction, cohesion);
                2 * friction.nodes.len() + cohesion.nodes.len()
            }
            None => sum.add_split(self, order),
        };
        (sum, u32::try_from(nodes).unwrap_or(u32::MAX))
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
        let step = if self.shear.sideways {
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
    pub(super) fn arc(&self) -> R {
        self.angles.theta_1 - self.angles.theta_2
    }
}

impl<R: Real> Integrals<R> {
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
    pub(super) fn merge(&mut self, other: &Self) {
        self.sigma_cos += other.sigma_cos;
        self.sigma_sin += other.sigma_sin;
        self.tau_cos += other.tau_cos;
        self.tau_sin += other.tau_sin;
        self.tau += other.tau;
        self.tau_side += other.tau_side;
        self.lost += other.lost;
    }

    /// One node: σ and strength (both times their weight) at the arc `w` behind the entry.
    pub(super) fn add(&mut self, contact: &Contact<R>, w: R, sigma: R, strength: R) {
        let (sin, cos) = (contact.angles.theta_1 - w).sin_cos();
        let (along, across) = contact.shear.mobilised(w);
        let tau = contact.with_lugs(strength * along);
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

    /// Friction by a Gauss-Jacobi rule on each piece, cohesion by one Gauss-Legendre rule over all:
    /// σ = tⁿ × analytic is the only singularity, and the rule's weight holds it.
    pub(crate) fn add_smooth(
        &mut self,
        contact: &Contact<R>,
        friction: RuleView<'_>,
        cohesion: RuleView<'_>,
    ) {
        let ContactAngles {
            theta_1,
            theta_2,
            theta_m,
        } = contact.angles;
        let (front, rear) = (theta_1 - theta_m, theta_m - theta_2);
        for (t, weight) in friction.iter() {
            let t = R::from_f64(t);
            let u = t * front;
            let shape = contact.drop(u) / t;
            let positive = R::ZERO.lt(shape);
            let power = R::select(positive, shape, R::ONE).powf(contact.n);
            let sigma = R::select(
                positive,
                R::from_f64(weight) * contact.amplitude * power,
                R::ZERO,
            );
            self.add(contact, u, sigma * front, sigma * front * contact.tan_phi);
            let w = theta_1 - (theta_2 + t * rear);
            self.add(contact, w, sigma * rear, sigma * rear * contact.tan_phi);
        }
        let arc = theta_1 - theta_2;
        for (x, weight) in cohesion.iter() {
            let w = R::from_f64(x) * arc;
            self.add(
                contact,
                w,
                R::ZERO,
                R::from_f64(weight) * contact.cohesion * arc,
            );
        }
    }
}

impl<R: Real> Contact<R> {
    /// |q_y| p: the sideways speed in the energy balance's unit.
    pub(crate) fn drift(&self) -> R {
        let lock = if self.shear.locked { R::ONE } else { self.p };
        self.shear.q_y.abs() * lock
    }
}
