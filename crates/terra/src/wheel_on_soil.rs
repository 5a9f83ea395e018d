//! A wheel on a soil.

use crate::caution::{Caution, Cautions, Judged};
use crate::contact::{
    Contact, ContactAngles, ContactConstants, Dug, ExponentTables, Motion, Order, WheelSize,
};
use crate::error::{Error, Result};
use crate::forces::Forces;
use crate::kinematics::Kinematics;
use crate::law_preset::{LawPreset, ModelError};
use crate::operating_point::OperatingPoint;
use crate::settings::{Accuracy, Settings};
use crate::soil::{EXPONENT, Soil, SoilLaws};
use crate::soil_history::SoilHistory;
use crate::wheel::RigidWheel;
use grouser_real::{Real, Scalar};

/// Least slip angle, rad, at which [`Bulldozing::Disc`](crate::Bulldozing) carries a wheel whose hub is buried: 60°, the least that it was
/// tried at. Below, its weight is less than 0.03.
const BURIED_FROM_RAD: f64 = core::f64::consts::FRAC_PI_3 - 1e-9;

/// Greatest sinkage over the radius there: measured wheels stand at 1.05 to 1.3.
const BURIED_PER_RADIUS: f64 = 1.5;

/// One wheel on one soil: the primary type of the crate.
///
/// ```
/// use grouser_terra::{Kinematics, RigidWheel, Settings, Slip, Soil, WheelOnSoil, catalogue};
/// let soil = catalogue::find("dry-sand").expect("it is in the catalogue").soil()?;
/// let wheel = RigidWheel::new(0.125, 0.1)?;
/// let contact = WheelOnSoil::new(wheel, soil, Settings::default())?;
/// let motion = Kinematics::straight(Slip::new(0.2)?);
/// let solution = contact.under_load(80.0, &motion)?;
/// let point = solution.point().expect("80 N are carried");
/// assert!((point.forces.vertical_force - 80.0).abs() < 1e-9);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct WheelOnSoil {
    wheel: RigidWheel,
    soil: Soil,
    settings: Settings,
    size: WheelSize<f64>,
    laws: SoilLaws<f64>,
    constants: ContactConstants,
    /// Does any law of the contact take the slip angle?
    takes_slip_angle: bool,
}

/// Does the soil carry a wheel of this width at all?
fn check_modulus(laws: &SoilLaws<f64>, wheel: &RigidWheel) -> Result<()> {
    let modulus = laws.modulus(wheel.width(), laws.exponent.n_0);
    Error::check_above("k_c/b + k_phi", modulus, 0.0, "Pa/m^n")
}

/// The power of the radius where the exponent does not depend on slip.
fn constant_radius_power(size: &WheelSize<f64>, laws: &SoilLaws<f64>) -> Option<f64> {
    let is_constant = laws.exponent.n_1 == 0.0 && laws.exponent.n_2 == 0.0;
    is_constant.then(|| size.radius_power(laws.exponent.n_0))
}

impl WheelOnSoil {
    /// Puts a wheel on a soil. A law that the soil's numbers were identified with
    /// ([`LawChoice`](crate::LawChoice)) goes before that of the settings.
    ///
    /// # Errors
    /// [`Error::NotAbove`] if the pressure-sinkage modulus under a wheel of this width is not positive; [`Error::OutOfRange`] for
    /// a greatest slip outside [0.01, 1].
    pub fn new(wheel: RigidWheel, soil: Soil, settings: Settings) -> Result<Self> {
        Error::check_range("max_slip", settings.max_slip, 0.01, 1.0, "1")?;
        let mut laws = soil.laws();
        check_modulus(&laws, &wheel)?;
        let choice = soil.params().laws;
        let settings = Settings {
            shear: choice.shear.unwrap_or(settings.shear),
            bulldozing: choice.bulldozing.unwrap_or(settings.bulldozing),
            ..settings
        };
        settings.bulldozing.check(soil.params())?;
        laws.choice.bulldozing = Some(settings.bulldozing);
        let size: WheelSize = wheel.size();
        let constants = ContactConstants {
            tan_phi: Real::tan(laws.strength.phi),
            radius_power: constant_radius_power(&size, &laws),
        };
        Ok(Self {
            wheel,
            soil,
            settings,
            size,
            constants,
            takes_slip_angle: laws.k_shear_1 != 0.0
                || laws.k_shear_side_1 != 0.0
                || laws.sideways_support != 1.0
                || settings.bulldozing.is_beside_hub(),
            laws,
        })
    }

