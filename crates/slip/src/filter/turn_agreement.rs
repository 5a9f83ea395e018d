//! Agreement of gyro and wheels about the turning of the robot: a wrong sign or unit shows in the first bend.

/// Time constant of the means of products, s.
const MEMORY_S: f64 = 0.5;
/// Time constant of the mean gap between gyro and wheels, s.
const GAP_MEMORY_S: f64 = 2.0;
/// Slower turns are not compared, rad/s.
const MIN_TURN_RAD_PER_S: f64 = 0.05;
/// A gap of this size is explained by wheels that slip differently in straight driving, rad/s.
const MAX_SLIP_GAP_RAD_PER_S: f64 = 0.02;
/// A correlation below this is a wrong sign.
const OPPOSITE_CORRELATION: f64 = -0.3;
/// A gyro that shows this many times the wheels' turn, and in step with it, has another unit: no tyre skids sideways that much. One
/// side that slips turns the robot too, but not in step with the wheels. One that shows this share of their turn or less shows its bias,
/// whose sign says nothing, beside a side that slips.
const UNIT_FACTOR: f64 = 5.0;
const IN_STEP_CORRELATION: f64 = 0.8;

/// Yaw rates by gyro and by the powered wheels, as means of their products.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TurnAgreement {
    gyro: f64,
    wheels: f64,
    both: f64,
    gap: f64,
}

impl TurnAgreement {
    /// Adds both yaw rates (rad/s) after `dt` seconds.
    pub(super) fn update(&mut self, gyro: f64, wheels: f64, dt: f64) {
        let share = (dt / MEMORY_S).clamp(0.0, 1.0);
        let mix = |slot: &mut f64, value: f64| *slot += share * (value - *slot);
        mix(&mut self.gyro, gyro * gyro);
        mix(&mut self.wheels, wheels * wheels);
        mix(&mut self.both, gyro * wheels);
    }

    /// Adds the gap of the gyro beyond the wheels and its bias (rad/s) after `dt` seconds of straight driving; returns the
    /// mean gap once it is larger than wheels that slip differently explain.
    pub(super) fn update_straight(&mut self, gap: f64, dt: f64) -> Option<f64> {
        self.gap += (dt / GAP_MEMORY_S).clamp(0.0, 1.0) * (gap - self.gap);
        (self.gap.abs() > MAX_SLIP_GAP_RAD_PER_S).then_some(self.gap)
    }

    /// Do they contradict each other? One side that slips is no contradiction: then only one of them turns.
    pub(super) fn contradicts(&self) -> bool {
        let least = MIN_TURN_RAD_PER_S * MIN_TURN_RAD_PER_S;
        let size = grouser_real::Real::sqrt(self.gyro * self.wheels);
        let factor = UNIT_FACTOR * UNIT_FACTOR;
        let both_turn = self.gyro > least.max(self.wheels / factor) && self.wheels > least;
        let opposite = both_turn && self.both < OPPOSITE_CORRELATION * size;
        let unit = self.wheels > least
            && self.gyro > factor * self.wheels
            && self.both > IN_STEP_CORRELATION * size;
        opposite || unit
    }
}

#[cfg(test)]
mod tests {
    use super::TurnAgreement;

    fn after(gyro: f64, wheels: f64) -> bool {
        let mut turn = TurnAgreement::default();
        for _ in 0..100 {
            turn.update(gyro, wheels, 0.02);
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
        // one side slips while both rims turn equally fast
        assert!(!after(0.4, 0.0) && !after(0.4, 0.04));
        assert!(!after(0.01, -0.01));
        // one side slips, and the gyro shows what is left of its bias
        assert!(!after(-0.03, 2.6) && !after(-0.1, 2.6));
    }
}
