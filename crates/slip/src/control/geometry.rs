//! Where the wheels stand, and what a motion of the robot means for each of them.

use grouser_real::{Real, wrap_angle};

/// Place, heading and steering of a wheel.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelGeometry {
    /// m, forwards.
    pub(super) x: f64,
    /// m, to the left.
    pub(super) y: f64,
    /// The direction in which it drives at the steering angle 0, rad.
    pub(super) heading: f64,
    /// How far it steers either way, rad; 0: not at all.
    pub(super) max_steering_angle: f64,
}

impl WheelGeometry {
    /// Steering angle (rad) and speed along the wheel's heading (m/s) for a robot that travels at `speed` and turns at
    /// `yaw_rate`: the wheel's centre moves by (v − Ω y, Ω x).
    pub(super) fn setpoint(&self, speed: f64, yaw_rate: f64) -> (f64, f64) {
        let (v_x, v_y) = (speed - yaw_rate * self.y, yaw_rate * self.x);
        let mut angle = 0.0;
        if self.max_steering_angle > 0.0 && (v_x != 0.0 || v_y != 0.0) {
            let sense = if speed < 0.0 { -1.0 } else { 1.0 };
            let along = wrap_angle(Real::atan2(sense * v_y, sense * v_x) - self.heading);
            angle = along.clamp(-self.max_steering_angle, self.max_steering_angle);
        }
        let (sin, cos) = Real::sin_cos(self.heading + angle);
        (angle, cos * v_x + sin * v_y)
    }

    /// Curvature of the sharpest arc that the wheel can follow, 1/m; `None` where it does not steer.
    pub(super) fn max_curvature(&self) -> Option<f64> {
        let arm = (self.x.abs() + self.y.abs()).max(1e-3);
        (self.max_steering_angle > 0.0).then(|| Real::tan(self.max_steering_angle) / arm)
    }
}