    /// Puts another wheel on the same soil: to copy the soil with its tables takes as long as an evaluation.
    pub(crate) fn set_wheel(&mut self, wheel: RigidWheel) -> Result<()> {
        check_modulus(&self.laws, &wheel)?;
        self.wheel = wheel;
        self.size = wheel.size();
        self.constants.radius_power = constant_radius_power(&self.size, &self.laws);
        Ok(())
    }

    /// The same wheel on the same soil at another accuracy.
    #[must_use]
    pub fn with_accuracy(&self, accuracy: Accuracy) -> Self {
        let mut other = self.clone();
        other.settings.accuracy = accuracy;
        other
    }

    /// The wheel.
    #[must_use]
    pub const fn wheel(&self) -> &RigidWheel {
        &self.wheel
    }

    /// The soil.
    #[must_use]
    pub const fn soil(&self) -> &Soil {
        &self.soil
    }

    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Forces at a sinkage (m), and nothing else: the fast way.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a negative sinkage and for an exponent n(s) outside [0.1, 3];
    /// [`Error::HubBuried`] from z = r on (1.5 r with [`Bulldozing::Disc`](crate::Bulldozing) beyond a slip angle of
    /// 60°); [`Error::ReboundAboveHub`] from λ z = r on.
    pub fn forces_at(&self, sinkage: f64, kinematics: &Kinematics) -> Result<Forces> {
        let theta_1 = self.entry_angle(sinkage, kinematics)?;
        self.check_exponent(kinematics)?;
        let contact = self.contact(theta_1, kinematics);
        Ok(self.forces_of(&contact, kinematics))
    }

    /// The forces of a contact in the direction of rolling.
    #[inline]
    pub(crate) fn forces_of(&self, contact: &Contact<f64>, kinematics: &Kinematics) -> Forces {
        mirrored(contact.forces_by(self.tables(), self.order()), kinematics)
    }

    /// The whole operating point at a sinkage (m).
    ///
    /// # Errors
    /// As [`WheelOnSoil::forces_at`].
    pub fn at_sinkage(&self, sinkage: f64, kinematics: &Kinematics) -> Result<OperatingPoint> {
        let theta_1 = self.entry_angle(sinkage, kinematics)?;
        self.check_exponent(kinematics)?;
        let mut point = self.point(theta_1, kinematics);
        point.sinkage = sinkage;
        Ok(point)
    }

    /// The entry angle of a sinkage inside the model.
    #[inline]
    pub(crate) fn entry_angle(&self, sinkage: f64, kinematics: &Kinematics) -> Result<f64> {
        let motion = self.motion_of(kinematics);
        self.check_sinkage(sinkage, kinematics, &motion)?;
        Ok(self.laws.entry_at(sinkage, &motion, &self.size))
    }

    /// The sinkage of a contact, m.
    #[inline]
    pub(crate) fn sinkage_at(&self, theta_1: f64, kinematics: &Kinematics) -> f64 {
        let motion = self.motion_of(kinematics);
        self.laws.sinkage_at(theta_1, &motion, &self.size)
    }

    /// Is a sinkage inside the model, where the slip of `dug_by` has carried soil away?
    #[inline]
    pub(crate) fn check_sinkage(
        &self,
        sinkage: f64,
        kinematics: &Kinematics,
        dug_by: &Motion,
    ) -> Result<()> {
        let radius = self.size.radius;
        Error::check_range("sinkage", sinkage, 0.0, f64::MAX, "m")?;
        if sinkage >= radius * self.depth_limit(kinematics) {
            return Err(Error::HubBuried { sinkage, radius });
        }
        let rebound = self.soil.params().rebound;
        if rebound > 0.0
            && rebound * (sinkage - self.laws.transport_depth(dug_by, &self.size)) >= radius
        {
            return Err(Error::ReboundAboveHub {
                rebound,
                sinkage,
                radius,
            });
        }
        Ok(())
    }

