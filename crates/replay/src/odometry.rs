//! Odometry: the robot's pose since the beginning of the span, with the slip in its covariance.

use grouser_real::Real;
use grouser_slip::filter::BodyEstimate;

/// A pose from the beginning of the log, with the speeds that led there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Odometry {
    /// x and y, m, and yaw, rad.
    pub pose: [f64; 3],
    /// Covariance of the three.
    pub pose_covariance: [[f64; 3]; 3],
    /// Forwards m/s, to the left m/s, turning left rad/s.
    pub velocity: [f64; 3],
    /// Covariance of the three.
    pub velocity_covariance: [[f64; 3]; 3],
    /// Distance in the direction in which the wheels ran, m.
    pub distance: f64,
    /// The same by the powered wheels alone, without compensation of slip, m.
    pub distance_of_wheels: f64,
}

impl Odometry {
    /// The filter's own odometry, with the distances by wheels and filter.
    pub(crate) fn of_filter(body: &BodyEstimate, travel: [f64; 2]) -> Self {
        let speeds = [body.forward, body.left, body.yaw_rate];
        let place = body.odometry;
        Self {
            pose: [place.x, place.y, place.yaw],
            pose_covariance: place.covariance,
            velocity: speeds.map(|speed| speed.value),
            velocity_covariance: body.velocity_covariance,
            distance: travel[1],
            distance_of_wheels: travel[0],
        }
    }

    /// The place between this and another one.
    pub(crate) fn towards(&self, other: &Self, share: f64) -> Self {
        let blend = |a: f64, b: f64| a + share * (b - a);
        let matrix = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]| {
            std::array::from_fn(|i| std::array::from_fn(|j| blend(a[i][j], b[i][j])))
        };
        Self {
            pose: std::array::from_fn(|i| blend(self.pose[i], other.pose[i])),
            pose_covariance: matrix(&self.pose_covariance, &other.pose_covariance),
            distance: blend(self.distance, other.distance),
            distance_of_wheels: blend(self.distance_of_wheels, other.distance_of_wheels),
            ..*self
        }
    }

    /// The same in the robot's frame at `origin`. The covariance stays the one since the log's start, which is not less.
    pub(crate) fn since(&self, origin: &Self) -> Self {
        let (sin, cos) = Real::sin_cos(origin.pose[2]);
        let [dx, dy, turn]: [f64; 3] = std::array::from_fn(|i| self.pose[i] - origin.pose[i]);
        let back = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
        Self {
            pose: [cos * dx + sin * dy, cos * dy - sin * dx, turn],
            pose_covariance: sandwich(&back, &self.pose_covariance),
            distance: self.distance - origin.distance,
            distance_of_wheels: self.distance_of_wheels - origin.distance_of_wheels,
            ..*self
        }
    }
}

/// A P Aᵀ.
pub(crate) fn sandwich(a: &[[f64; 3]; 3], p: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, cell) in row.iter_mut().enumerate() {
            for k in 0..3 {
                for l in 0..3 {
                    *cell += a[i][k] * p[k][l] * a[j][l];
                }
            }
        }
    }
    out
}
