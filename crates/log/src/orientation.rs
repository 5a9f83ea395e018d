//! The heading of a quaternion.

use grouser_real::Real;

/// The yaw of an orientation x, y, z, w: how far the x axis is turned about z, rad. `None` of what is no
/// rotation.
pub(crate) fn yaw([x, y, z, w]: [f64; 4]) -> Option<f64> {
    let size = x * x + y * y + z * z + w * w;
    (size > 1e-6 && size.is_finite())
        .then(|| Real::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z))
}