    /// The greatest sinkage over the radius: 1, or with the law for the soil beside the hub [`BURIED_PER_RADIUS`].
    #[inline]
    pub(crate) fn depth_limit(&self, kinematics: &Kinematics) -> f64 {
        let is_sideways = || kinematics.slip_angle().rad().abs() >= BURIED_FROM_RAD;
        if self.settings.bulldozing.is_beside_hub() && is_sideways() {
            BURIED_PER_RADIUS
        } else {
            1.0
        }
    }

    #[inline]
    pub(crate) fn check_exponent(&self, kinematics: &Kinematics) -> Result<()> {
        if self.constants.radius_power.is_some() {
            // the soil's own, which was checked with it
            return Ok(());
        }
        let n = self.laws.exponent_at(&self.motion_of(kinematics));
        Error::check_range("n at this slip", n, EXPONENT.0, EXPONENT.1, "1")
    }

    /// The motion as the contact's laws take it: steps in time are spared an arc tangent each where none takes the slip angle.
    #[inline]
    pub(crate) fn motion_of(&self, kinematics: &Kinematics) -> Motion {
        if self.takes_slip_angle {
            return kinematics.motion();
        }
        Motion {
            slip: kinematics.slip().value(),
            q_y: kinematics.q_y(),
            slip_angle: 0.0,
        }
    }

    #[inline]
    pub(crate) fn order(&self) -> Order {
        match self.settings.accuracy {
            Accuracy::Simulation => Order::Simulation,
            Accuracy::Standard => Order::Standard,
            Accuracy::Reference => Order::Reference,
        }
    }

    #[inline]
    pub(crate) fn tables(&self) -> Option<&ExponentTables> {
        self.soil.tables()
    }

    pub(crate) fn size(&self) -> &WheelSize<f64> {
        &self.size
    }

    pub(crate) fn laws(&self) -> &SoilLaws<f64> {
        &self.laws
    }

    /// The laws, those of the settings among them, in numbers of any kind.
    pub(crate) fn laws_in<R: Scalar>(&self) -> SoilLaws<R> {
        let mut laws = self.soil.laws();
        laws.choice = self.laws.choice;
        laws
    }

    /// The contact at an entry angle, in numbers of any kind: only the angle may carry a derivative.
    pub(crate) fn contact<R: Scalar>(&self, theta_1: R, kinematics: &Kinematics) -> Contact<R> {
        Contact::new(
            &self.wheel.size(),
            &self.laws_in(),
            self.settings.shear,
            &kinematics.motion(),
            theta_1,
        )
    }

    /// The contacts of a motion by their entry angles (rad).
    #[inline]
    pub(crate) fn contacts(&self, kinematics: &Kinematics) -> impl Fn(f64) -> Contact<f64> {
        let motion = self.motion_of(kinematics);
        move |theta_1| {
            let dug = Dug {
                by: &motion,
                k_shear_factor: 1.0,
            };
            let soil = (&self.laws, &self.constants);
            Contact::digging(
                &self.size,
                soil,
                self.settings.shear,
                (&motion, &dug),
                theta_1,
            )
        }
    }

    /// The contact at an entry angle (rad) on soil with a history.
    #[inline]
    pub(crate) fn contact_after(
        &self,
        theta_1: f64,
        kinematics: &Kinematics,
        history: &SoilHistory,
    ) -> Contact<f64> {
        let dug = Dug {
            by: &self.motion_of(&history.dug_by),
            k_shear_factor: history.k_shear_factor,
        };
        Contact::digging(
            &self.size,
            (&self.laws, &self.constants),
            self.settings.shear,
            (&self.motion_of(kinematics), &dug),
            theta_1,
        )
    }

