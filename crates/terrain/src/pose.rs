//! How a robot stands on the relief: the plane under its wheels.

use std::collections::BTreeMap;

use grouser_rover::ground::HeightMap;
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::wheel_loads;

use crate::headings::Headings;

/// The slopes under a robot that stands in the middle of a cell, for one heading: sums over the heights of the cells
/// around it.
///
/// The plane is the one of least squares through the ground under the wheels (bilinear between the cells), each weighted
/// with its load on the level, so that a light wheel on an arm does not tilt the chassis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Footprint {
    /// Rows down and columns to the right, and the weights of that height in the slopes ahead and to the left, per m.
    terms: Vec<([i64; 2], [f64; 2])>,
}

/// Pitch and roll of a robot on the relief.
///
/// Sign: pitch with the nose up, roll with the left side up is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePose {
    /// rad.
    pub pitch: f64,
    /// rad.
    pub roll: f64,
}

impl SurfacePose {
    /// The pose on a plane that rises by `ahead` and `left` metres per metre.
    ///
    /// ```
    /// let pose = grouser_terrain::SurfacePose::on_plane(0.2, 0.0);
    /// assert!((pose.pitch - 0.2_f64.atan()).abs() < 1e-15 && pose.roll == 0.0);
    /// ```
    #[must_use]
    pub fn on_plane(ahead: f64, left: f64) -> Self {
        // the robot's x axis is (1, 0, ahead); its y axis the cross product of the normal (−ahead, −left, 1) and x
        let normal = (1.0 + ahead * ahead + left * left).sqrt();
        Self {
            pitch: ahead.atan(),
            roll: (left / normal).asin(),
        }
    }
}

impl Footprint {
    /// One for each heading, on cells of `cell` (m).
    pub(crate) fn all(model: &RobotModel, headings: Headings, cell: f64) -> Vec<Self> {
        (0..headings.count())
            .map(|heading| Self::new(model, headings.angle(heading), cell))
            .collect()
    }

    fn new(model: &RobotModel, heading: f64, cell: f64) -> Self {
        let loads = wheel_loads(model, 0.0, 0.0).loads;
        let wheels: Vec<([f64; 2], f64)> = model
            .wheels
            .iter()
            .zip(&loads)
            .map(|(mount, load)| ([mount.centre.x, mount.centre.y], load.max(0.0)))
            .collect();
        let slopes = plane_weights(&wheels);
        let (sin, cos) = heading.sin_cos();
        let mut terms: BTreeMap<[i64; 2], [f64; 2]> = BTreeMap::new();
        for (([x, y], _), [ahead, left]) in wheels.iter().zip(slopes) {
            // to the right and down, in cells
            let right = (x * cos - y * sin) / cell;
            let down = -(x * sin + y * cos) / cell;
            #[allow(
                clippy::cast_possible_truncation,
                reason = "a robot is at most some thousand cells long; the cast saturates"
            )]
            let (column, row) = (right.floor() as i64, down.floor() as i64);
            let (u, v) = (right - right.floor(), down - down.floor());
            for (offset, share) in [
                ([row, column], (1.0 - u) * (1.0 - v)),
                ([row, column + 1], u * (1.0 - v)),
                ([row + 1, column], (1.0 - u) * v),
                ([row + 1, column + 1], u * v),
            ] {
                if share > 1e-12 {
                    let term = terms.entry(offset).or_insert([0.0; 2]);
                    term[0] += share * ahead;
                    term[1] += share * left;
                }
            }
        }
        Self {
            terms: terms.into_iter().collect(),
        }
    }

    /// How many cells it reaches in any direction.
    pub(crate) fn reach(&self) -> i64 {
        let offsets = self.terms.iter().flat_map(|(offset, _)| offset);
        offsets.map(|offset| offset.abs()).max().unwrap_or(0)
    }

    /// The cells under the wheels, as offsets in rows down and columns to the right.
    pub(crate) fn cells(&self) -> impl Iterator<Item = [i64; 2]> + '_ {
        self.terms.iter().map(|(offset, _)| *offset)
    }

    /// The pose by the heights around, as offsets in rows and columns; `None` where one is unknown.
    pub(crate) fn pose(&self, height: impl Fn(i64, i64) -> Option<f32>) -> Option<SurfacePose> {
        let own = f64::from(height(0, 0)?);
        let (mut ahead, mut left) = (0.0, 0.0);
        for ([down, right], [a, l]) in &self.terms {
            let rise = f64::from(height(*down, *right)?) - own;
            ahead += a * rise;
            left += l * rise;
        }
        // heights are finite or unknown; beyond 1e30 their sum may be neither
        (ahead.is_finite() && left.is_finite()).then(|| SurfacePose::on_plane(ahead, left))
    }
}

