//! What the links and joints of a tree are to a robot on wheels.

use std::collections::BTreeMap;

use grouser_real::Real;

use super::error::UrdfError;
use super::frame::{Vector, dot};
use super::lugs::{Found, Lugs, Rim, lugs};
use super::mass::Mass;
use super::tree::{Joint, Kind, Shape, Tree};

/// An axis lies across or stands upright to this cosine (8°).
const MIN_AXIS_COSINE: f64 = 0.99;
/// An axle may lean by this sine (17°) to be a wheel's.
const MAX_AXLE_SINE: f64 = 0.3;

/// A wheel.
#[derive(Clone, Debug)]
pub(super) struct Wheel {
    pub(super) name: String,
    pub(super) joint: String,
    pub(super) centre: Vector,
    /// rad from x towards y.
    pub(super) heading: f64,
    /// Does the joint's angle fall when the wheel drives along its heading?
    pub(super) reversed: bool,
    /// Top to the left, rad.
    pub(super) camber: f64,
    pub(super) radius: f64,
    /// `None` of a sphere.
    pub(super) width: Option<f64>,
    pub(super) lugs: Option<Lugs>,
    pub(super) free: bool,
    pub(super) mass: Mass,
    pub(super) spin_inertia: f64,
    /// Index of its link among the rockers; `None`: the chassis.
    pub(super) on: Option<usize>,
    /// Range either way and rate of its steering, rad and rad/s.
    pub(super) steering: Option<[f64; 2]>,
}

/// A rocker, bogie or arm.
#[derive(Clone, Debug)]
pub(super) struct Rocker {
    pub(super) name: String,
    pub(super) on: Option<usize>,
    pub(super) pivot: Vector,
    pub(super) mass: Mass,
    pub(super) opposite: Option<String>,
    pub(super) damping: f64,
    pub(super) range: Option<f64>,
}

/// A robot out of its tree.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) chassis: Mass,
    pub(super) rockers: Vec<Rocker>,
    pub(super) wheels: Vec<Wheel>,
    /// Height of the plane on which the wheels stand, in the root's frame.
    pub(super) ground: f64,
    pub(super) notes: Vec<String>,
}

/// To whom a link belongs.
#[derive(Clone, Copy, Debug)]
enum Owner {
    Body(Option<usize>),
    Wheel(usize),
}

impl Parts {
    pub(super) fn from_tree(tree: &Tree) -> Result<Self, UrdfError> {
        let (shapes, casters) = wheels(tree)?;
        let carries = carriers(tree, |joint| shapes.contains_key(&joint));
        let mut parts = Self {
            chassis: Mass::default(),
            rockers: Vec::new(),
            wheels: Vec::new(),
            ground: f64::INFINITY,
            notes: casters
                .iter()
                .map(|name| {
                    format!(
                        "\"{name}\" swivels: a caster has no heading, and is left out as a wheel"
                    )
                })
                .collect(),
        };
        let knows_drives = shapes
            .keys()
            .any(|joint| tree.driven.contains(&tree.joints[*joint].name));
        let mut owners: Vec<Owner> = Vec::new();
        // how the wheels of a link steer that stands upright upon another
        let mut steering: Vec<Option<[f64; 2]>> = Vec::new();
        for (index, link) in tree.links.iter().enumerate() {
            let joint = link.joint.map(|joint| &tree.joints[joint]);
            let carrier = joint.map_or(Owner::Body(None), |joint| owners[joint.parent]);
            let turned = joint.and_then(|joint| steering[joint.parent]);
            let (owner, steers) = match (joint, carrier, link.joint) {
                (Some(joint), Owner::Body(on), Some(number)) => {
                    if let Some(shape) = shapes.get(&number) {
                        let free = knows_drives && !tree.driven.contains(&joint.name);
                        let mut wheel = wheel(tree, joint, *shape, (on, turned, free));
                        let rim = Rim {
                            centre: wheel.centre,
                            axle: tree.axis(joint),
                            radius: wheel.radius,
                            width: wheel.width.unwrap_or(0.0),
                        };
                        match lugs(tree, joint.child, &rim) {
                            Found::Lugs(found) => wheel.lugs = Some(found),
                            Found::Uneven(count) => parts.notes.push(format!(
                                "{count} boxes on the circumference of \"{}\" differ in height, thickness or spacing, and are not \
                                 converted to lugs",
                                joint.name
                            )),
                            Found::Nothing => {}
                        }
                        parts.wheels.push(wheel);
                        (Owner::Wheel(parts.wheels.len() - 1), None)
                    } else if turns_across(tree, joint) && carries[index] {
                        parts.rockers.push(rocker(tree, joint, on));
                        (Owner::Body(Some(parts.rockers.len() - 1)), turned)
                    } else {
                        (carrier, steers(tree, joint).or(turned))
                    }
                }
                _ => (carrier, turned),
            };
            owners.push(owner);
            steering.push(steers);
            if let Some(mass) = &link.mass {
                let mass = mass.seen_from(&link.frame);
                let into = match owner {
                    Owner::Body(None) => &mut parts.chassis,
                    Owner::Body(Some(rocker)) => &mut parts.rockers[rocker].mass,
                    Owner::Wheel(wheel) => &mut parts.wheels[wheel].mass,
                };
                *into = into.with(&mass);
            }
        }
        parts.finish(tree);
        Ok(parts)
    }