    /// The whole operating point at an entry angle of the forward-rolling wheel (rad).
    pub(crate) fn point(&self, theta_1: f64, kinematics: &Kinematics) -> OperatingPoint {
        let contact = self.contacts(kinematics)(theta_1);
        let theta_1 = contact.angles().theta_1;
        let forces = contact.forces_by(self.tables(), self.order());
        let finer = match self.settings.accuracy {
            Accuracy::Simulation => Order::Standard,
            Accuracy::Standard => Order::Check,
            Accuracy::Reference => Order::Beyond,
        };
        let radius = self.size.radius;
        let mut cautions = Cautions::default();
        let side_force = self.side_force(&contact, &forces, kinematics, &mut cautions);
        let sinkage = self.sinkage_at(theta_1, kinematics);
        self.add_cautions(&contact, &forces, kinematics, &mut cautions);
        let angles = contact.angles();
        let angles = if kinematics.is_reversed() {
            let ContactAngles {
                theta_1,
                theta_2,
                theta_m,
            } = angles;
            ContactAngles {
                theta_1: -theta_1,
                theta_2: -theta_2,
                theta_m: -theta_m,
            }
        } else {
            angles
        };
        OperatingPoint {
            kinematics: *kinematics,
            sinkage,
            angles,
            forces: mirrored(forces, kinematics),
            side_force,
            finer,
            model_error: self.model_error(kinematics),
            cautions,
            contact,
            radius,
        }
    }

    /// −sign(v_y) [r b ∫ |τ_y| + κ ∫ R_b (r − h cos θ)], N.
    #[inline]
    pub(crate) fn side_force(
        &self,
        contact: &Contact<f64>,
        forces: &Forces,
        kinematics: &Kinematics,
        cautions: &mut Cautions,
    ) -> f64 {
        // the side follows the slip angle, which a wheel that spins on the spot (v → 0) keeps
        let beta = kinematics.slip_angle().rad();
        if beta == 0.0 {
            return 0.0;
        }
        let motion = Motion {
            slip_angle: beta.abs(),
            ..self.motion_of(kinematics)
        };
        let kappa: f64 = self.settings.bulldozing.kappa(&motion);
        let gamma = self.soil.params().unit_weight;
        cautions.insert_if(kappa > 0.0 && gamma.is_none(), Caution::NoBulldozing);
        let ploughed = gamma.map_or(0.0, |gamma| {
            self.settings.bulldozing.resistance(
                &self.laws.strength,
                gamma,
                self.size.radius,
                &contact.angles(),
            )
        });
        let beside = kappa * ploughed + contact.disc.map_or(0.0, |disc| disc.side);
        -beta.signum() * (forces.side_shear + beside)
    }

    /// What the soil's laws miss of measurements of such a wheel in this motion ([`LawPreset::model_error`]).
    #[must_use]
    pub fn model_error(&self, motion: &Kinematics) -> Option<ModelError> {
        let preset = LawPreset::compared(&self.soil.params().laws)?;
        Some(preset.model_error(motion, self.wheel.grousers().is_some()))
    }

    fn add_cautions(
        &self,
        contact: &Contact<f64>,
        forces: &Forces,
        kinematics: &Kinematics,
        cautions: &mut Cautions,
    ) {
        let angles = contact.angles();
        let sinkage = self.sinkage_at(angles.theta_1, kinematics);
        let outside_fit = self.soil.params().fitted.is_some_and(|fitted| {
            !fitted.holds(kinematics, self.wheel.width(), forces.vertical_force)
        });
        let radius = self.size.radius;
        let pull = forces.drawbar_pull.abs() * radius;
        cautions.judge(&Judged {
            position: self.laws.position_at(&kinematics.motion()),
            sinkage,
            radius,
            reverses: contact.shear.reverses(angles.theta_1 - angles.theta_2),
            outside_fit,
            lost_work: (forces.lost_work, forces.torque.abs().max(pull)),
        });
        let apart = contact.shear.law.is_independent() && contact.shear.sideways;
        cautions.insert_if(apart, Caution::ShearAboveStrength);
        cautions.insert_if(
            self.lugs_are_sparse(sinkage, kinematics.slip().value()),
            Caution::LugSpacing,
        );
        cautions.insert_if(self.wheel.lugs_are_high(), Caution::LugHeight);
    }
}

