//! Exact derivatives of a solved wheel: forces and sinkage under a load, in every input.

use grouser_real::Dual;

use crate::bulldozing::Bulldozing;
use crate::contact::{Contact, Motion, WheelSize};
use crate::error::{Error, Result};
use crate::forces::Forces;
use crate::kinematics::Kinematics;
use crate::shear::ShearLaw;
use crate::sinkage::Sinkage;
use crate::soil::SoilLaws;
use crate::wheel_on_soil::WheelOnSoil;

/// The inputs of a wheel as dual numbers: take them from a wheel on a soil, make variables of those whose
/// derivatives are wanted, and solve.
///
/// ```
/// use grouser_real::Dual;
/// use grouser_terra::{DualInputs, Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let wheel_on_soil = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
/// let motion = Kinematics::straight(Slip::new(0.2)?);
/// let mut inputs = DualInputs::<1>::new(&wheel_on_soil, &motion);
/// inputs.motion.slip = Dual::variable(0.2, 0);
/// let solved = inputs.under_load(&wheel_on_soil, &motion, Dual::constant(80.0))?.expect("80 N are carried");
/// let [by_slip] = solved.forces.drawbar_pull.gradient; // N per unit of slip
/// let at = |s: f64| -> grouser_terra::Result<f64> {
///     let solution = wheel_on_soil.under_load(80.0, &Kinematics::straight(Slip::new(s)?))?;
///     Ok(solution.point().expect("carried").forces.drawbar_pull)
/// };
/// let difference = (at(0.2 + 1e-5)? - at(0.2 - 1e-5)?) / 2e-5;
/// assert!((by_slip - difference).abs() < 1e-6 * by_slip);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct DualInputs<const N: usize> {
    /// The wheel's sizes, m.
    pub size: WheelSize<Dual<N>>,
    /// The soil's laws.
    pub soil: SoilLaws<Dual<N>>,
    /// The motion.
    pub motion: Motion<Dual<N>>,
    law: ShearLaw,
    bulldozing: Bulldozing,
    /// Is the unit weight known, without which nothing is ploughed?
    ploughs: bool,
    /// The sign of the side force.
    side: f64,
}

/// A wheel under its load, with the derivatives of everything in the chosen inputs.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct DualSolution<const N: usize> {
    /// Sinkage, m.
    pub sinkage: Dual<N>,
    /// Entry angle, rad.
    pub theta_1: Dual<N>,
    /// Forces and torque.
    pub forces: Forces<Dual<N>>,
    /// Side force with the bulldozing, N, positive to the left.
    pub side_force: Dual<N>,
}

impl<const N: usize> DualInputs<N> {
    /// All inputs of `wheel_on_soil` in this motion, as constants.
    #[must_use]
    pub fn new(wheel_on_soil: &WheelOnSoil, kinematics: &Kinematics) -> Self {
        Self {
            size: wheel_on_soil.wheel().size(),
            soil: wheel_on_soil.laws_in(),
            motion: kinematics.motion(),
            law: wheel_on_soil.settings().shear,
            bulldozing: wheel_on_soil.settings().bulldozing,
            ploughs: wheel_on_soil.soil().params().unit_weight.is_some(),
            side: if kinematics.slip_angle().rad() == 0.0 {
                0.0
            } else {
                -kinematics.slip_angle().rad().signum()
            },
        }
    }

    /// Forces at the entry angle `theta_1` (rad).
    #[must_use]
    pub fn forces(&self, theta_1: Dual<N>) -> Forces<Dual<N>> {
        Contact::new(&self.size, &self.soil, self.law, &self.motion, theta_1).forces()
    }

    /// Sinkage and forces under `load` (N). `wheel_on_soil` and `kinematics` hold the values of these inputs and
    /// find the sinkage; one Newton step in dual numbers then gives its exact derivatives,
    /// dθ_1 = (dW_load − ∂W)/(∂W/∂θ_1). `None` where nothing carries the load.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`]; [`Error::NotAbove`] for a load of 0, at which the entry angle has no
    /// derivative: it grows with a power of the load below 1.
    pub fn under_load(
        &self,
        wheel_on_soil: &WheelOnSoil,
        kinematics: &Kinematics,
        load: Dual<N>,
    ) -> Result<Option<DualSolution<N>>> {
        let found = wheel_on_soil.sinkage_under(load.value, kinematics)?;
        let Some(Sinkage { theta_1: angle, .. }) = found.outcome.solved() else {
            return Ok(None);
        };
        let slope = wheel_on_soil
            .contact(Dual::<1>::variable(angle, 0), kinematics)
            .forces()
            .vertical_force;
        let angle_per_load = 1.0 / slope.gradient[0];
        if !angle_per_load.is_finite() {
            return Err(Error::NotAbove {
                field: "load",
                value: load.value,
                limit: 0.0,
                unit: "N",
            });
        }
        let here = self.forces(Dual::constant(angle)).vertical_force;
        let theta_1 = Dual::constant(angle) + (load - here) * Dual::constant(angle_per_load);
        Ok(Some(self.at_entry_angle(theta_1)))
    }

    /// Everything at the entry angle `theta_1` (rad).
    #[must_use]
    pub fn at_entry_angle(&self, theta_1: Dual<N>) -> DualSolution<N> {
        let contact = Contact::new(&self.size, &self.soil, self.law, &self.motion, theta_1);
        let forces = contact.forces();
        let ploughed = self.bulldozing.resistance(
            &self.soil.strength,
            self.soil.unit_weight,
            self.size.radius,
            &contact.angles(),
        );
        let mut beside = Dual::constant(0.0);
        if self.ploughs {
            beside = self.bulldozing.kappa(&self.motion) * ploughed;
        }
        if let Some(disc) = contact.disc {
            beside += disc.side;
        }
        DualSolution {
            sinkage: self.soil.sinkage_at(theta_1, &self.motion, &self.size),
            theta_1,
            forces,
            side_force: Dual::constant(self.side) * (forces.side_shear + beside),
        }
    }
}
