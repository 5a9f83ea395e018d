//! Soil that a wheel has not finished digging, or that wheels have passed before.

use crate::caution::Cautions;
use crate::contact::entry_angle;
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

/// A sinkage with the entry angle that it gives: a step in time needs the angle twice, for the length of the contact and
/// for the forces, and computes its arc sine once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Entry {
    sinkage: f64,
    theta_1: f64,
}

impl Entry {
    /// That of a wheel of `radius` ([`RigidWheel::running_radius`](crate::RigidWheel::running_radius)) sunk by `sinkage`, both m.
    ///
    /// ```
    /// use grouser_terra::Entry;
    /// assert!((Entry::new(0.05, 0.1).theta_1().to_degrees() - 60.0).abs() < 1e-12);
    /// ```
    #[must_use]
    #[inline]
    pub fn new(sinkage: f64, radius: f64) -> Self {
        Self {
            sinkage,
            theta_1: entry_angle(sinkage, radius),
        }
    }

    /// The sinkage, m.
    #[must_use]
    #[inline]
    pub const fn sinkage(&self) -> f64 {
        self.sinkage
    }

    /// The entry angle, rad.
    #[must_use]
    #[inline]
    pub const fn theta_1(&self) -> f64 {
        self.theta_1
    }
}

/// What a side force consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SideForce {
    /// Shear alone: a wheel that hardly drifts ploughs nothing.
    Shear,
    /// Shear and the ploughed soil ([`OperatingPoint::side_force`](crate::OperatingPoint::side_force)).
    Whole,
}

impl WheelOnSoil {
    /// Forces on soil with a history, and the side force, N: [`WheelOnSoil::forces_at`] otherwise, and all that a step in time
    /// needs of an operating point. The entry must be that of this wheel's radius.
    ///
    /// # Errors
    /// As [`WheelOnSoil::forces_at`]; [`Error::OutOfRange`] for a factor outside [0.001, 1000].
    ///
    /// ```
    /// use grouser_terra::{
    ///     Entry, Kinematics, RigidWheel, Settings, SideForce, Slip, SoilHistory, SoilParams, Soil, WheelOnSoil, catalogue,
    /// };
    ///
    /// let sand = *catalogue::find("dry-sand").expect("in the catalogue").soil()?.params();
    /// let digging = Soil::new(SoilParams { n_1: 0.3, ..sand })?;
    /// let wheel = RigidWheel::new(0.1, 0.05)?;
    /// let on_soil = WheelOnSoil::new(wheel, digging, Settings::default())?;
    /// let straight = |s| Ok::<_, grouser_terra::Error>(Kinematics::straight(Slip::new(s)?));
    /// // the slip has jumped from 0 to 0.6: the wheel bears more than it will when it has dug
    /// let before = SoilHistory::steady(straight(0.0)?);
    /// let entry = Entry::new(0.02, wheel.running_radius());
    /// let (now, side) = on_soil.forces_after(&entry, &straight(0.6)?, &before, SideForce::Whole)?;
    /// assert!(now.vertical_force > 1.5 * on_soil.forces_at(0.02, &straight(0.6)?)?.vertical_force);
    /// assert_eq!(side, 0.0);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[inline]
    pub fn forces_after(
        &self,
        entry: &Entry,
        kinematics: &Kinematics,
        history: &SoilHistory,
        side: SideForce,
    ) -> Result<(Forces, f64)> {
        let dug_by = self.motion_of(&history.dug_by);
        self.check_sinkage(entry.sinkage, kinematics, &dug_by)?;
        self.check_exponent(&history.dug_by)?;
        Error::check_range("k_shear_factor", history.k_shear_factor, 1e-3, 1e3, "1")?;
        let theta_1 = if self.laws().transport_depth(&dug_by, self.size()) == 0.0 {
            entry.theta_1
        } else {
            self.laws().entry_at(entry.sinkage, &dug_by, self.size())
        };
        let contact = self.contact_after(theta_1, kinematics, history);
        let forces = self.forces_of(&contact, kinematics);
        let side = match side {
            SideForce::Shear if kinematics.q_y() == 0.0 => 0.0,
            SideForce::Shear => -kinematics.q_y().signum() * forces.side_shear,
            SideForce::Whole => {
                self.side_force(&contact, &forces, kinematics, &mut Cautions::default())
            }
        };
        Ok((forces, side))
    }
}
