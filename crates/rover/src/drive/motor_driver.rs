//! The motor driver of a wheel: a speed loop with a limit of torque.

/// Proportional gain over the motor's greatest torque, s/rad: full torque at 1.7 rad/s off its setpoint.
/// With the integral gain an integral time of 0.15 s. Both are chosen, not those of a product.
pub(super) const GAIN_S_PER_RAD: f64 = 0.6;
/// Integral gain over the motor's greatest torque, 1/rad.
const INTEGRAL_GAIN_PER_RAD: f64 = 4.0;

/// A speed loop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MotorDriver {
    integral: f64,
}

impl MotorDriver {
    /// Torque (N m) that brings `rate` to its `setpoint` (rad/s), within `limit` (N m) either way; `max_torque` is the
    /// motor's greatest torque.
    #[inline]
    pub(super) fn torque(
        &mut self,
        setpoint: f64,
        rate: f64,
        (limit, max_torque): (f64, f64),
        step: f64,
    ) -> f64 {
        let limit = limit.clamp(0.0, max_torque);
        let error = setpoint - rate;
        let proportional = GAIN_S_PER_RAD * max_torque * error;
        // Anti-windup: the integral is never more than the limit leaves.
        let room = (
            (-limit - proportional).min(0.0).max(-limit),
            (limit - proportional).max(0.0).min(limit),
        );
        self.integral = (self.integral + step * INTEGRAL_GAIN_PER_RAD * max_torque * error)
            .clamp(room.0, room.1);
        (proportional + self.integral).clamp(-limit, limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_leaves_its_limit_as_soon_as_the_wheel_comes_up() {
        let mut driver = MotorDriver::default();
        for _ in 0..5000 {
            assert!(driver.torque(2.0, 0.0, (3.0, 10.0), 1e-3) <= 3.0);
        }
        // after five seconds at its limit it brakes in the first step above its setpoint
        assert!(driver.torque(2.0, 2.6, (3.0, 10.0), 1e-3) < 0.0);
    }
}