/// The wheels of a robot that stands anywhere, at any heading: the same plane as a [`Footprint`]'s.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WheelPlane {
    /// Where each wheel is beside the robot's middle, m.
    wheels: Vec<[f64; 2]>,
    /// Weights of the height under each in the slopes ahead and to the left, per m.
    slopes: Vec<[f64; 2]>,
}

impl WheelPlane {
    pub(crate) fn new(model: &RobotModel) -> Self {
        let loads = wheel_loads(model, 0.0, 0.0).loads;
        let mounts = model.wheels.iter().zip(&loads);
        let wheels: Vec<_> = mounts
            .map(|(mount, load)| ([mount.centre.x, mount.centre.y], load.max(0.0)))
            .collect();
        Self {
            slopes: plane_weights(&wheels),
            wheels: wheels.into_iter().map(|(at, _)| at).collect(),
        }
    }

    /// How far the foremost wheel is ahead of the middle, m.
    pub(crate) fn front(&self) -> f64 {
        self.wheels.iter().map(|at| at[0]).fold(0.0, f64::max)
    }

    /// The places of the wheels of a robot at (x, y) with a heading (rad), m.
    pub(crate) fn places(
        &self,
        (x, y): (f64, f64),
        heading: f64,
    ) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (sin, cos) = heading.sin_cos();
        self.wheels
            .iter()
            .map(move |[ahead, left]| (x + ahead * cos - left * sin, y + ahead * sin + left * cos))
    }

    /// The pose on the relief; `None` where a wheel stands on unknown ground.
    pub(crate) fn pose(
        &self,
        relief: &HeightMap,
        place: (f64, f64),
        heading: f64,
    ) -> Option<SurfacePose> {
        let (mut ahead, mut left) = (0.0, 0.0);
        for ((x, y), [a, l]) in self.places(place, heading).zip(&self.slopes) {
            if !relief.known(x, y) {
                return None;
            }
            let height = relief.height(x, y);
            ahead += a * height;
            left += l * height;
        }
        Some(SurfacePose::on_plane(ahead, left))
    }
}

/// Weights of the heights under the wheels in the slopes of the plane of weighted least squares, per m.
fn plane_weights(wheels: &[([f64; 2], f64)]) -> Vec<[f64; 2]> {
    let total: f64 = wheels.iter().map(|(_, load)| load).sum();
    let mean =
        [0, 1].map(|axis| wheels.iter().map(|(at, load)| at[axis] * load).sum::<f64>() / total);
    let moment = |i: usize, j: usize| -> f64 {
        wheels
            .iter()
            .map(|(at, load)| load * (at[i] - mean[i]) * (at[j] - mean[j]))
            .sum()
    };
    let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
    let determinant = xx * yy - xy * xy;
    wheels
        .iter()
        .map(|(at, load)| {
            let (x, y) = (load * (at[0] - mean[0]), load * (at[1] - mean[1]));
            [
                (yy * x - xy * y) / determinant,
                (xx * y - xy * x) / determinant,
            ]
        })
        .collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn on_an_inclined_plane_every_heading_has_the_plane_s_own_pitch_and_roll() {
        for robot in ["five-wheel", "skid-steer", "rocker-bogie"] {
            let file = format!(
                "{}/../../examples/robots/{robot}.toml",
                env!("CARGO_MANIFEST_DIR")
            );
            let model = RobotModel::read(file.as_ref()).unwrap();
            // z = 0.2 x − 0.1 y, rows run downwards
            for cell in [0.05, 1.0] {
                let headings = Headings::new(16).unwrap();
                for (index, footprint) in Footprint::all(&model, headings, cell).iter().enumerate()
                {
                    let height = |down: i64, right: i64| {
                        #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
                        let height = (cell * (0.2 * right as f64 + 0.1 * down as f64)) as f32;
                        Some(height)
                    };
                    let (sin, cos) = headings.angle(index).sin_cos();
                    let pose = footprint.pose(height).unwrap();
                    let expected =
                        SurfacePose::on_plane(0.2 * cos - 0.1 * sin, -0.2 * sin - 0.1 * cos);
                    assert!((pose.pitch - expected.pitch).abs() < 1e-5, "{pose:?}");
                    assert!((pose.roll - expected.roll).abs() < 1e-5, "{pose:?}");
                }
            }
        }
    }

    #[test]
    fn unknown_ground_under_one_wheel_is_unknown() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../examples/robots/skid-steer.toml"
        );
        let model = RobotModel::read(file.as_ref()).unwrap();
        let footprint = &Footprint::all(&model, Headings::new(4).unwrap(), 0.1)[0];
        let reach = footprint.reach();
        assert!(reach >= 2);
        let known = |_: i64, _: i64| Some(1.0);
        assert!(footprint.pose(known).is_some());
        let hole = |down: i64, right: i64| {
            let is_hole = down.abs() == reach || right.abs() == reach;
            (!is_hole).then_some(1.0)
        };
        assert_eq!(footprint.pose(hole), None);
    }
}
