//! Forces and torque on a rigid wheel.

use grouser_real::{Real, Scalar};

use crate::contact::{Contact, ExponentTables, Integrals, OneByOne, Order};
use crate::lanes::EightNodes;
use crate::side_disc::SideDisc;

/// What the soil does to the wheel: the stresses integrated over the contact.
///
/// ```text
/// vertical_force = r b ∫(σ cos θ + τ sin θ) dθ
/// drawbar_pull   = r b ∫(τ cos θ − σ sin θ) dθ = thrust − compaction_resistance
/// torque         = r² b ∫ τ dθ
/// ```
///
/// Source: Wong & Reece \[WR67\]. Sign: vertical force upwards, drawbar pull forwards, torque as the motor
/// gives it (positive when it drives), side force to the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces<R = f64> {
    /// Vertical force, N.
    pub vertical_force: R,
    /// Drawbar pull, N.
    pub drawbar_pull: R,
    /// Torque, N m.
    pub torque: R,
    /// r b ∫ τ cos θ, N.
    pub thrust: R,
    /// r b ∫ σ sin θ, N.
    pub compaction_resistance: R,
    /// r b ∫ |τ_y|, N: the side force's part from shear, as a magnitude.
    pub side_shear: R,
    /// r² b ∫ [τ (p − p q cos θ) + σ p q sin θ + |τ_y| p |q_y|] with p = 1/max(1, q), N m: the work lost
    /// in the soil per radian of rotation (per radius of travel for a braked wheel). Never negative.
    pub lost_work: R,
    /// How much the balance `torque p − drawbar_pull p q r + side_shear p |q_y| r = lost_work` is off,
    /// N m: rounding.
    pub energy_residual: R,
}

impl<R: Scalar> Contact<R> {
    /// Forces by the standard rule, without a prepared Gauss-Jacobi rule: every derivative is exact, the
    /// exponent's included.
    ///
    /// This is the door for dual numbers and other kinds of number; [`WheelOnSoil`](crate::WheelOnSoil)
    /// is the one for plain use.
    pub fn forces(&self) -> Forces<R> {
        self.assemble(&self.integrals(None, Order::Standard, &OneByOne))
    }
}

impl Contact<f64> {
    /// Forces in plain numbers: eight nodes at a time, in reference mode one by one.
    #[inline]
    pub(crate) fn forces_by(&self, rules: Option<&ExponentTables>, order: Order) -> Forces {
        let quick = if order == Order::Simulation {
            self.quick(|plan| EightNodes::best().quick(plan))
        } else {
            None
        };
        match quick {
            Some(integrals) => self.assemble(&self.with_lost_work(integrals)),
            None => self.forces_by_panels(rules, order),
        }
    }

    #[inline(never)]
    fn forces_by_panels(&self, rules: Option<&ExponentTables>, order: Order) -> Forces {
        let lanes = EightNodes::best();
        if order == Order::Standard && self.shear.swings(self.arc()) {
            let halved =
                self.quick(|plan| plan.halved(|part| lanes.quick_part(&plan.contact, part)));
            if let Some(integrals) = halved.flatten() {
                return self.assemble(&self.with_lost_work(integrals));
            }
        }
        let integrals = if order <= Order::Check {
            self.integrals(rules, order, &lanes)
        } else {
            self.integrals(rules, order, &OneByOne)
        };
        self.assemble(&integrals)
    }
}

impl<R: Real> Contact<R> {
    #[inline]
    pub(crate) fn assemble(&self, i: &Integrals<R>) -> Forces<R> {
        let r = self.size.radius;
        let area = r * self.size.width;
        let thrust = area * i.tau_cos;
        let compaction_resistance = area * i.sigma_sin;
        let drawbar_pull = thrust - compaction_resistance;
        let torque = r * area * i.tau;
        let side_shear = area * i.tau_side;
        let lost_work = r * area * i.lost;
        let balance = torque * self.p - drawbar_pull * self.pq * r + side_shear * self.drift() * r;
        let rim = Forces {
            vertical_force: area * (i.sigma_cos + i.tau_sin),
            drawbar_pull,
            torque,
            thrust,
            compaction_resistance,
            side_shear,
            lost_work,
            energy_residual: balance - lost_work,
        };
        match self.disc {
            None => rim,
            Some(disc) => self.with_disc(rim, disc),
        }
    }

    /// What pressure and strength of the contact give together at most, N.
    pub(crate) fn most_force(&self, i: &Integrals<R>) -> R {
        let arc = self.angles.theta_1 - self.angles.theta_2;
        let pressure = i.sigma_cos.hypot(i.sigma_sin);
        let strength = self.cohesion * arc + self.tan_phi * pressure;
        self.size.radius * self.size.width * (pressure + strength)
    }

    /// The forces of the rim and of the soil beside the wheel together.
    fn with_disc(&self, rim: Forces<R>, disc: SideDisc<R>) -> Forces<R> {
        let r = self.size.radius;
        let balance = disc.torque * self.p - disc.pull * self.pq * r + disc.side * self.drift() * r;
        Forces {
            vertical_force: rim.vertical_force + disc.lift,
            drawbar_pull: rim.drawbar_pull + disc.pull,
            torque: rim.torque + disc.torque,
            thrust: rim.thrust + disc.pull,
            lost_work: rim.lost_work + disc.lost,
            energy_residual: rim.energy_residual + (balance - disc.lost),
            ..rim
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, ShearLaw, WheelSize, catalogue};

    /// Where the stress turns, the quick kernel's parts are halved for the standard accuracy, and panels for its check.
    #[test]
    fn which_way_a_stress_that_turns_is_integrated() {
        let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
        let motion = Motion {
            slip: -0.1,
            q_y: 0.02,
            slip_angle: 0.02,
        };
        let size = WheelSize::smooth(0.1, 0.05);
        let contact = Contact::new(&size, &soil.laws(), ShearLaw::Coupled, &motion, 0.5);
        assert!(contact.shear.swings(contact.arc()));
        let lanes = EightNodes::best();
        let halved = contact
            .quick(|plan| plan.halved(|part| lanes.quick_part(&plan.contact, part)))
            .flatten()
            .unwrap();
        let halved = contact.assemble(&contact.with_lost_work(halved));
        assert_eq!(contact.forces_by(soil.tables(), Order::Standard), halved);
        let panels = contact.assemble(&contact.integrals(soil.tables(), Order::Check, &lanes));
        assert_eq!(contact.forces_by(soil.tables(), Order::Check), panels);
        assert_ne!(halved, panels);
    }
}
