//! What each wheel carries.

use super::equations::Equations;
use crate::robot::RobotModel;

/// What each wheel carries.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelLoads {
    /// N, at right angles to the ground, in the robot's order.
    pub loads: Vec<f64>,
    /// Is none of them negative? Where no set of loads without a negative one balances the robot, these are the ones of least
    /// squares: a wheel with a negative load would have to be held down.
    pub stands: bool,
    /// Are there more wheels than equations, so that the loads depend on how the ground yields? Then these are
    /// the ones on ground that yields alike everywhere.
    pub redundant: bool,
}

/// The loads of a robot that stands, in the pose of its description, on a plane tilted by `pitch` (rad, nose up
/// positive: it looks uphill) and `roll` (rad, left side up).
///
/// Forces and moments balance for heave, roll, pitch and every freedom of the links; powered wheels hold the
/// robot on the slope, each in proportion to its load; free wheels carry only.
///
/// Assumes: small sinkage, and links in the pose of the description.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::wheel_loads;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/rocker-bogie.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// let level = wheel_loads(&model, 0.0, 0.0);
/// assert!(level.stands);
/// assert!((level.loads.iter().sum::<f64>() / model.weight() - 1.0).abs() < 1e-9);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[must_use]
pub fn wheel_loads(model: &RobotModel, pitch: f64, roll: f64) -> WheelLoads {
    LoadsOnPlanes::new(model).at(pitch, roll)
}

/// [`wheel_loads`] of one robot on many planes: what no plane changes is computed once.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::{LoadsOnPlanes, wheel_loads};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/rocker-bogie.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// assert_eq!(LoadsOnPlanes::new(&model).at(0.1, 0.2), wheel_loads(&model, 0.1, 0.2));
/// # Ok::<(), grouser_rover::Error>(())
/// ```
pub struct LoadsOnPlanes {
    equations: Equations,
    redundant: bool,
}

impl LoadsOnPlanes {
    /// Of a robot.
    #[must_use]
    pub fn new(model: &RobotModel) -> Self {
        Self {
            equations: Equations::on_plane(model),
            redundant: model.wheels.len() > 3 + model.linkage.freedoms(),
        }
    }

    /// On a plane tilted by `pitch` and `roll`, rad.
    #[must_use]
    pub fn at(&self, pitch: f64, roll: f64) -> WheelLoads {
        let (loads, stands) = self.equations.loads(self.equations.down(pitch, roll));
        WheelLoads {
            loads,
            stands,
            redundant: self.redundant,
        }
    }
}
