//! The mounting of an IMU: the directions of its own frame that point forwards, to the left and up.
//!
//! The yaw rate needs only the last, Ω = u · ω. It follows from the static transforms between the robot's base and the
//! IMU's frame, or from gravity, which an accelerometer at rest measures upwards. The forward axis follows from
//! transforms, or from the robot file.

use grouser_real::Real;

use super::frames::{MAX_CHAIN, Tree, is_base, plain};

/// Standard gravity, m/s².
const GRAVITY_M_PER_S2: f64 = 9.806_65;
/// A mean acceleration that differs from gravity by more than this share has no direction: the robot accelerates.
const MAX_GRAVITY_ERROR: f64 = 0.15;
/// An up this near to an axis is that axis, cos 20°: IMUs are mounted square, but ground is not level.
const SQUARE_COS: f64 = 0.94;
/// Transforms and gravity that are further apart than this contradict each other, cos 30°.
const AGREE_COS: f64 = 0.866;
/// A forward axis that rises by more than this (sine) is not level.
const MAX_LEVEL_SIN: f64 = 0.17;
/// Is a frame the child of a transform, or the robot's base?
pub(super) fn has_frame(tree: &Tree, frame: &str) -> bool {
    tree.get(plain(frame)).is_some() || is_base(plain(frame))
}

/// The directions in `frame` that point forwards, to the left and up by the transforms; `None` where they do not
/// lead from it to the robot's base.
pub(super) fn axes_by_transforms(tree: &Tree, frame: &str) -> Option<[[f64; 3]; 3]> {
    let mut frame = plain(frame);
    let mut rotations = Vec::new();
    while !is_base(frame) {
        let link = tree.get(frame)?;
        rotations.push(link.rotation);
        if rotations.len() > MAX_CHAIN {
            return None;
        }
        frame = &link.parent;
    }
    let mut axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for rotation in rotations.into_iter().rev() {
        for axis in &mut axes {
            *axis = turned_back(rotation, *axis)?;
        }
    }
    Some(axes)
}

/// The robot's base in the frame of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Base {
    /// The sensor's position in the base's frame, m.
    pub(super) place: [f64; 3],
    /// The base's origin, m.
    origin: [f64; 3],
    /// The directions forwards, to the left and up.
    axes: [[f64; 3]; 3],
}

impl Base {
    /// By the transforms that lead from `frame` to the base; `None` where they do not, or it is the base.
    pub(super) fn of(tree: &Tree, frame: &str) -> Option<Self> {
        let axes = axes_by_transforms(tree, frame)?;
        // the sensor's place in the base's frame
        let (mut place, mut frame) = ([0.0; 3], plain(frame));
        while !is_base(frame) {
            let link = tree.get(frame).filter(|link| link.is_static)?;
            place = turned(link.rotation, place)?;
            place = std::array::from_fn(|i| place[i] + link.translation[i]);
            frame = &link.parent;
        }
        let origin = std::array::from_fn(|i| -(0..3).map(|k| place[k] * axes[k][i]).sum::<f64>());
        let is_other = place != [0.0; 3] || axes[0] != [1.0, 0.0, 0.0];
        is_other.then_some(Self {
            place,
            origin,
            axes,
        })
    }

    /// Place and yaw of the base where the sensor has this pose.
    pub(super) fn pose(&self, position: [f64; 3], orientation: [f64; 4]) -> Option<[f64; 3]> {
        let beside = turned(orientation, self.origin)?;
        let ahead = turned(orientation, self.axes[0])?;
        let yaw = Real::atan2(ahead[1], ahead[0]);
        Some([position[0] + beside[0], position[1] + beside[1], yaw])
    }

    /// A speed of the sensor in its frame along the base's axes; of a speed along its own axis alone, that forwards of a base
    /// that does not drift; `None` of one that is to the side.
    pub(super) fn speed(&self, linear: [f64; 3], is_vector: bool) -> Option<[f64; 2]> {
        let [ahead, left, _] = self.axes;
        if is_vector {
            return Some([dot(ahead, linear), dot(left, linear)]);
        }
        (ahead[0].abs() > MAX_LEVEL_SIN).then(|| [linear[0] / ahead[0], 0.0])
    }
}

/// The directions forwards, to the left and up by two axes; `None` where they are not square to each other.
pub(super) fn axes_by_file(forward: [f64; 3], up: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    (dot(forward, up).abs() < MAX_LEVEL_SIN).then(|| [forward, cross(up, forward), up])
}

/// The mean of accelerations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Accelerations {
    sum: [f64; 3],
    count: f64,
}

impl Accelerations {
    pub(super) fn add(&mut self, acceleration: [f64; 3]) {
        if acceleration.iter().all(|a| a.is_finite()) {
            for (sum, a) in self.sum.iter_mut().zip(acceleration) {
                *sum += a;
            }
            self.count += 1.0;
        }
    }

    pub(super) const fn count(&self) -> f64 {
        self.count
    }

    /// The direction that points up; `None` where the mean is not that of gravity.
    pub(super) fn up(&self) -> Option<[f64; 3]> {
        let mean = self.sum.map(|sum| sum / self.count);
        let size = dot(mean, mean).sqrt();
        if !((size / GRAVITY_M_PER_S2 - 1.0).abs() < MAX_GRAVITY_ERROR) {
            return None;
        }
        Some(squared(mean.map(|a| a / size)))
    }
}

/// The axis that a direction is near to, or the direction itself.
fn squared(up: [f64; 3]) -> [f64; 3] {
    match up.iter().position(|u| u.abs() > SQUARE_COS) {
        Some(axis) => {
            let mut square = [0.0; 3];
            square[axis] = up[axis].signum();
            square
        }
        None => up,
    }
}

pub(super) fn agree(a: [f64; 3], b: [f64; 3]) -> bool {
    dot(a, b) > AGREE_COS
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A vector of the parent in the child's frame: q* v q.
fn turned_back([x, y, z, w]: [f64; 4], v: [f64; 3]) -> Option<[f64; 3]> {
    turned([-x, -y, -z, w], v)
}

/// A vector of the child in the parent's frame: q v q*. `None` of what is no rotation.
pub(super) fn turned([x, y, z, w]: [f64; 4], v: [f64; 3]) -> Option<[f64; 3]> {
    let size = x * x + y * y + z * z + w * w;
    if !(size > 1e-6 && size.is_finite()) {
        return None;
    }
    let q = [x, y, z];
    let twice = cross(q, v).map(|c| 2.0 * c / size);
    let again = cross(q, twice);
    Some(std::array::from_fn(|i| v[i] + w * twice[i] + again[i]))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests;
