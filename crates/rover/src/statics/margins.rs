//! How far a robot is from tipping over.

use grouser_real::Real;

use super::equations::{Equations, Tipping};
use crate::robot::RobotModel;
use crate::vector::Vector;

/// An edge over which the robot may tip: some wheels stay on the ground, the others lose their loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// The wheels that stay: of a rigid robot those at the ends of the edge.
    pub wheels: Vec<usize>,
    /// How much further the ground may tilt until the others carry nothing, rad.
    pub tip_over: f64,
    /// Where that is, for poses near this one.
    pub cone: TipOverCone,
    /// Distance of the plumb line through the centre of gravity from the edge, m: the work of the weight over the turning of the
    /// chassis about level axes. Infinite where only a link turns.
    pub horizontal: f64,
    /// How far the centre of gravity must rise to tip over the edge, m.
    pub vertical: f64,
}

/// Directions of gravity at one angle from an axis, in the robot's frame: those in which a rigid robot begins to tip over an
/// edge, and those of any robot near one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipOverCone {
    pub(super) axis: Vector,
    pub(super) opening: f64,
}

impl TipOverCone {
    /// The angle from `down` to the nearest of these directions, rad; negative beyond them.
    #[must_use]
    pub fn margin(&self, down: Vector) -> f64 {
        self.opening - Real::atan2(self.axis.cross(down).length(), self.axis.dot(down))
    }
}

/// The stability of a robot that stands on a plane.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StabilityMargins {
    /// Least distance of the plumb line from the edges of the support, m; negative: it falls.
    pub horizontal: f64,
    /// Least height by which the centre of gravity must be raised, m; 0 once it falls by itself.
    pub vertical: f64,
    /// The smallest further tilt of the ground, in any direction, at which no set of non-negative wheel loads balances the robot,
    /// rad; negative where it does not stand.
    pub tip_over: f64,
    /// Every edge of the support.
    pub edges: Vec<Edge>,
}

/// The margins of a robot on a plane tilted by `pitch` (nose up) and `roll` (left side up), both in rad, by the equations of
/// [`wheel_loads`](super::wheel_loads).
///
/// An edge is a motion that the ground allows and in which as many wheels as can stay on it. The tip-over angle is the one by
/// which gravity must turn until it does no work on that motion. For a rigid robot these are the sides of the convex hull of
/// its contacts. The energy (vertical) margin is that of Messuri & Klein, R (1 − cos angle) in the plane across the edge,
/// projected on the vertical.
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
    let equations = Equations::on_plane(model);
    margins_where(&equations, equations.down(pitch, roll))
}

/// The margins where gravity points `down`.
pub(super) fn margins_where(equations: &Equations, down: Vector) -> StabilityMargins {
    let edges: Vec<Edge> = equations.tippings(down).into_iter().map(edge).collect();
    let least = |of: fn(&Edge) -> f64| edges.iter().map(of).fold(f64::INFINITY, f64::min);
    StabilityMargins {
        horizontal: least(|edge| edge.horizontal),
        vertical: least(|edge| edge.vertical),
        tip_over: least(|edge| edge.tip_over),
        edges,
    }
}

fn edge(tipping: Tipping) -> Edge {
    let [arm, horizontal] = tipping.arms;
    let (tip_over, cone) = tipping.nearest;
    Edge {
        wheels: tipping.wheels,
        tip_over,
        cone,
        horizontal,
        vertical: if tip_over > 0.0 {
            arm * Real::tan(0.5 * tip_over)
        } else {
            0.0
        },
    }
}
