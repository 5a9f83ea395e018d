//! Links and joints as the file has them, in one tree.

use grouser_terra::OutOfRange;
use std::collections::BTreeMap;

use roxmltree::{Document, Node, ParsingOptions};

use super::error::UrdfError;
use super::frame::{Frame, Vector, dot, scaled};
use super::mass::Mass;
use crate::suggestion::nearest;

type Result<T> = std::result::Result<T, UrdfError>;

/// Elements and attributes at most: a robot has some hundreds.
const MAX_NODES: u32 = 50_000;
const ANY: (f64, f64) = (-1e6, 1e6);
const NOT_NEGATIVE: (f64, f64) = (0.0, 1e6);
const LENGTH: (f64, f64) = (1e-6, 1e3);
/// Numbers that may be infinite, but no NaN.
const EVERY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// A limit of this many rad or rad/s is none: exporters write `inf`, 1e16 (SDF's "no limit") or the largest number.
const NO_LIMIT: f64 = 1e9;

/// A shape of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// Its axis is z of its frame.
    Cylinder {
        radius: f64,
        length: f64,
    },
    Sphere {
        radius: f64,
    },
    Mesh,
    Other,
}

/// A link.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub(super) name: String,
    pub(super) mass: Option<Mass>,
    /// Collision shapes, else what is seen.
    pub(super) shapes: Vec<(Frame, Shape)>,
    /// Boxes by their edges in m: those that collide, else those that are seen.
    pub(super) boxes: Vec<(Frame, Vector)>,
    /// In the root's frame with all joints at 0.
    pub(super) frame: Frame,
    /// The joint that carries it.
    pub(super) joint: Option<usize>,
}

/// What a joint allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Continuous,
    Revolute,
    Rigid,
}

/// A joint.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    pub(super) name: String,
    pub(super) kind: Kind,
    pub(super) parent: usize,
    pub(super) child: usize,
    /// Of the joint's own frame, of unit length.
    axis: Vector,
    origin: Frame,
    /// Lower and upper limit, rad, and maximum rate, rad/s.
    pub(super) limits: Option<[f64; 3]>,
    /// N m s/rad.
    pub(super) damping: f64,
    /// The joint that it follows, and the factor.
    pub(super) mimics: Option<(String, f64)>,
}

/// A robot.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) name: String,
    /// A link stands after the one that carries it.
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<Joint>,
    /// The joints that something drives.
    pub(super) driven: Vec<String>,
}

impl Tree {
    /// The joint's axis in the root's frame.
    pub(super) fn axis(&self, joint: &Joint) -> Vector {
        self.links[joint.child].frame.direction(joint.axis)
    }

    pub(super) fn parse(text: &str) -> Result<Self> {
        let options = ParsingOptions {
            nodes_limit: MAX_NODES,
            ..ParsingOptions::default()
        };
        let document = Document::parse_with_options(text, options).map_err(|error| {
            let at = error.pos();
            UrdfError::Xml {
                line: at.row,
                column: at.col,
                message: error.to_string(),
            }
        })?;
        let robot = document.root_element();
        refuse_macros(&document)?;
        if robot.tag_name().name() != "robot" {
            return Err(UrdfError::NotARobot {
                found: robot.tag_name().name().to_owned(),
            });
        }
        let links = read_links(robot)?;
        let joints = read_joints(robot, &links)?;
        let name = robot.attribute("name").unwrap_or("robot").to_owned();
        let mut tree = in_order(name, &links, joints)?;
        tree.driven = driven(robot);
        Ok(tree)
    }
}

fn line(node: Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

fn refuse_macros(document: &Document<'_>) -> Result<()> {
    for node in document.descendants().filter(Node::is_element) {
        let of_xacro = |space: &str| space.contains("xacro");
        // within `$(optenv …)` and its like there may be another variable, which is none of xacro's
        let is_macro = |text: &str| text.contains("${") && !text.trim_start().starts_with("$(");
        let value = node.attributes().find(|a| is_macro(a.value()));
        let name = node.tag_name();
        let what = if name.namespace().is_some_and(of_xacro) {
            format!("<xacro:{}>", name.name())
        } else if let Some(value) = value {
            let shown: String = value.value().chars().take(40).collect();
            format!("`{shown}`")
        } else {
            continue;
        };
        return Err(UrdfError::Xacro {
            line: line(node),
            what,
        });
    }
    Ok(())
}

fn children<'a, 'input: 'a>(
    node: Node<'a, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children()
        .filter(move |child| child.has_tag_name(name))
}

