//! A robot ready to be put on the ground.

use std::path::Path;

use grouser_files::Document;
use grouser_files::body::{BodyFile, MassFile};
use grouser_files::robot::{self, RobotFile};
use grouser_real::Real;
use grouser_slip::SensorSettings;
use grouser_slip::WheelRole;
use grouser_terra::RigidWheel;

use super::actuator::{Actuated, Actuator, actuators};
use crate::body::{Body, Hold, Link, Linkage, MAX_CHAIN, MAX_FREEDOMS, Motor};
use crate::error::{Error, Result, find};
use crate::vector::{Tensor, Vector};

/// How a wheel is mounted, and what turns it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelMount {
    /// Its name.
    pub name: String,
    /// The name of its joint in messages.
    pub joint: String,
    /// The link that carries it; `None`: the chassis.
    pub link: Option<usize>,
    /// Its centre in the pose of the description, m.
    pub centre: Vector,
    /// The direction in which it drives, rad from x towards y.
    pub heading: f64,
    /// Radius and width.
    pub wheel: RigidWheel,
    /// kg.
    pub mass: f64,
    /// Inertia about its axle with what turns with it, kg m².
    pub spin_inertia: f64,
    /// Friction of its bearing, N m.
    pub bearing: f64,
    /// Lean, top to the left, rad.
    pub camber: f64,
    /// Lean of the steering axis, rad.
    pub caster: f64,
    /// How far it steers either way, rad; 0: not at all.
    pub steer_range: f64,
    /// How fast, rad/s.
    pub steer_rate: f64,
    /// Its motor; `None` for a free wheel.
    pub motor: Option<Motor>,
}

impl WheelMount {
    /// The axle's direction at the steering angle `steer` (rad), in the pose of the description: to the left
    /// of travel.
    ///
    /// A steering axis that leans back by the caster leans the wheel by caster · sin(steer).
    #[must_use]
    pub fn axle(&self, steer: f64) -> Vector {
        let (sin, cos) = Real::sin_cos(self.heading + steer);
        let (lean_sin, lean_cos) = Real::sin_cos(self.camber + self.caster * Real::sin(steer));
        Vector::new(-sin * lean_cos, cos * lean_cos, -lean_sin)
    }
}

/// A robot: what the estimator knows of it, its body, and its wheels in the same order.
///
/// ```
/// use grouser_rover::robot::RobotModel;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/five-wheel.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// assert_eq!((model.wheels.len(), model.powered().count()), (6, 5));
/// assert!((model.weight() / model.linkage.mass() - 9.8).abs() < 0.1);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RobotModel {
    /// What the estimator knows.
    pub robot: grouser_slip::Robot,
    /// How the estimator is to work.
    pub settings: SensorSettings,
    /// Chassis and links with all masses, those of the wheels included.
    pub linkage: Linkage,
    /// The wheels.
    pub wheels: Vec<WheelMount>,
    /// The names of the links.
    pub links: Vec<String>,
    /// What reconfigures the chassis.
    pub actuators: Vec<Actuator>,
}