    fn finish(&mut self, tree: &Tree) {
        // in the order of the file
        self.wheels.sort_by_key(|wheel| {
            tree.joints
                .iter()
                .position(|joint| joint.name == wheel.joint)
        });
        for wheel in &mut self.wheels {
            let joint = tree.joints.iter().find(|joint| joint.name == wheel.joint);
            wheel.spin_inertia = joint.map_or(0.0, |joint| wheel.mass.about(tree.axis(joint)));
            self.ground = self.ground.min(wheel.centre[2] - wheel.radius);
        }
        for (index, name) in short_names(&self.wheels).into_iter().enumerate() {
            self.wheels[index].name = name;
        }
        self.say();
    }

    /// What a robot file cannot hold, or the URDF did not say.
    fn say(&mut self) {
        let mut say = |what: String| self.notes.push(what);
        if !(self.chassis.kilograms > 0.0) {
            say("no <inertial> of its body: [chassis] is left out, and `drive` needs it".into());
        } else if self.chassis.skewness() > 0.05 {
            say("the chassis' products of inertia are left out".into());
        }
        let list = |wheels: Vec<&str>| wheels.join(", ");
        let of = |is: fn(&Wheel) -> bool| -> Vec<&str> {
            self.wheels
                .iter()
                .filter(|wheel| is(wheel))
                .map(|wheel| wheel.name.as_str())
                .collect()
        };
        let spheres = of(|wheel| wheel.width.is_none());
        if !spheres.is_empty() {
            say(format!(
                "spheres have no width, which `drive` needs: {}",
                list(spheres)
            ));
        }
        let weightless = of(|wheel| !(wheel.mass.kilograms > 0.0));
        if !weightless.is_empty() {
            say(format!(
                "no <inertial>, so 0.5 kg is assumed: {}",
                list(weightless)
            ));
        }
        let high: Vec<&str> = self
            .wheels
            .iter()
            .filter(|wheel| wheel.centre[2] - wheel.radius - self.ground > 0.01)
            .map(|wheel| wheel.name.as_str())
            .collect();
        if !high.is_empty() {
            say(format!(
                "more than 1 cm above the plane of the lowest wheel: {}",
                list(high)
            ));
        }
        if self.wheels.iter().all(|wheel| wheel.lugs.is_none()) {
            say("no boxes are on a wheel's circumference: wheels with lugs need `grouser_height_m`, `grouser_count` and \
                 `grouser_thickness_m`".into());
        }
        say("a URDF has no motors and no encoders: add [[motor]], `motor`, `gear`, `ticks_per_turn`".into());
    }
}

/// Radius, width and centre (in the child's frame).
type Round = (f64, Option<f64>, Vector);

/// The joints that are wheels, and the names of those that are casters.
fn wheels(tree: &Tree) -> Result<(BTreeMap<usize, Round>, Vec<&str>), UrdfError> {
    let mut found = BTreeMap::new();
    let mut casters = Vec::new();
    let mut meshes = Vec::new();
    let mut turning = Vec::new();
    for (index, joint) in tree.joints.iter().enumerate() {
        if joint.kind != Kind::Continuous {
            continue;
        }
        turning.push(joint.name.clone());
        let axis = tree.axis(joint);
        if axis[2].abs() > MAX_AXLE_SINE {
            continue;
        }
        let link = &tree.links[joint.child];
        let round = link
            .shapes
            .iter()
            .filter_map(|(frame, shape)| match *shape {
                Shape::Cylinder { radius, length } => {
                    let along = link.frame.direction(frame.direction([0.0, 0.0, 1.0]));
                    (dot(along, axis).abs() > MIN_AXIS_COSINE).then_some((
                        radius,
                        Some(length),
                        frame.place,
                    ))
                }
                Shape::Sphere { radius } => Some((radius, None, frame.place)),
                _ => None,
            });
        if let Some(round) = round.max_by(|a, b| a.0.total_cmp(&b.0)) {
            if swivels(tree, joint.parent) {
                casters.push(joint.name.as_str());
            } else {
                found.insert(index, round);
            }
        } else if link.shapes.iter().any(|(_, shape)| *shape == Shape::Mesh)
            && !tree
                .joints
                .iter()
                .any(|other| other.parent == joint.child && other.kind != Kind::Rigid)
        {
            meshes.push((joint.name.clone(), link.name.clone()));
        }
    }
    if let Some((joint, link)) = meshes.into_iter().next() {
        return Err(UrdfError::MeshOnly { joint, link });
    }
    if found.is_empty() {
        return Err(UrdfError::NoWheels { turning });
    }
    Ok((found, casters))
}