fn child<'a, 'input: 'a>(node: Node<'a, 'input>, name: &'static str) -> Option<Node<'a, 'input>> {
    children(node, name).next()
}

fn named<'a>(node: Node<'a, '_>) -> Result<&'a str> {
    let name = node.attribute("name").filter(|name| !name.is_empty());
    name.ok_or_else(|| missing(node, "a name"))
}

fn missing(node: Node<'_, '_>, what: &'static str) -> UrdfError {
    UrdfError::Missing {
        line: line(node),
        element: node.tag_name().name().to_owned(),
        what,
    }
}

/// The numbers of an attribute, each within its limits; `None` without the attribute.
fn numbers<const N: usize>(
    node: Node<'_, '_>,
    attribute: &'static str,
    (low, high): (f64, f64),
    unit: &'static str,
) -> Result<Option<[f64; N]>> {
    let Some(text) = node.attribute(attribute) else {
        return Ok(None);
    };
    let element = || node.tag_name().name().to_owned();
    let values: Option<Vec<f64>> = text
        .split_ascii_whitespace()
        .map(|word| word.parse().ok())
        .collect();
    let Some(values) = values.and_then(|values| <[f64; N]>::try_from(values).ok()) else {
        let (line, element) = (line(node), element());
        let shown = text.chars().take(60).collect();
        return Err(if text.contains("$(") {
            UrdfError::Substitution {
                line,
                element,
                attribute,
                text: shown,
            }
        } else {
            UrdfError::Number {
                line,
                element,
                attribute,
                text: shown,
                count: N,
            }
        });
    };
    for value in values {
        let field = format!("{attribute} of <{}>", element());
        OutOfRange::check(field, value, (low, high), unit).map_err(|range| {
            let line = line(node);
            UrdfError::OutOfRange { line, range }
        })?;
    }
    Ok(Some(values))
}

fn number(
    node: Node<'_, '_>,
    attribute: &'static str,
    limits: (f64, f64),
    unit: &'static str,
) -> Result<f64> {
    let found = numbers::<1>(node, attribute, limits, unit)?;
    found
        .map(|[value]| value)
        .ok_or_else(|| missing(node, attribute))
}

fn origin(node: Node<'_, '_>) -> Result<Frame> {
    let Some(origin) = child(node, "origin") else {
        return Ok(Frame::IDENTITY);
    };
    let place = numbers(origin, "xyz", ANY, "m")?.unwrap_or_default();
    let turns = numbers(origin, "rpy", ANY, "rad")?.unwrap_or_default();
    Ok(Frame::new(place, turns))
}

fn read_links(robot: Node<'_, '_>) -> Result<Vec<Link>> {
    let mut links: Vec<Link> = Vec::new();
    for node in children(robot, "link") {
        let name = named(node)?.to_owned();
        if links.iter().any(|link| link.name == name) {
            return Err(UrdfError::Twice {
                line: line(node),
                element: "link",
                name,
            });
        }
        let shapes = |kind| -> Result<Vec<_>> { children(node, kind).map(shape).collect() };
        let (touched, seen) = (shapes("collision")?, shapes("visual")?);
        let is_round = |(_, shape): &(Frame, Shape)| !matches!(shape, Shape::Mesh | Shape::Other);
        // a wheel that collides as a mesh may be drawn as a cylinder
        let use_seen =
            touched.is_empty() || (!touched.iter().any(is_round) && seen.iter().any(is_round));
        let boxes = |kind| -> Result<Vec<_>> {
            let found = children(node, kind).map(edges).collect::<Result<Vec<_>>>();
            Ok(found?.into_iter().flatten().collect())
        };
        let touched_boxes = boxes("collision")?;
        let boxes = if touched_boxes.is_empty() {
            boxes("visual")?
        } else {
            touched_boxes
        };
        links.push(Link {
            name,
            boxes,
            mass: child(node, "inertial").map(read_mass).transpose()?,
            shapes: if use_seen { seen } else { touched },
            frame: Frame::IDENTITY,
            joint: None,
        });
    }
    Ok(links)
}