impl RobotModel {
    /// Reads a robot file.
    ///
    /// # Errors
    /// What the file lacks or says wrong.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(&Document::read(path)?)
    }

    /// A robot out of a document.
    ///
    /// # Errors
    /// As [`RobotModel::read`].
    pub fn parse(document: &Document) -> Result<Self> {
        Self::new(&robot::parse(document)?)
    }

    /// A robot out of what a file says.
    ///
    /// # Errors
    /// [`Error::Missing`] where it has no body or a wheel no width, [`Error::Unknown`] for names of links or
    /// motors that do not exist, [`Error::TooMany`].
    pub fn new(file: &RobotFile) -> Result<Self> {
        let name = file.robot.name().to_owned();
        let Some(body) = &file.body else {
            return Err(Error::Missing {
                of: format!("robot \"{name}\""),
                what: "its [chassis], which a simulation needs".into(),
            });
        };
        let (links, holds) = links(body)?;
        let wheels = wheels(file, body)?;
        let bodies = bodies(body, &wheels);
        let settings = SensorSettings {
            reference: file.reference.unwrap_or(file.settings.reference),
            ..file.settings
        };
        let mut linkage = Linkage::new(bodies, links, holds);
        let actuators = actuators(body, &mut linkage)?;
        Ok(Self {
            robot: file.robot.clone(),
            settings,
            linkage: match file.gravity {
                Some(gravity) => linkage.under_gravity(gravity),
                None => linkage,
            },
            wheels,
            links: body.links.iter().map(|link| link.name.clone()).collect(),
            actuators,
        })
    }

    /// The link that each joint of the suspension turns; of links that a differential joins it is the first.
    #[must_use]
    pub fn turned_links(&self) -> Vec<String> {
        let joints = 0..self.linkage.freedoms();
        let first = |joint| {
            let mut links = self.links.iter().zip(self.linkage.links());
            links.find(|(_, link)| link.freedom == joint)
        };
        joints
            .filter_map(|joint| first(joint).map(|(name, _)| name.clone()))
            .collect()
    }

    /// The indices of the powered wheels.
    pub fn powered(&self) -> impl Iterator<Item = usize> + '_ {
        self.wheels
            .iter()
            .enumerate()
            .filter(|(_, wheel)| wheel.motor.is_some())
            .map(|(index, _)| index)
    }

    /// The same robot under another gravity than that of its file, or than the Earth's where the file has none, m/s².
    #[must_use]
    pub fn under_gravity(mut self, gravity: f64) -> Self {
        self.linkage = self.linkage.under_gravity(gravity);
        self
    }

    /// The gravity that it is under, m/s².
    #[must_use]
    pub const fn gravity(&self) -> f64 {
        self.linkage.gravity()
    }

    /// Moves an actuator to a position, whatever its range. One that does not exist moves nothing.
    pub fn place_actuator(&mut self, actuator: usize, position: f64) {
        let Some(own) = self.actuators.get_mut(actuator) else {
            return;
        };
        let by = position - own.position;
        own.position = position;
        match own.moves {
            Actuated::Link { freedom, sign } => self.linkage.drive(freedom, sign * by),
            Actuated::Mass { along, mass } => {
                let chassis = self.linkage.bodies().iter();
                let whole: f64 = (chassis.filter(|body| body.link.is_none()))
                    .map(|body| body.mass)
                    .sum();
                self.linkage.shift(along * (by * mass / whole));
            }
        }
    }

    /// Weight of the whole, N.
    ///
    /// ```
    /// use grouser_rover::robot::RobotModel;
    ///
    /// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
    /// assert!(RobotModel::read(file.as_ref())?.weight() > 100.0); // N
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.linkage.mass() * self.linkage.gravity()
    }
}

/// Links that a differential joins share one freedom.
fn links(body: &BodyFile) -> Result<(Vec<Link>, Vec<Hold>)> {
    let names = || body.links.iter().map(|link| link.name.as_str());
    let mut out: Vec<Link> = Vec::new();
    let mut holds = Vec::new();
    let joints = body.joints();
    for (index, file) in body.links.iter().enumerate() {
        let of = format!("link \"{}\"", file.name);
        let on = match &file.on {
            None => None,
            Some(on) => Some(find(&of, on, names().take(index))?),
        };
        let mut chain = 1;
        let mut next = on;
        while let Some(carrier) = next {
            chain += 1;
            next = out.get(carrier).and_then(|link| link.on);
        }
        if chain > MAX_CHAIN {
            return Err(Error::TooMany {
                what: "links one upon the other",
                count: chain,
                limit: MAX_CHAIN,
            });
        }
        if let Some(other) = &file.opposite {
            find(&of, other, names())?;
        }
        let (freedom, sign) = joints[index];
        if freedom == holds.len() {
            holds.push(Hold {
                stiffness: file.stiffness,
                damping: file.damping,
                preload: file.preload,
                range: file.range,
                driven: None,
            });
        }
        out.push(Link {
            on,
            pivot: vector(file.pivot),
            freedom,
            sign,
        });
    }
    if holds.len() > MAX_FREEDOMS {
        return Err(Error::TooMany {
            what: "links that turn by themselves",
            count: holds.len(),
            limit: MAX_FREEDOMS,
        });
    }
    Ok((out, holds))
}

