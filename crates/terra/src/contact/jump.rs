//! Where the shear stress jumps: derivatives of an integral whose integrand is not continuous.
//!
//! Straight ahead and braking, shear along the slip velocity changes its sign at once where the rim's speed along
//! the ground passes zero, at cos θ = 1/q. Panels end there, but at a place that carries no derivative.
//! With the jump Δ = f(before) − f(behind) at the arc w* and a panel's end at w_cut of the same value,
//! d∫f/dp lacks Δ·(dw*/dp − dw_cut/dp) (Leibniz); a term Δ·(w* − w_cut) adds just that and no value.

use grouser_real::Scalar;

use super::Contact;
use super::integrals::Integrals;
use crate::shear::{ShearLaw, mobilised_janosi};

impl<R: Scalar> Integrals<R> {
    /// Adds what the panels' ends lack.
    pub(super) fn add_jumps(&mut self, contact: &Contact<R>) {
        let shear = &contact.shear;
        let q = shear.displacement.q;
        match shear.law {
            ShearLaw::SlipVelocity => {}
            ShearLaw::Coupled
            | ShearLaw::Independent
            | ShearLaw::SlipVelocityRegular
            | ShearLaw::TowedRestart
            | ShearLaw::TowedWongReece => return,
        }
        if shear.sideways || shear.locked || !(q.value() > 1.0) {
            return;
        }
        let turn = (R::ONE / q).acos();
        // from driving forwards to backwards at +turn, and back at −turn
        for (theta, sign) in [(turn, 1.0), (-turn, -1.0)] {
            let w = contact.angles.theta_1 - theta;
            if !(w.value() > 0.0 && w.value() < contact.arc().value()) {
                continue;
            }
            let share = mobilised_janosi(shear.along(w), shear.k_shear);
            // from −τ to τ
            let jump = R::from_f64(2.0 * sign) * share * contact.strength_at(theta);
            let moved = jump * (w - cut(contact, w));
            let (sin, cos) = theta.sin_cos();
            self.tau += moved;
            self.tau_cos += moved * cos;
            self.tau_sin += moved * sin;
            // the work lost there is τ (p − p q cos θ), which is 0 at the jump
        }
    }
}

/// The end of a panel at the arc `w`, as the panels have it: a constant share of its piece.
fn cut<R: Scalar>(contact: &Contact<R>, w: R) -> R {
    let angles = &contact.angles;
    let front = angles.theta_1 - angles.theta_m;
    let rear = angles.theta_m - angles.theta_2;
    if w.value() < front.value() {
        R::from_f64(w.value() / front.value()) * front
    } else {
        let share = 1.0 - (w.value() - front.value()) / rear.value();
        angles.theta_1 - (angles.theta_2 + R::from_f64(share) * rear)
    }
}
