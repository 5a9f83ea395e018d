//! Do gyro and wheels turn the same way? A sign or a unit that is wrong shows itself in the first bend.

/// Means over this long, s.
const MEMORY: f64 = 0.5;
/// The mean gap between both is over this long, s.
const LONG: f64 = 2.0;
/// Slower turns than this say nothing, rad/s.
const SLOW: f64 = 0.05;
/// Wheels that slip unlike make a turn of this much of straight driving, rad/s.
const UNLIKE: f64 = 0.02;
/// Correlation below this is a contradiction.
const AGAINST: f64 = -0.3;
/// A gyro that shows this many times the wheels' turn, and makes the wheels skid sideways of themselves, has another unit.
const SCALE: f64 = 5.0;

/// Yaw rates by gyro and by the powered wheels, as means of their products.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Turn {
    gyro: f64,
    wheels: f64,
    both: f64,
    gap: f64,
}

impl Turn {
    /// Takes both yaw rates (rad/s) after `dt` seconds.
    pub(super) fn take(&mut self, gyro: f64, wheels: f64, dt: f64) {
        let share = (dt / MEMORY).clamp(0.0, 1.0);
        let mix = |slot: &mut f64, value: f64| *slot += share * (value - *slot);
        mix(&mut self.gyro, gyro * gyro);
        mix(&mut self.wheels, wheels * wheels);
        mix(&mut self.both, gyro * wheels);
    }

    /// Takes how far the gyro is beyond the wheels and its bias (rad/s) after `dt` seconds where the wheels go straight; gives
    /// the mean, once that is more than wheels that slip unlike explain.
    pub(super) fn straight(&mut self, gap: f64, dt: f64) -> Option<f64> {
        self.gap += (dt / LONG).clamp(0.0, 1.0) * (gap - self.gap);
        (self.gap.abs() > UNLIKE).then_some(self.gap)
    }

    /// Does one contradict the other? One side that slips is no contradiction: then only one of them turns.
    pub(super) fn contradicts(&self) -> bool {
        let size = grouser_real::Real::sqrt(self.gyro * self.wheels);
        let opposite = size > SLOW * SLOW && self.both < AGAINST * size;
        let unit = self.gyro > SCALE * SCALE * self.wheels.max(SLOW * SLOW);
        opposite || unit
    }
}

#[cfg(test)]
mod tests {
    use super::Turn;

    fn after(gyro: f64, wheels: f64) -> bool {
        let mut turn = Turn::default();
        for _ in 0..100 {
            turn.take(gyro, wheels, 0.02);
        }
        turn.contradicts()
    }

    #[test]
    fn signs_and_units_are_found_and_a_slipping_side_is_not_blamed() {
        assert!(!after(0.15, 0.14));
        assert!(after(-0.15, 0.15));
        assert!(after(0.15 * 57.3, 0.15));
        assert!(!after(0.15, 0.02));
        assert!(!after(0.0, 0.3));
        assert!(!after(0.01, -0.01));
    }
}
