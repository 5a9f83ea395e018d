//! How far a robot is from tipping over.

use grouser_real::Real;

use super::loads::wheel_loads;
use crate::body::BodyState;
use crate::robot::RobotModel;
use crate::vector::{Attitude, Vector};

/// An edge over which the robot may tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// The wheels at its ends.
    pub wheels: [usize; 2],
    /// How much further the ground may tilt until the robot tips over this edge, rad.
    pub tip_over: f64,
    /// Distance of the plumb line through the centre of gravity from the edge, m.
    pub horizontal: f64,
    /// How far the centre of gravity must rise to tip over the edge, m.
    pub vertical: f64,
}

/// The stability of a robot that stands on a plane.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StabilityMargins {
    /// Least distance of the plumb line from the edges of the support, m; negative: it falls.
    pub horizontal: f64,
    /// Least height by which the centre of gravity must be raised, m; 0 once it falls by itself.
    pub vertical: f64,
    /// Least angle by which the ground may tilt further, rad.
    pub tip_over: f64,
    /// Every edge of the support, counter-clockwise from above.
    pub edges: Vec<Edge>,
}

/// The margins of a robot on a plane tilted by `pitch` (nose up) and `roll` (left side up), both in rad.
///
/// The support is the convex hull of the contacts of the wheels that carry something. For an edge along e through
/// p, with g the centre of gravity and d downwards: the tip-over angle is the one by which d must turn about e to
/// pass through the edge; the energy (vertical) margin after Messuri & Klein is R (1 − cos angle) in the plane
/// across the edge, projected on the vertical.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::stability_margins;
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// let (level, tilted) = (stability_margins(&model, 0.0, 0.0), stability_margins(&model, 0.0, 0.3));
/// assert!(level.tip_over > tilted.tip_over && tilted.vertical > 0.0);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[must_use]
pub fn stability_margins(model: &RobotModel, pitch: f64, roll: f64) -> StabilityMargins {
    let loads = wheel_loads(model, pitch, roll);
    let state = BodyState::at(Vector::ZERO, Attitude::LEVEL);
    let centre = model.linkage.centre(&model.linkage.pose(&state));
    let contact = |index: usize| {
        let mount = &model.wheels[index];
        mount.centre - Vector::AXES[2] * mount.wheel.radius()
    };
    let contacts: Vec<Vector> = (0..model.wheels.len()).map(contact).collect();
    let least = 1e-3 * model.weight();
    let up = Attitude::from_angles(roll, -pitch, 0.0).to_robot(Vector::AXES[2]);
    margins_about(&contacts, |wheel| loads.loads[wheel] > least, centre, up)
}

/// The margins of what stands on those of its `contacts` that carry something, with its centre of gravity at
/// `centre`; seen against `up`.
pub(super) fn margins_about(
    contacts: &[Vector],
    carries: impl Fn(usize) -> bool,
    centre: Vector,
    up: Vector,
) -> StabilityMargins {
    let standing: Vec<usize> = (0..contacts.len())
        .filter(|index| carries(*index))
        .collect();
    let hull = hull(&standing, |index| contacts[index]);
    let edges: Vec<Edge> = (0..hull.len())
        .map(|i| {
            let wheels = [hull[i], hull[(i + 1) % hull.len()]];
            edge(wheels, wheels.map(|wheel| contacts[wheel]), centre, up)
        })
        .collect();
    let least = |of: fn(&Edge) -> f64| edges.iter().map(of).fold(f64::INFINITY, f64::min);
    StabilityMargins {
        horizontal: least(|edge| edge.horizontal),
        vertical: least(|edge| edge.vertical),
        tip_over: least(|edge| edge.tip_over),
        edges,
    }
}

fn edge(wheels: [usize; 2], [from, to]: [Vector; 2], centre: Vector, up: Vector) -> Edge {
    let along = (to - from).unit();
    // the centre of gravity and the vertical, both across the edge
    let across = |v: Vector| v - along * v.dot(along);
    let arm = across(centre - from);
    let upright = across(up);
    let inwards = upright.cross(along);
    let tip_over = Real::atan2(arm.dot(inwards.unit()), arm.dot(upright.unit()));
    let rise = if tip_over > 0.0 {
        arm.length() * (1.0 - Real::cos(tip_over)) * upright.length()
    } else {
        0.0
    };
    // on the horizontal plane: how far the plumb line passes from the edge
    let level = along - up * along.dot(up);
    let sideways = up.cross(level.unit());
    Edge {
        wheels,
        tip_over,
        horizontal: (centre - from).dot(sideways),
        vertical: rise,
    }
}

/// Andrew's monotone chain, counter-clockwise.
fn hull(wheels: &[usize], at: impl Fn(usize) -> Vector) -> Vec<usize> {
    let mut sorted = wheels.to_vec();
    sorted.sort_by(|a, b| {
        let (a, b) = (at(*a), at(*b));
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
    });
    if sorted.len() < 3 {
        return sorted;
    }
    let turns = |a: usize, b: usize, c: usize| {
        let (u, v) = (at(b) - at(a), at(c) - at(a));
        u.x * v.y - u.y * v.x
    };
    let half = |points: &mut dyn Iterator<Item = usize>| {
        let mut chain: Vec<usize> = Vec::new();
        for point in points {
            while chain.len() >= 2
                && turns(chain[chain.len() - 2], chain[chain.len() - 1], point) <= 1e-12
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut out = half(&mut sorted.iter().copied());
    out.extend(half(&mut sorted.iter().rev().copied()));
    out
}
