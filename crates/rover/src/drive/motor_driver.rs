//! The motor driver of a wheel: a speed loop with a limit of torque.

/// Gains over the motor's greatest torque: per rad/s, and per rad.
const RATE_GAIN_S_PER_RAD: f64 = 0.6;
const INTEGRAL_GAIN: f64 = 4.0;

/// A speed loop.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MotorDriver {
    integral: f64,
}

impl MotorDriver {
    /// Torque (N m) that brings `rate` to `wanted` (rad/s), within `limit` (N m) either way; `most` is the motor's
    /// greatest torque.
    pub(super) fn torque(
        &mut self,
        wanted: f64,
        rate: f64,
        (limit, most): (f64, f64),
        step: f64,
    ) -> f64 {
        let limit = limit.clamp(0.0, most);
        let off = wanted - rate;
        let proportional = RATE_GAIN_S_PER_RAD * most * off;
        // The integral never asks for more than the limit leaves: no wind-up.
        let room = (
            (-limit - proportional).min(0.0).max(-limit),
            (limit - proportional).max(0.0).min(limit),
        );
        self.integral = (self.integral + step * INTEGRAL_GAIN * most * off).clamp(room.0, room.1);
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
        // five seconds at its limit, and not one step too long above its speed
        assert!(driver.torque(2.0, 2.6, (3.0, 10.0), 1e-3) < 0.0);
    }
}
