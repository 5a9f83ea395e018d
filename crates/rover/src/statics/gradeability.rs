//! What a robot can climb.

use grouser_real::Real;
use grouser_terra::{Settings, Soil, WheelOnSoil};

use super::loads::wheel_loads;
use crate::error::{Error, Result};
use crate::robot::RobotModel;

/// What a robot can climb on a soil.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gradeability {
    /// The slope that each powered wheel alone holds under its load on the level, rad; `None` for a free wheel
    /// and for one that cannot even pull itself.
    pub wheels: Vec<Option<f64>>,
    /// The slope that the robot as a whole climbs straight on, rad; `None` if it cannot drive on the level.
    pub whole: Option<f64>,
}

/// The slopes that a robot climbs on `soil` at whatever slip serves best.
///
/// For the whole, the greatest drawbar pulls of all powered wheels under their loads on the slope must hold the
/// weight along it and the free wheels' resistance; loads shift with the slope.
///
/// # Errors
/// [`Error::Law`].
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::gradeability;
/// use grouser_terra::catalogue;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil().expect("complete");
/// let climbs = gradeability(&RobotModel::read(file.as_ref())?, &soil)?;
/// assert!(climbs.whole.is_some_and(|slope| slope > 0.0 && slope < soil.params().phi.rad()));
/// # Ok::<(), grouser_rover::Error>(())
/// ```
pub fn gradeability(model: &RobotModel, soil: &Soil) -> Result<Gradeability> {
    let mut pairs = Vec::new();
    for mount in &model.wheels {
        let pair = WheelOnSoil::new(mount.wheel, *soil, Settings::default())
            .map_err(|source| of(&mount.name, source))?;
        pairs.push(pair);
    }
    let level = wheel_loads(model, 0.0, 0.0);
    let mut wheels = Vec::new();
    for (index, mount) in model.wheels.iter().enumerate() {
        let load = level.loads[index];
        let alone = if mount.motor.is_some() && load > 0.0 {
            pairs[index]
                .gradeability(load)
                .map_err(|source| of(&mount.name, source))?
                .map(grouser_terra::Angle::rad)
        } else {
            None
        };
        wheels.push(alone);
    }
    let surplus = |slope: f64| -> Result<f64> {
        let loads = wheel_loads(model, slope, 0.0);
        let mut pull = -model.weight() * Real::sin(slope);
        for (index, mount) in model.wheels.iter().enumerate() {
            let load = loads.loads[index].max(0.0);
            if load == 0.0 {
                continue;
            }
            let law = |source| of(&mount.name, source);
            pull += if mount.motor.is_some() {
                let best = pairs[index].slip_of_maximum_pull(load).map_err(law)?;
                best.map_or(0.0, |best| best.value)
            } else {
                let skid = pairs[index].free_slip(load, mount.bearing).map_err(law)?;
                let Some(skid) = skid else { continue };
                let at = grouser_terra::Kinematics::straight(skid);
                let point = pairs[index].under_load(load, &at).map_err(law)?.point();
                point.map_or(0.0, |point| point.forces.drawbar_pull)
            };
        }
        Ok(pull)
    };
    let whole = if surplus(0.0)? < 0.0 {
        None
    } else {
        let (mut low, mut high) = (0.0, 1.2);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if surplus(middle)? >= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    };
    Ok(Gradeability { wheels, whole })
}

pub(super) fn of(name: &str, source: grouser_terra::Error) -> Error {
    Error::Law {
        of: format!("wheel \"{name}\""),
        source,
    }
}
