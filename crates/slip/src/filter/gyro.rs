//! The gyro judged by the turn of the wheels: a wrong sign or unit shows in the first bend.

use grouser_real::Real;

/// Time constant of the means of products, s.
const MEMORY_S: f64 = 0.5;
/// Slower turns are not compared, rad/s.
const MIN_TURN_RAD_PER_S: f64 = 0.05;
/// A correlation below this is a wrong sign.
const OPPOSITE_CORRELATION: f64 = -0.3;
/// A gyro that shows this many times the wheels' turn, and in step with it, has another unit: no tyre skids sideways that much. One
/// side that slips turns the robot too, but not in step with the wheels. One that shows this share of their turn or less shows its bias,
/// whose sign says nothing, next to a side that slips.
const UNIT_FACTOR: f64 = 5.0;
const IN_STEP_CORRELATION: f64 = 0.8;
/// A contradiction that lasts this long condemns the gyro, s, and agreement this many times as long clears it.
const PATIENCE_S: f64 = 0.25;
const FORGIVENESS: f64 = 3.0;

/// Turn rates by gyro and by the powered wheels, as means of their products.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GyroMonitor {
    gyro: f64,
    wheels: f64,
    both: f64,
    /// How long they have contradicted each other, less the agreement that makes up for it, s.
    doubt: f64,
    is_wrong: bool,
}

impl GyroMonitor {
    /// Compares the turn rates by gyro and wheels (rad/s) over a step of `dt` (s).
    pub(super) fn compare(&mut self, gyro: f64, wheels: f64, dt: f64) {
        let share = (dt / MEMORY_S).min(1.0);
        let mix = |slot: &mut f64, value: f64| *slot += share * (value - *slot);
        mix(&mut self.gyro, gyro * gyro);
        mix(&mut self.wheels, wheels * wheels);
        mix(&mut self.both, gyro * wheels);
        let correlation = self.both / Real::sqrt(self.gyro * self.wheels).max(f64::MIN_POSITIVE);
        if self.contradicts(correlation) {
            self.doubt = (self.doubt + dt).min(PATIENCE_S);
            self.is_wrong |= self.doubt >= PATIENCE_S;
        } else if self.both_turn() && correlation > IN_STEP_CORRELATION {
            self.doubt = (self.doubt - dt / FORGIVENESS).max(0.0);
            self.is_wrong &= self.doubt > 0.0;
        }
    }

    fn both_turn(&self) -> bool {
        let least = MIN_TURN_RAD_PER_S * MIN_TURN_RAD_PER_S;
        self.gyro > least && self.wheels > least
    }

    /// One side that slips is no contradiction: then only one of them turns.
    fn contradicts(&self, correlation: f64) -> bool {
        let factor = UNIT_FACTOR * UNIT_FACTOR;
        let is_opposite = self.gyro > self.wheels / factor && correlation < OPPOSITE_CORRELATION;
        let is_other_unit = self.gyro > factor * self.wheels && correlation > IN_STEP_CORRELATION;
        self.both_turn() && (is_opposite || is_other_unit)
    }

    /// Does it contradict the wheels?
    pub(super) const fn is_wrong(&self) -> bool {
        self.is_wrong
    }
}
