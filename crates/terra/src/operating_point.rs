//! A solved operating point and what follows from it.

use crate::angle::Angle;
use crate::caution::Cautions;
use crate::contact::{Contact, ContactAngles, Order};
use crate::forces::Forces;
use crate::kinematics::Kinematics;
use crate::law_preset::ModelError;

/// A wheel at one sinkage and one motion: geometry, stresses, forces and how far to trust them.
///
/// ```
/// use grouser_terra::{Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};
///
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let contact = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
/// let solution = contact.under_load(80.0, &Kinematics::straight(Slip::new(0.3)?))?;
/// let point = solution.point().expect("80 N are carried");
/// assert!((point.forces.vertical_force / 80.0 - 1.0).abs() < 1e-6);
/// assert_eq!(point.normal_stress(point.angles.theta_1), 0.0); // none where the soil is first touched
/// assert!(point.tractive_efficiency().is_some_and(|efficiency| efficiency < 0.7)); // η < 1 − s
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct OperatingPoint {
    /// The motion it was computed for.
    pub kinematics: Kinematics,
    /// Sinkage z, m.
    pub sinkage: f64,
    /// Contact angles, rad; mirrored (negative entry) for a wheel that rolls backwards.
    pub angles: ContactAngles,
    /// Forces and torque; drawbar pull and torque carry the sign of the robot's forward direction.
    pub forces: Forces,
    /// Force of the soil on the wheel to the left, N.
    pub side_force: f64,
    /// What the laws miss of measurements; `None` where that is not known.
    pub model_error: Option<ModelError>,
    /// What to keep in mind.
    pub cautions: Cautions,
    pub(crate) contact: Contact<f64>,
    pub(crate) radius: f64,
    pub(crate) finer: Order,
}

impl OperatingPoint {
    /// How far any of vertical force, drawbar pull and torque/r may be off by quadrature, N: the
    /// difference to a finer rule.
    #[must_use]
    pub fn error_estimate(&self) -> f64 {
        let finer = self.contact.forces_by(None, self.finer);
        let [pull, torque] = [self.forces.drawbar_pull, self.forces.torque].map(|x| self.mirror(x));
        (self.forces.vertical_force - finer.vertical_force)
            .abs()
            .max((pull - finer.drawbar_pull).abs())
            .max((torque - finer.torque).abs() / self.radius)
    }

    /// Normal stress at `theta` (rad), Pa.
    #[must_use]
    pub fn normal_stress(&self, theta: f64) -> f64 {
        self.contact.normal_stress(self.mirror(theta))
    }

    /// Shear stress along and across the wheel at `theta` (rad), Pa: along, positive where the soil
    /// pushes the rim in the sense of the torque that drives it; across, positive where the rim has moved
    /// to the left.
    #[must_use]
    pub fn shear_stress(&self, theta: f64) -> (f64, f64) {
        self.contact.shear_stress(self.mirror(theta))
    }

    /// Tractive efficiency η = DP q r/T: the share of the motor's work that pulls. `None` unless the
    /// wheel is driven and pulls (T > 0, DP > 0).
    #[must_use]
    pub fn tractive_efficiency(&self) -> Option<f64> {
        let (pull, torque) = (
            self.mirror(self.forces.drawbar_pull),
            self.mirror(self.forces.torque),
        );
        tractive_efficiency(self.q(), self.radius, pull, torque)
    }

    /// Energy that the motor gives per metre of travel, T/(q r), J/m; negative where the wheel brakes a
    /// motor. `None` for a wheel that spins on the spot.
    #[must_use]
    pub fn energy_per_metre(&self) -> Option<f64> {
        let torque = self.mirror(self.forces.torque);
        let q = self.q();
        (q > 0.0).then(|| {
            if q.is_infinite() {
                0.0
            } else {
                torque / (q * self.radius)
            }
        })
    }

    /// Pull coefficient DP/W. `None` where nothing is carried.
    #[must_use]
    pub fn pull_coefficient(&self) -> Option<f64> {
        (self.forces.vertical_force > 0.0)
            .then(|| self.forces.drawbar_pull / self.forces.vertical_force)
    }

    /// The slope on which this pull holds this load: atan(DP/W). `None` where nothing is carried.
    #[must_use]
    pub fn gradeability(&self) -> Option<Angle> {
        self.pull_coefficient()
            .map(|ratio| Angle::from_rad(grouser_real::Real::atan(ratio)))
    }

    fn q(&self) -> f64 {
        self.kinematics.slip().speed_ratio()
    }

    /// `x` as the forward-rolling twin has it.
    fn mirror(&self, x: f64) -> f64 {
        if self.kinematics.is_reversed() { -x } else { x }
    }
}

/// DP q r/T of a wheel that is driven and pulls; `None` of others.
pub(crate) fn tractive_efficiency(q: f64, radius: f64, pull: f64, torque: f64) -> Option<f64> {
    (torque > 0.0 && pull > 0.0).then(|| pull * q * radius / torque)
}
