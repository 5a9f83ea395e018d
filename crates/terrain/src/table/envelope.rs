//! The poses that a map answers for.

use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{LoadsOnPlanes, wheel_loads};

use crate::error::{Error, Result};

/// The share of its size that an envelope keeps at each step until the robot can stand in all of it.
const SHRINK_SHARE: f64 = 0.95;
/// Points a side of the rectangle at which standing is checked.
const CHECKS: i32 = 16;
/// Least load of a wheel, as a share of the mean one: near zero loads vary too fast for a table.
const MIN_LOAD_SHARE: f64 = 0.01;

/// The greatest pitch and roll, rad, either way: beyond them a map states `steep` and computes nothing.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_terrain::Envelope;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/five-wheel.toml");
/// let envelope = Envelope::within(&RobotModel::read(file.as_ref())?, 0.3, 0.25)?;
/// assert!(envelope.holds(0.2, -0.2) && !envelope.holds(0.4, 0.0));
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Envelope {
    /// rad.
    pub max_pitch: f64,
    /// rad.
    pub max_roll: f64,
}

impl Envelope {
    /// The envelope of these limits (rad), or the largest of its shape in which no wheel loses the ground.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for limits outside 1° to 45°, [`Error::DoesNotStand`].
    pub fn within(model: &RobotModel, max_pitch: f64, max_roll: f64) -> Result<Self> {
        const LIMITS_RAD: (f64, f64) = (0.017, 0.786);
        Error::check("envelope", "max_pitch", max_pitch, LIMITS_RAD, "rad")?;
        Error::check("envelope", "max_roll", max_roll, LIMITS_RAD, "rad")?;
        let mut out = Self {
            max_pitch,
            max_roll,
        };
        let loads = LoadsOnPlanes::new(model);
        while !out.stands(model, &loads) {
            out.max_pitch *= SHRINK_SHARE;
            out.max_roll *= SHRINK_SHARE;
            if out.max_pitch < LIMITS_RAD.0 {
                let loads = wheel_loads(model, 0.0, 0.0).loads;
                return Err(Error::DoesNotStand {
                    name: model.robot.name().to_owned(),
                    load: loads.into_iter().fold(f64::INFINITY, f64::min),
                });
            }
        }
        Ok(out)
    }

    /// Is a pose within it?
    #[must_use]
    pub fn holds(&self, pitch: f64, roll: f64) -> bool {
        pitch.abs() <= self.max_pitch && roll.abs() <= self.max_roll
    }

    fn stands(&self, model: &RobotModel, on_planes: &LoadsOnPlanes) -> bool {
        let least = MIN_LOAD_SHARE * model.weight() / model.wheels.len().max(1) as f64;
        let share = |step: i32| f64::from(step) / f64::from(CHECKS / 2) - 1.0;
        (0..=CHECKS).all(|i| {
            (0..=CHECKS).all(|j| {
                let (pitch, roll) = (share(i) * self.max_pitch, share(j) * self.max_roll);
                let loads = on_planes.at(pitch, roll).loads;
                loads.iter().all(|load| *load > least)
            })
        })
    }
}