fn wheels(file: &RobotFile, body: &BodyFile) -> Result<Vec<WheelMount>> {
    let of_law = |name: &str, source| Error::Law {
        of: format!("wheel \"{name}\""),
        source,
    };
    let mut out = Vec::new();
    for (wheel, extra) in file.robot.wheels().iter().zip(&body.wheels) {
        let of = format!("wheel \"{}\"", wheel.name);
        let mut joints = file.topics.joints.iter();
        let joint = joints.find(|joint| joint.wheel == wheel.name);
        let joint = joint.and_then(|joint| joint.joint.clone());
        let width = wheel.width.ok_or_else(|| Error::Missing {
            of: of.clone(),
            what: "width_m".into(),
        })?;
        let link = match &extra.on {
            None => None,
            Some(on) => Some(find(&of, on, body.links.iter().map(|l| l.name.as_str()))?),
        };
        let motor = match (&extra.motor, wheel.role) {
            (Some(name), WheelRole::Powered) => {
                let index = find(&of, name, body.motors.iter().map(|m| m.name.as_str()))?;
                Some(&body.motors[index])
            }
            (None, WheelRole::Powered) => {
                return Err(Error::Missing {
                    of,
                    what: "its motor".into(),
                });
            }
            (_, WheelRole::Free) => None,
        };
        let gear = wheel.encoder.gear;
        let ring = extra.mass * wheel.radius * wheel.radius;
        let rotor = motor.map_or(0.0, |motor| motor.rotor_inertia * gear * gear);
        out.push(WheelMount {
            name: wheel.name.clone(),
            joint: joint.unwrap_or_else(|| wheel.name.clone()),
            link,
            centre: Vector::new(wheel.x, wheel.y, extra.z.unwrap_or(wheel.radius)),
            heading: wheel.heading.rad(),
            wheel: wheel
                .rigid(width)
                .map_err(|source| of_law(&wheel.name, source))?,
            mass: extra.mass,
            spin_inertia: extra.spin_inertia.unwrap_or(ring) + rotor,
            bearing: extra.bearing,
            camber: extra.camber,
            caster: extra.caster,
            steer_range: extra.steer_range,
            steer_rate: extra.steer_rate,
            motor: motor.map(|motor| Motor {
                resistance: motor.resistance,
                constant: motor.constant,
                gear,
                efficiency: motor.gear_efficiency,
                voltage: motor.voltage,
                current: motor.current,
            }),
        });
    }
    Ok(out)
}

/// Chassis and links, each with its wheels: a wheel's turning about its own axle is a motion of its own, so
/// that it counts as a point with half its spin inertia across.
fn bodies(body: &BodyFile, wheels: &[WheelMount]) -> Vec<Body> {
    let files = std::iter::once((None, &body.chassis)).chain(
        body.links
            .iter()
            .enumerate()
            .map(|(index, link)| (Some(index), &link.mass)),
    );
    files
        .map(|(link, own)| {
            let mounted = wheels.iter().filter(|wheel| wheel.link == link);
            with_wheels(link, own, mounted)
        })
        .collect()
}

fn with_wheels<'a>(
    link: Option<usize>,
    own: &MassFile,
    wheels: impl Iterator<Item = &'a WheelMount> + Clone,
) -> Body {
    let (mut mass, mut moment) = (own.mass, vector(own.centre) * own.mass);
    for wheel in wheels.clone() {
        mass += wheel.mass;
        moment += wheel.centre * wheel.mass;
    }
    let centre = moment * (1.0 / mass);
    let mut inertia = Tensor::diagonal(vector(own.inertia))
        .plus(Tensor::of_point(own.mass, vector(own.centre) - centre), 1.0);
    for wheel in wheels {
        let across = 0.5 * wheel.mass * wheel.wheel.radius() * wheel.wheel.radius();
        inertia = inertia
            .plus(Tensor::of_point(wheel.mass, wheel.centre - centre), 1.0)
            .plus(Tensor::diagonal(Vector::new(across, 0.0, across)), 1.0);
    }
    Body {
        link,
        mass,
        centre,
        inertia,
    }
}

fn vector([x, y, z]: [f64; 3]) -> Vector {
    Vector::new(x, y, z)
}
