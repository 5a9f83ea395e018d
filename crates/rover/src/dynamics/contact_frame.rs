//! The plane in which a wheel meets the ground.

use super::wheel_force::WheelLoad;
use crate::vector::Vector;

/// The contact plane passes through the ground this share of the radius before and behind the wheel: acos(0.9), half of the
/// contact of a wheel sunk by a tenth of its radius.
pub const CONTACT_REACH_SHARE: f64 = 0.45;
/// A wheel that leans further over than to this cosine is treated as one that leans so far, so that its sinkage is finite. A limit of
/// the description: at 78 degrees a robot has tipped over.
const MIN_LEAN_COSINE: f64 = 0.2;

/// The axes of a contact plane, in the frame in which axle and normal are given.
///
/// ```
/// use grouser_rover::dynamics::ContactFrame;
/// use grouser_rover::vector::Vector;
///
/// let [x, y, z] = Vector::AXES;
/// let frame = ContactFrame::new(y, z);
/// assert_eq!((frame.forward, frame.left), (x, y));
/// assert_eq!(frame.per_lean, 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactFrame {
    /// The wheel's axle, a unit vector to its left.
    pub axle: Vector,
    /// The ground's normal.
    pub up: Vector,
    /// Along the wheel.
    pub forward: Vector,
    /// To its left.
    pub left: Vector,
    /// Length in the wheel's own plane per length along the normal.
    pub per_lean: f64,
}

impl ContactFrame {
    /// The frame of a wheel by its axle and the ground's normal, both of length 1.
    #[must_use]
    pub fn new(axle: Vector, up: Vector) -> Self {
        // its length is the cosine of the angle between the wheel's plane and the ground's normal
        let forward = axle.cross(up);
        let per_cosine = 1.0 / forward.length().max(f64::MIN_POSITIVE);
        let forward = forward * per_cosine;
        Self {
            axle,
            up,
            forward,
            left: up.cross(forward),
            per_lean: per_cosine.min(1.0 / MIN_LEAN_COSINE),
        }
    }

    /// The force on a wheel, N, and its moment about the wheel's centre, N m, less the part about the axle: that is
    /// `load.torque`, against the spin. `height` is that of the centre, m.
    #[must_use]
    pub fn force_and_moment(&self, load: &WheelLoad, height: f64, radius: f64) -> (Vector, Vector) {
        let force = self.up * load.normal + self.forward * load.along + self.left * load.across;
        let arm = self.up * -height.clamp(0.0, radius);
        let moment = arm.cross(force);
        (force, moment - self.axle * moment.dot(self.axle))
    }
}