/// The forces of a wheel that rolls backwards, from those of its forward-rolling twin.
#[inline]
fn mirrored(forces: Forces, kinematics: &Kinematics) -> Forces {
    if !kinematics.is_reversed() {
        return forces;
    }
    Forces {
        drawbar_pull: -forces.drawbar_pull,
        torque: -forces.torque,
        thrust: -forces.thrust,
        compaction_resistance: -forces.compaction_resistance,
        ..forces
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue;

    #[test]
    fn an_exchanged_wheel_is_as_a_new_one() {
        let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
        let wheel = |radius| RigidWheel::new(radius, 0.1).unwrap();
        let new = |radius| WheelOnSoil::new(wheel(radius), soil, Settings::default()).unwrap();
        let mut exchanged = new(0.1);
        exchanged.set_wheel(wheel(0.2)).unwrap();
        let new = new(0.2);
        let numbers = |of: &WheelOnSoil| format!("{:?} {:?} {:?}", of.wheel, of.size, of.constants);
        assert_eq!(numbers(&exchanged), numbers(&new));
    }

    /// rⁿ where the exponent is the same at every slip.
    #[test]
    fn a_constant_exponent_has_its_power_of_the_radius() {
        let params = *catalogue::find("dry-sand")
            .unwrap()
            .soil()
            .unwrap()
            .params();
        let power = |n_1: f64, n_2: f64| {
            let soil = Soil::new(crate::SoilParams { n_1, n_2, ..params }).unwrap();
            let wheel = RigidWheel::new(0.3, 0.1).unwrap();
            let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
            on_soil.constants.radius_power
        };
        let constant = power(0.0, 0.0).unwrap();
        assert!((constant - 0.3_f64.powf(params.n)).abs() < 1e-15);
        assert_eq!(
            [power(0.1, 0.0), power(0.0, 0.1), power(0.1, 0.1)],
            [None; 3]
        );
    }

    /// Work that the soil gains counts against the greater of the torque and the pull at the rim.
    #[test]
    fn a_gain_of_work_is_judged_by_the_greater_work() {
        const RADIUS_M: f64 = 0.3;
        /// Of the greater work: the rounding of the balance's terms, which may cancel (`Cautions::judge`).
        const ROUNDING_SHARE: f64 = 1e-9;
        let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
        let wheel = RigidWheel::new(RADIUS_M, 0.1).unwrap();
        let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let motion = Kinematics::straight(crate::Slip::new(0.2).unwrap());
        let contact = on_soil.contact(0.4, &motion);
        let plain = contact.forces_by(on_soil.tables(), on_soil.order());
        for (torque, pull, greater) in [(2.0, -30.0, 9.0), (-20.0, 30.0, 20.0)] {
            for (share, gains) in [(0.9, false), (1.1, true)] {
                let forces = Forces {
                    torque,
                    drawbar_pull: pull,
                    lost_work: -share * ROUNDING_SHARE * greater,
                    ..plain
                };
                let mut cautions = Cautions::default();
                on_soil.add_cautions(&contact, &forces, &motion, &mut cautions);
                assert_eq!(cautions.contains(Caution::WorkGained), gains, "{torque}");
            }
        }
    }

    /// The estimated error is the greatest difference to a finer rule, a torque's as a force at the rim.
    #[test]
    fn the_error_is_the_greatest_of_three_forces() {
        let mut decides = [0; 3];
        for radius in [0.02, 0.3, 4.0] {
            for key in ["dry-sand", "snow", "clayey-soil"] {
                let soil = catalogue::find(key).unwrap().soil().unwrap();
                let wheel = RigidWheel::new(radius, 0.4 * radius).unwrap();
                let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
                for (slip, theta_1) in [(-0.7, 0.3), (0.0, 0.8), (0.3, 1.2), (0.9, 0.5)] {
                    let motion = Kinematics::straight(crate::Slip::new(slip).unwrap());
                    let contact = on_soil.contact(theta_1, &motion);
                    let by = |order| {
                        let rules = on_soil.tables().filter(|_| order == Order::Standard);
                        let f = contact.forces_by(rules, order);
                        [f.vertical_force, f.drawbar_pull, f.torque]
                    };
                    let (used, finer) = (by(Order::Standard), by(Order::Check));
                    let off: [f64; 3] = core::array::from_fn(|i| {
                        (used[i] - finer[i]).abs() / [1.0, 1.0, radius][i]
                    });
                    let greatest = off.into_iter().fold(0.0, f64::max);
                    let estimate = on_soil.point(theta_1, &motion).error_estimate();
                    assert_eq!(estimate, greatest, "{key} {slip}");
                    for (count, off) in decides.iter_mut().zip(off) {
                        *count += u32::from(off == greatest && greatest > 0.0);
                    }
                }
            }
        }
        assert!(decides.iter().all(|count| *count > 0), "{decides:?}");
    }
}
