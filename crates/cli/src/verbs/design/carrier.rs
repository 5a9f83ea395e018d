//! The robot that carries the wheels: its present wheel, and the same robot on another one.

use std::path::Path;

use grouser_design::mission::{MissionWheel, SlopeShare, Standing, WheelDesign};
use grouser_files::robot::{self, RobotFile};
use grouser_rover::robot::{RobotModel, WheelMount};
use grouser_rover::statics::wheel_loads;
use grouser_slip::Robot;
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

use crate::error::{Error, Result, shown};
use crate::law_error::Names;

/// A robot and the wheels of it that are designed.
pub(super) struct Carrier {
    file: RobotFile,
    model: RobotModel,
    /// By wheel: does it become the new one?
    designed: Vec<bool>,
    /// The wheel that they have now.
    pub(super) present: WheelDesign,
    /// Its mass by the robot file, kg.
    pub(super) present_mass: f64,
}

impl Carrier {
    /// The robot of a file under a mission's gravity (m/s²). All powered wheels that are like the first powered one are
    /// designed.
    pub(super) fn new(path: &Path, gravity: Option<f64>) -> Result<Self> {
        let mut file = robot::read(path)?;
        let mut model = RobotModel::new(&file)?;
        if let Some(gravity) = gravity {
            model = model.under_gravity(gravity);
        }
        let usual = file.gravity.unwrap_or(EARTH_GRAVITY_M_PER_S2);
        if model.gravity() != usual {
            file.gravity = Some(model.gravity());
        }
        let Some(first) = model.wheels.iter().find(|mount| mount.motor.is_some()) else {
            return Err(Error::usage_without_hint(format!(
                "{}: no wheel of the robot is powered",
                shown(path)
            )));
        };
        let Some(present) = WheelDesign::from_wheel(&first.wheel) else {
            return Err(Error::usage(
                format!(
                    "{}: the lugs of wheel \"{}\" have no number",
                    shown(path),
                    first.name
                ),
                "give the wheels `grouser_count` and `grouser_thickness_m`",
            ));
        };
        let is_alike = |mount: &WheelMount| mount.motor.is_some() && mount.wheel == first.wheel;
        Ok(Self {
            designed: model.wheels.iter().map(is_alike).collect(),
            present,
            present_mass: first.mass,
            file,
            model,
        })
    }

    pub(super) fn name(&self) -> &str {
        self.file.robot.name()
    }

    pub(super) const fn gravity(&self) -> f64 {
        self.model.gravity()
    }

    pub(super) fn wheel_count(&self) -> usize {
        self.designed.len()
    }

    /// Names of the wheels that are designed, or of those that are not.
    pub(super) fn names(&self, designed: bool) -> Vec<String> {
        let mounts = self.model.wheels.iter().zip(&self.designed);
        mounts
            .filter(|(_, is_designed)| **is_designed == designed)
            .map(|(mount, _)| mount.name.clone())
            .collect()
    }

    /// Names of all wheels.
    pub(super) fn all_names(&self) -> impl Iterator<Item = String> {
        self.model.wheels.iter().map(|mount| mount.name.clone())
    }

    pub(super) fn wheels(&self) -> Vec<MissionWheel> {
        let mounts = self.model.wheels.iter().zip(&self.designed);
        mounts
            .map(|(mount, is_designed)| {
                if *is_designed {
                    MissionWheel::designed()
                } else {
                    let bearing = mount.motor.is_none().then_some(mount.bearing);
                    MissionWheel::kept(mount.wheel, bearing)
                }
            })
            .collect()
    }

    /// The radius from which a designed wheel with lugs of this height touches a wheel before or behind it, m.
    pub(super) fn touching_radius(&self, lug_height: f64) -> f64 {
        let mut least = f64::INFINITY;
        for (i, a) in self.model.wheels.iter().enumerate() {
            for (j, b) in self.model.wheels.iter().enumerate() {
                let apart = (a.centre.y - b.centre.y).abs();
                if i == j || !self.designed[i] || apart >= 0.5 * (a.wheel.width() + b.wheel.width())
                {
                    continue;
                }
                let distance = (a.centre.x - b.centre.x).abs();
                least = least.min(if self.designed[j] {
                    0.5 * distance - lug_height
                } else {
                    distance - b.wheel.running_radius() - lug_height
                });
            }
        }
        least
    }

