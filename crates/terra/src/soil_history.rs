//! Soil that a wheel has not finished digging, or that wheels have passed before.

use crate::caution::Cautions;
use crate::error::{Error, Result};
use crate::forces::Forces;
use crate::kinematics::Kinematics;
use crate::wheel_on_soil::WheelOnSoil;

/// What a wheel's way, and wheels before it, have made of the soil under it, for simulations in time.
///
/// The laws of a steady wheel take the slip-sinkage of its motion for granted. A wheel whose slip has just changed
/// has not dug that deep: [`SoilHistory::dug_by`] is the motion whose exponent n(s) and transported layer hold now,
/// and the caller lets it follow the wheel's motion over its way. [`SoilHistory::k_shear_factor`] is what passes
/// leave of the shear modulus ([`MultiPass`](crate::MultiPass)). Shear, θ_m and rear contact follow the motion at once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilHistory {
    /// The motion that slip-sinkage has settled to.
    pub dug_by: Kinematics,
    /// Factor of the shear deformation modulus K, 1.
    pub k_shear_factor: f64,
}

impl SoilHistory {
    /// Undisturbed soil under a wheel in steady motion: every law is that without a history.
    #[must_use]
    #[inline]
    pub const fn steady(motion: Kinematics) -> Self {
        Self {
            dug_by: motion,
            k_shear_factor: 1.0,
        }
    }

    /// The same with another factor of K.
    #[must_use]
    #[inline]
    pub const fn with_k_shear_factor(self, k_shear_factor: f64) -> Self {
        Self {
            k_shear_factor,
            ..self
        }
    }
}

impl WheelOnSoil {
    /// Forces at a sinkage (m) on soil with a history: [`WheelOnSoil::forces_at`] otherwise.
    ///
    /// # Errors
    /// As [`WheelOnSoil::forces_at`]; [`Error::OutOfRange`] for a factor outside [0.001, 1000].
    ///
    /// ```
    /// use grouser_terra::{
    ///     Kinematics, RigidWheel, Settings, Slip, SoilHistory, SoilParams, Soil, WheelOnSoil, catalogue,
    /// };
    ///
    /// let sand = *catalogue::find("dry-sand").expect("in the catalogue").soil()?.params();
    /// let digging = Soil::new(SoilParams { n_1: 0.3, ..sand })?;
    /// let on_soil = WheelOnSoil::new(RigidWheel::new(0.1, 0.05)?, digging, Settings::default())?;
    /// let straight = |s| Ok::<_, grouser_terra::Error>(Kinematics::straight(Slip::new(s)?));
    /// // the slip has jumped from 0 to 0.6: the wheel bears more than it will when it has dug
    /// let before = SoilHistory::steady(straight(0.0)?);
    /// let now = on_soil.forces_after(0.02, &straight(0.6)?, &before)?;
    /// assert!(now.vertical_force > 1.5 * on_soil.forces_at(0.02, &straight(0.6)?)?.vertical_force);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[inline]
    pub fn forces_after(
        &self,
        sinkage: f64,
        kinematics: &Kinematics,
        history: &SoilHistory,
    ) -> Result<Forces> {
        let theta_1 = self.entry_angle(sinkage, kinematics)?;
        self.check_history(history)?;
        let contact = self.contact_after(theta_1, kinematics, history);
        Ok(self.forces_of(&contact, kinematics))
    }

    /// Forces at a sinkage (m) on soil with a history, and the side force with the ploughed soil's part
    /// ([`OperatingPoint::side_force`](crate::OperatingPoint::side_force)), N: all that a step in time needs of an operating point.
    ///
    /// # Errors
    /// As [`WheelOnSoil::forces_after`].
    ///
    /// ```
    /// use grouser_terra::{
    ///     Accuracy, Kinematics, RigidWheel, Settings, SoilHistory, WheelOnSoil, catalogue,
    /// };
    ///
    /// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let settings = Settings { accuracy: Accuracy::Simulation, ..Settings::default() };
    /// let on_soil = WheelOnSoil::new(RigidWheel::new(0.1, 0.05)?, sand, settings)?;
    /// let drifting = Kinematics::from_speeds(0.08, 0.03, 0.1)?;
    /// let steady = SoilHistory::steady(drifting);
    /// let (forces, side) = on_soil.forces_and_side_after(0.02, &drifting, &steady)?;
    /// let exact = on_soil.at_sinkage(0.02, &drifting)?;
    /// assert!((side - exact.side_force).abs() < 1e-6 * forces.vertical_force);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[inline]
    pub fn forces_and_side_after(
        &self,
        sinkage: f64,
        kinematics: &Kinematics,
        history: &SoilHistory,
    ) -> Result<(Forces, f64)> {
        let theta_1 = self.entry_angle(sinkage, kinematics)?;
        self.check_history(history)?;
        let contact = self.contact_after(theta_1, kinematics, history);
        let forces = self.forces_of(&contact, kinematics);
        let side = self.side_force(&contact, &forces, kinematics, &mut Cautions::default());
        Ok((forces, side))
    }

    #[inline]
    fn check_history(&self, history: &SoilHistory) -> Result<()> {
        self.check_exponent(&history.dug_by)?;
        Error::check_range("k_shear_factor", history.k_shear_factor, 1e-3, 1e3, "1")
    }
}