fn shape(node: Node<'_, '_>) -> Result<(Frame, Shape)> {
    let frame = origin(node)?;
    let Some(geometry) = child(node, "geometry") else {
        return Ok((frame, Shape::Other));
    };
    let shape = if let Some(cylinder) = child(geometry, "cylinder") {
        Shape::Cylinder {
            radius: number(cylinder, "radius", LENGTH, "m")?,
            length: number(cylinder, "length", LENGTH, "m")?,
        }
    } else if let Some(sphere) = child(geometry, "sphere") {
        Shape::Sphere {
            radius: number(sphere, "radius", LENGTH, "m")?,
        }
    } else if child(geometry, "mesh").is_some() {
        Shape::Mesh
    } else {
        Shape::Other
    };
    Ok((frame, shape))
}

/// The edges of a box, m; `None` of another shape.
fn edges(node: Node<'_, '_>) -> Result<Option<(Frame, Vector)>> {
    let solid = child(node, "geometry").and_then(|geometry| child(geometry, "box"));
    let Some(solid) = solid else {
        return Ok(None);
    };
    let edges = numbers(solid, "size", LENGTH, "m")?;
    let frame = origin(node)?;
    Ok(edges.map(|edges| (frame, edges)))
}

fn read_mass(node: Node<'_, '_>) -> Result<Mass> {
    let mass = child(node, "mass").ok_or_else(|| missing(node, "its <mass>"))?;
    let mass = number(mass, "value", NOT_NEGATIVE, "kg")?;
    let mut inertia = [[0.0; 3]; 3];
    if let Some(node) = child(node, "inertia") {
        for (attribute, i, j) in [
            ("ixx", 0, 0),
            ("iyy", 1, 1),
            ("izz", 2, 2),
            ("ixy", 0, 1),
            ("ixz", 0, 2),
            ("iyz", 1, 2),
        ] {
            let limits = if i == j { NOT_NEGATIVE } else { ANY };
            let [value] = numbers(node, attribute, limits, "kg m^2")?.unwrap_or_default();
            inertia[i][j] = value;
            inertia[j][i] = value;
        }
    }
    let own = Mass {
        kilograms: mass,
        centre: [0.0; 3],
        inertia,
    };
    Ok(own.seen_from(&origin(node)?))
}

fn read_joints(robot: Node<'_, '_>, links: &[Link]) -> Result<Vec<Joint>> {
    let mut joints: Vec<Joint> = Vec::new();
    for node in children(robot, "joint") {
        let name = named(node)?.to_owned();
        if joints.iter().any(|joint| joint.name == name) {
            return Err(UrdfError::Twice {
                line: line(node),
                element: "joint",
                name,
            });
        }
        let end = |which, what| {
            let end = child(node, which).ok_or_else(|| missing(node, what))?;
            let link = end
                .attribute("link")
                .ok_or_else(|| missing(end, "its link"))?;
            let place = links.iter().position(|other| other.name == link);
            place.ok_or_else(|| UrdfError::UnknownLink {
                joint: name.clone(),
                link: link.to_owned(),
                meant: nearest(link, links.iter().map(|other| other.name.as_str())).map(Into::into),
            })
        };
        let (parent, carried) = (end("parent", "its <parent>")?, end("child", "its <child>")?);
        let axis = match child(node, "axis") {
            Some(axis) => numbers(axis, "xyz", ANY, "1")?.unwrap_or([1.0, 0.0, 0.0]),
            None => [1.0, 0.0, 0.0],
        };
        let length = dot(axis, axis).sqrt();
        let limits = match child(node, "limit") {
            None => None,
            Some(limit) => {
                let one = |attribute, unit| {
                    Ok::<_, UrdfError>(
                        numbers::<1>(limit, attribute, EVERY, unit)?.unwrap_or_default()[0],
                    )
                };
                let rate = one("velocity", "rad/s")?;
                Some([
                    one("lower", "rad")?,
                    one("upper", "rad")?,
                    // without a limit the rate is not known, as without the attribute
                    if rate.abs() < NO_LIMIT { rate } else { 0.0 },
                ])
            }
        };
        let is_endless = limits
            .is_some_and(|[lower, upper, _]: [f64; 3]| lower <= -NO_LIMIT && upper >= NO_LIMIT);
        let kind = match node.attribute("type") {
            Some("revolute") if !is_endless => Kind::Revolute,
            Some("continuous" | "revolute") => Kind::Continuous,
            Some(_) => Kind::Rigid,
            None => return Err(missing(node, "its type")),
        };
        let damping = match child(node, "dynamics") {
            None => 0.0,
            Some(dynamics) => {
                numbers::<1>(dynamics, "damping", NOT_NEGATIVE, "N m s/rad")?.unwrap_or_default()[0]
            }
        };
        let mimics = match child(node, "mimic") {
            None => None,
            Some(mimic) => {
                let [factor] = numbers(mimic, "multiplier", ANY, "1")?.unwrap_or([1.0]);
                let joint = mimic
                    .attribute("joint")
                    .ok_or_else(|| missing(mimic, "its joint"))?;
                Some((joint.to_owned(), factor))
            }
        };
        joints.push(Joint {
            name,
            kind,
            parent,
            child: carried,
            axis: if length > 0.0 {
                scaled(axis, 1.0 / length)
            } else {
                [1.0, 0.0, 0.0]
            },
            origin: origin(node)?,
            limits,
            damping,
            mimics,
        });
    }
    Ok(joints)
}

