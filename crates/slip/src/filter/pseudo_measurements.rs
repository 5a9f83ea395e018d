//! What needs no sensor: a robot whose wheels all point one way does not drift far, and one whose wheels all stand, stands.

use grouser_real::Real;

use super::motion_model::{self, FORWARD};
use super::{EVERY, SlipFilter};

/// All wheels still for this long: the robot stands, s.
const STANDS: f64 = 0.2;
/// Independent statements of a pseudo-measurement come this often, s.
const APART: f64 = 0.5;
/// How far the yaw rate is from what the powered wheels would give, as a share and rad/s.
const BY_WHEELS: (f64, f64) = (0.3, 0.05);

impl SlipFilter {
    /// Takes the pseudo-measurements.
    pub(super) fn assume(&mut self, time_ns: i64) {
        let weight = Real::sqrt(APART / EVERY);
        if let Some(row) = self.sideways {
            let sigma = weight * self.settings.lateral_sigma;
            motion_model::hold(&mut self.state, row, 0.0, sigma);
        }
        if !self.gyro_is_believed(time_ns)
            && let Some(turn) = self.turn_by_wheels()
        {
            // nothing else tells how the robot turns
            let sigma = BY_WHEELS.0 * turn.abs() + BY_WHEELS.1;
            motion_model::hold(&mut self.state, [0.0, 0.0, 1.0], turn, weight * sigma);
        }
        for wheel in self.wheels.iter().filter(|wheel| wheel.free) {
            let still = wheel.stillness(time_ns);
            if still >= STANDS && wheel.watch.is_clean() && wheel.rolling.stop_known {
                // it has gone less than a tick since
                let sigma = (0.6 * wheel.tick / still).max(0.002);
                motion_model::hold(&mut self.state, wheel.row, 0.0, weight * sigma);
            }
        }
        let stand = self
            .wheels
            .iter()
            .all(|wheel| wheel.stillness(time_ns) >= STANDS && !wheel.watch.has_failed());
        if stand {
            for wheel in &mut self.wheels {
                wheel.rolling.stands();
            }
            // without a free wheel it may still slide with its wheels locked
            let rolls = self.wheels.iter().any(|wheel| wheel.free);
            let sigma = if rolls { 0.002 } else { 0.02 };
            let variance = self.state.variance_of(&[(FORWARD, 1.0)]) + sigma * sigma;
            self.learn_felt(self.state.mean(FORWARD), variance);
            for row in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
                motion_model::hold(&mut self.state, row, 0.0, weight * sigma);
            }
            motion_model::hold(&mut self.state, [0.0, 0.0, 1.0], 0.0, weight * 0.002);
        }
    }
}
