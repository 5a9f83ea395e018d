//! Lugs out of a URDF: boxes that stand evenly around the rim of a wheel.

use std::f64::consts::TAU;

use grouser_real::Real;

use super::frame::{Frame, Vector, add, dot, scaled};
use super::tree::{Kind, Tree};

/// An edge of a box lies along a direction to this cosine (8°).
const MIN_EDGE_COSINE: f64 = 0.99;
/// A lug reaches over this share of the wheel's width at least; what is narrower is a bolt or a spoke.
const MIN_WIDTH_SHARE: f64 = 0.5;
/// Lugs and their spacings are equal to this share: a length rounded to a
/// millimetre is off by 5 % of a lug of 10 mm at most.
const SAME_SIZE_SHARE: f64 = 0.05;
/// Fewer boxes are no lugs.
const MIN_COUNT: usize = 3;

/// The lugs of a wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lugs {
    /// Height above the rim, m.
    pub(super) height: f64,
    pub(super) count: usize,
    /// Along the rim, m.
    pub(super) thickness: f64,
}

/// A wheel, in the root's frame: its centre and its axle's direction (of length 1), radius and width in m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rim {
    pub(super) centre: Vector,
    pub(super) axle: Vector,
    pub(super) radius: f64,
    pub(super) width: f64,
}

/// What was found on a rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Found {
    Nothing,
    Lugs(Lugs),
    /// Boxes stand on the rim, but differ in height, thickness or spacing.
    Uneven(usize),
}

/// A box on the rim: how far it reaches from the axle and along the rim, m, and where, rad.
#[derive(Clone, Copy, Debug)]
struct Bar {
    tip: f64,
    thickness: f64,
    place: f64,
}

/// The lugs among the boxes of the link `wheel` and of what is fixed to it.
pub(super) fn lugs(tree: &Tree, wheel: usize, rim: &Rim) -> Found {
    let across = perpendicular(rim.axle);
    let basis = [across, cross(rim.axle, across)];
    let mut bars: Vec<Bar> = (0..tree.links.len())
        .filter(|link| is_fixed_to(tree, *link, wheel))
        .flat_map(|link| {
            let link = &tree.links[link];
            link.boxes
                .iter()
                .filter_map(|(frame, edges)| bar(&link.frame.then(frame), *edges, rim, &basis))
        })
        .collect();
    if bars.len() < MIN_COUNT {
        return Found::Nothing;
    }
    bars.sort_by(|a, b| a.place.total_cmp(&b.place));
    let spacing = TAU / bars.len() as f64;
    let first = bars[0];
    let alike = |a: f64, b: f64| (a - b).abs() <= SAME_SIZE_SHARE * b.abs();
    let even = bars.iter().enumerate().all(|(index, bar)| {
        let next = bars[(index + 1) % bars.len()].place;
        let gap = (next - bar.place).rem_euclid(TAU);
        alike(gap, spacing)
            && alike(bar.tip - rim.radius, first.tip - rim.radius)
            && alike(bar.thickness, first.thickness)
    });
    if !even {
        return Found::Uneven(bars.len());
    }
    Found::Lugs(Lugs {
        height: first.tip - rim.radius,
        count: bars.len(),
        thickness: first.thickness,
    })
}

/// Does `link` move with the link `wheel`?
fn is_fixed_to(tree: &Tree, mut link: usize, wheel: usize) -> bool {
    loop {
        if link == wheel {
            return true;
        }
        match tree.links[link].joint.map(|joint| &tree.joints[joint]) {
            Some(joint) if joint.kind == Kind::Rigid => link = joint.parent,
            _ => return false,
        }
    }
}

/// A box as a bar on the rim; `None` where it is none.
fn bar(frame: &Frame, edges: Vector, rim: &Rim, basis: &[Vector; 2]) -> Option<Bar> {
    let from_centre = add(frame.place, scaled(rim.centre, -1.0));
    let [x, y] = [dot(from_centre, basis[0]), dot(from_centre, basis[1])];
    let distance = Real::hypot(x, y);
    if !(distance > 0.0) {
        return None;
    }
    let outwards = add(
        scaled(basis[0], x / distance),
        scaled(basis[1], y / distance),
    );
    let mut unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        .map(|edge| frame.direction(edge))
        .into_iter();
    let directions = [unit.next()?, unit.next()?, unit.next()?];
    let along = |direction: Vector| {
        directions
            .iter()
            .position(|edge| dot(*edge, direction).abs() > MIN_EDGE_COSINE)
    };
    let (width, height) = (along(rim.axle)?, along(outwards)?);
    let thickness = 3 - width - height;
    let (foot, tip) = (
        distance - 0.5 * edges[height],
        distance + 0.5 * edges[height],
    );
    let is_bar = foot <= rim.radius * (1.0 + SAME_SIZE_SHARE)
        && tip > rim.radius
        && edges[width] >= MIN_WIDTH_SHARE * rim.width;
    is_bar.then_some(Bar {
        tip,
        thickness: edges[thickness],
        place: Real::atan2(y, x),
    })
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// A direction of length 1 across `axis`.
fn perpendicular(axis: Vector) -> Vector {
    let other = if axis[0].abs() < 0.9 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    let across = cross(axis, other);
    scaled(across, 1.0 / dot(across, across).sqrt())
}