/// Joints named by transmissions and by `ros2_control` with a command.
fn driven(robot: Node<'_, '_>) -> Vec<String> {
    let of = children(robot, "transmission").chain(children(robot, "ros2_control"));
    of.flat_map(|node| children(node, "joint"))
        .filter(|joint| {
            joint
                .parent()
                .is_some_and(|p| p.has_tag_name("transmission"))
                || child(*joint, "command_interface").is_some()
        })
        .filter_map(|joint| joint.attribute("name"))
        .map(str::to_owned)
        .collect()
}

/// One tree, carriers first.
fn in_order(name: String, links: &[Link], joints: Vec<Joint>) -> Result<Tree> {
    let no_tree = |what: String| Err(UrdfError::NoTree { what });
    let mut carried_by: BTreeMap<usize, usize> = BTreeMap::new();
    for (index, joint) in joints.iter().enumerate() {
        if carried_by.insert(joint.child, index).is_some() {
            return no_tree(format!(
                "two joints carry the link \"{}\"",
                links[joint.child].name
            ));
        }
    }
    let roots: Vec<usize> = (0..links.len())
        .filter(|link| !carried_by.contains_key(link))
        .collect();
    let [root] = roots.as_slice() else {
        let names: Vec<&str> = roots
            .iter()
            .take(5)
            .map(|root| links[*root].name.as_str())
            .collect();
        return no_tree(match names.as_slice() {
            [] if links.is_empty() => "there is no link".into(),
            [] => "every link is carried by another".into(),
            names => format!("no joint carries any of {}", names.join(", ")),
        });
    };
    // breadth first; what is not reached hangs in a loop of its own
    let mut place = vec![None; links.len()];
    let mut order = vec![*root];
    place[*root] = Some(0);
    let mut next = 0;
    while let Some(&at) = order.get(next) {
        for joint in joints.iter().filter(|joint| joint.parent == at) {
            place[joint.child] = Some(order.len());
            order.push(joint.child);
        }
        next += 1;
    }
    if let Some(lost) = place.iter().position(Option::is_none) {
        return no_tree(format!("the link \"{}\" hangs in a loop", links[lost].name));
    }
    let to_new = |old: usize| place[old].unwrap_or(0);
    let joints: Vec<Joint> = joints
        .into_iter()
        .map(|joint| Joint {
            parent: to_new(joint.parent),
            child: to_new(joint.child),
            ..joint
        })
        .collect();
    let mut sorted: Vec<Link> = order.iter().map(|old| links[*old].clone()).collect();
    for index in 1..sorted.len() {
        let joint = joints.iter().position(|joint| joint.child == index);
        if let Some(joint) = joint {
            let frame = sorted[joints[joint].parent]
                .frame
                .then(&joints[joint].origin);
            sorted[index].frame = frame;
            sorted[index].joint = Some(joint);
        }
    }
    Ok(Tree {
        name,
        links: sorted,
        joints,
        driven: Vec::new(),
    })
}
