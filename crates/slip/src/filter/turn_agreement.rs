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
pub(super) const UNIT_FACTOR: f64 = 5.0;
const IN_STEP_CORRELATION: f64 = 0.8;

/// Yaw rates by gyro and by the powered wheels, as means of their products.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TurnAgreement {
    gyro: f64,
    wheels: f64,
    both: f64,
    gap: f64,
    turn: f64,
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

    /// Adds a yaw rate by the gyro (rad/s) after `dt` seconds; returns the mean.
    pub(super) fn mean_turn(&mut self, gyro: f64, dt: f64) -> f64 {
        self.turn += (dt / MEMORY_S).clamp(0.0, 1.0) * (gyro - self.turn);
        self.turn
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

    #[test]
    fn products_and_gaps_are_means_over_their_memories() {
        let mut turn = TurnAgreement {
            gyro: 0.5,
            wheels: 0.25,
            both: -0.125,
            ..TurnAgreement::default()
        };
        turn.update(0.4, -0.3, 0.1);
        // a fifth of 0.5 s
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        assert!(near(turn.gyro, 0.8 * 0.5 + 0.2 * 0.16));
        assert!(near(turn.wheels, 0.8 * 0.25 + 0.2 * 0.09));
        assert!(near(turn.both, -0.8 * 0.125 - 0.2 * 0.12));
        // no more than all of it
        turn.update(0.4, -0.3, 0.75);
        assert!(near(turn.gyro, 0.16) && near(turn.wheels, 0.09) && near(turn.both, -0.12));
        assert!(near(turn.mean_turn(0.5, 0.1), 0.1) && near(turn.mean_turn(-0.4, 0.25), -0.15));
        assert!(near(turn.mean_turn(3.0, 0.75), 3.0));
        assert_eq!(turn.update_straight(-0.06, 0.5), None);
        assert!(near(turn.gap, -0.015));
        let gap = turn.update_straight(-0.06, 0.5).unwrap();
        assert!(near(gap, -0.015 - 0.25 * 0.045));
        turn.gap = 0.02;
        assert_eq!(turn.update_straight(0.02, 0.5), None);
        assert_eq!(turn.update_straight(7.0, 3.0), Some(7.0));
    }

    #[test]
    fn a_contradiction_is_beyond_each_of_its_limits() {
        // above 0.05 rad/s each; the gyro above a fifth of the wheels; a correlation below −0.3. Or above five times the wheels, with
        // a correlation above 0.8
        let (least, more) = (0.05 * 0.05, 0.0026);
        let opposite = |gyro: f64, wheels: f64| -0.31 * f64::sqrt(gyro * wheels);
        for (gyro, wheels, both, contradicts) in [
            (more, more, opposite(more, more), true),
            (more, more, -0.29 * more, false),
            (least, more, opposite(least, more), false),
            (more, least, opposite(more, least), false),
            (0.2, 4.0, opposite(0.2, 4.0), true),
            (0.16, 4.0, opposite(0.16, 4.0), false),
            (0.15, 4.0, opposite(0.15, 4.0), false),
            (7.0, 0.25, 0.81 * f64::sqrt(7.0 * 0.25), true),
            (7.0, 0.25, 0.79 * f64::sqrt(7.0 * 0.25), false),
            (6.25, 0.25, 1.25, false),
            (4.0, least, 0.1, false),
            // exactly at a correlation
            (4.0, 4.0, -0.3 * 4.0, false),
            (64.0, 1.0, 0.8 * 8.0, false),
        ] {
            let turn = TurnAgreement {
                gyro,
                wheels,
                both,
                ..TurnAgreement::default()
            };
            assert_eq!(turn.contradicts(), contradicts, "{turn:?}");
        }
    }
}