    /// The robot file with a wheel of this mass (kg): everything that stands on the axles rises with the radius.
    fn file_with(&self, wheel: &WheelDesign, mass: f64) -> Result<RobotFile> {
        let mut file = self.file.clone();
        let rise = wheel.radius - self.present.radius;
        let mut wheels = file.robot.wheels().to_vec();
        let own = wheels.iter_mut().zip(&self.designed);
        for (one, _) in own.filter(|(_, designed)| **designed) {
            one.radius = wheel.radius;
            one.width = Some(wheel.width);
            one.grousers = wheel.lugs();
        }
        let refused = |error: grouser_slip::Error| Error::usage_without_hint(error.to_string());
        file.robot = Robot::new(self.file.robot.name().to_owned(), wheels).map_err(refused)?;
        if let Some(body) = &mut file.body {
            body.chassis.centre[2] += rise;
            body.chassis.centre[0] += wheel.mass_shift;
            for link in &mut body.links {
                link.pivot[2] += rise;
                link.mass.centre[2] += rise;
            }
            let own = body.wheels.iter_mut().zip(&self.designed);
            for (one, _) in own.filter(|(_, designed)| **designed) {
                let before = one.mass * self.present.radius.powi(2);
                let factor = mass * wheel.radius.powi(2) / before;
                // A ring's inertia is assumed where the file gives none.
                one.spin_inertia = one
                    .spin_inertia
                    .filter(|_| factor.is_finite())
                    .map(|inertia| inertia * factor);
                one.z = one.z.map(|z| z + rise);
                one.mass = mass;
            }
        }
        Ok(file)
    }

    /// The robot on a wheel of this mass (kg).
    pub(super) fn model(&self, wheel: &WheelDesign, mass: f64) -> Result<RobotModel> {
        let model = RobotModel::new(&self.file_with(wheel, mass)?)?;
        Ok(model.under_gravity(self.gravity()))
    }

    /// The robot file with a wheel, as text; loads that it states are those of the level.
    pub(super) fn robot(&self, wheel: &WheelDesign, mass: f64) -> Result<String> {
        let mut file = self.file_with(wheel, mass)?;
        let level = wheel_loads(&self.model(wheel, mass)?, 0.0, 0.0);
        let mut wheels = file.robot.wheels().to_vec();
        for (one, load) in wheels.iter_mut().zip(&level.loads) {
            one.load = one.load.map(|_| *load);
        }
        let refused = |error: grouser_slip::Error| Error::usage_without_hint(error.to_string());
        file.robot = Robot::new(file.robot.name().to_owned(), wheels).map_err(refused)?;
        Ok(robot::to_toml(&file))
    }

    /// How far the chassis' mass may be shifted, backwards and forwards, before it lies beyond the outermost wheels, m.
    pub(super) fn shift_limits(&self) -> (f64, f64) {
        let centre = (self.file.body.as_ref()).map_or(0.0, |body| body.chassis.centre[0]);
        let places = self
            .model
            .wheels
            .iter()
            .map(|mount| mount.centre.x - centre);
        places.fold((0.0, 0.0), |(back, front), place| {
            (place.min(back), place.max(front))
        })
    }

    /// What the wheels carry with a wheel of this radius (m) and mass (kg) where the chassis' mass is shifted forwards (m).
    pub(super) fn standing(
        &self,
        (radius, mass, mass_shift): (f64, f64, f64),
        slopes: &[SlopeShare],
    ) -> Result<Standing> {
        let wheel = WheelDesign {
            radius,
            mass_shift,
            ..self.present
        };
        wheel.rigid().map_err(|error| Names::Flags.error(&error))?;
        let model = self.model(&wheel, mass)?;
        let loads = slopes
            .iter()
            .map(|slope| wheel_loads(&model, slope.slope_deg.to_radians(), 0.0).loads);
        Ok(Standing {
            weight: model.weight(),
            loads: loads.collect(),
        })
    }
}