/// Does a link hang on an upright joint that turns without end?
fn swivels(tree: &Tree, mut link: usize) -> bool {
    while let Some(joint) = tree.links[link].joint {
        let joint = &tree.joints[joint];
        if joint.kind == Kind::Continuous && tree.axis(joint)[2].abs() > MIN_AXIS_COSINE {
            return true;
        }
        link = joint.parent;
    }
    false
}

/// For each link: does a wheel hang on it?
fn carriers(tree: &Tree, is_wheel: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut carries = vec![false; tree.links.len()];
    // carriers stand before what they carry
    for (index, link) in tree.links.iter().enumerate().rev() {
        if let Some(joint) = link.joint
            && (is_wheel(joint) || carries[index])
        {
            carries[tree.joints[joint].parent] = true;
        }
    }
    carries
}

/// Does a joint turn about an axis across the robot?
fn turns_across(tree: &Tree, joint: &Joint) -> bool {
    joint.kind != Kind::Rigid && tree.axis(joint)[1].abs() > MIN_AXIS_COSINE
}

/// Range and rate of a joint that stands upright.
fn steers(tree: &Tree, joint: &Joint) -> Option<[f64; 2]> {
    let upright = joint.kind == Kind::Revolute && tree.axis(joint)[2].abs() > MIN_AXIS_COSINE;
    let [lower, upper, rate] = joint.limits.filter(|_| upright)?;
    Some([lower.abs().min(upper.abs()), rate])
}

fn wheel(
    tree: &Tree,
    joint: &Joint,
    (radius, width, centre): Round,
    (on, steering, free): (Option<usize>, Option<[f64; 2]>, bool),
) -> Wheel {
    let mut axle = tree.axis(joint);
    // turning about an axle to the left drives forwards: axle × up
    let mut heading = Real::atan2(-axle[0], axle[1]);
    let reversed = heading.abs() > std::f64::consts::FRAC_PI_2 + 1e-6;
    if reversed {
        axle = axle.map(|part| -part);
        heading = Real::atan2(-axle[0], axle[1]);
    }
    Wheel {
        name: String::new(),
        joint: joint.name.clone(),
        centre: tree.links[joint.child].frame.point(centre),
        heading,
        reversed,
        camber: Real::asin(-axle[2]),
        radius,
        width,
        lugs: None,
        free,
        mass: Mass::default(),
        spin_inertia: 0.0,
        on,
        steering,
    }
}

fn rocker(tree: &Tree, joint: &Joint, on: Option<usize>) -> Rocker {
    let opposite = joint.mimics.as_ref().and_then(|(other, factor)| {
        let other = tree.joints.iter().find(|joint| joint.name == *other)?;
        // angles count about each joint's own axis
        let same_way = dot(tree.axis(joint), tree.axis(other)) > 0.0;
        let against = if same_way { *factor } else { -factor };
        ((against + 1.0).abs() < 1e-6).then(|| tree.links[other.child].name.clone())
    });
    Rocker {
        name: tree.links[joint.child].name.clone(),
        on,
        pivot: tree.links[joint.child].frame.place,
        mass: Mass::default(),
        opposite,
        damping: joint.damping,
        range: joint
            .limits
            .filter(|_| joint.kind == Kind::Revolute)
            .map(|[lower, upper, _]| lower.abs().max(upper.abs())),
    }
}

/// Names without `wheel`, `joint` and `link`, where they stay different.
fn short_names(wheels: &[Wheel]) -> Vec<String> {
    let short = |name: &str| {
        let words = name
            .split('_')
            .filter(|word| !matches!(*word, "wheel" | "joint" | "link"));
        words.collect::<Vec<_>>().join("_")
    };
    let names: Vec<String> = wheels.iter().map(|wheel| short(&wheel.joint)).collect();
    let alike = names
        .iter()
        .enumerate()
        .any(|(i, name)| name.is_empty() || names[..i].contains(name));
    if alike {
        return wheels.iter().map(|wheel| wheel.joint.clone()).collect();
    }
    names
}
