//! What a camera, a pose or a speed over ground says of the robot.

use grouser_real::Real;

use super::motion_model::{FORWARD, along};
use super::kalman::ScalarMeasurement;
use super::reference_sensor::Seen;
use super::{ALONE, BREAKS, LOOSE, ONE_SIDE, ONE_SIDED, RETURNS, SlipFilter, Statement};
use crate::fault::Fault;
use crate::history::seconds_between;
use crate::sample::Measurement;

impl SlipFilter {
    pub(super) fn take_reference(
        &mut self,
        time_ns: i64,
        measurement: &Measurement,
    ) -> core::result::Result<(), Fault> {
        let Some(seen) = self.reference.take(time_ns, measurement, &self.settings)? else {
            return Ok(());
        };
        let moving = seen.speed[0].is_some_and(|v| v != 0.0);
        let frozen = self.reference.is_frozen(&seen, self.settings.failure) && moving;
        // the same to the bit is no claim
        self.reference.speed = seen.speed[0].filter(|_| !frozen).map(|v| (v, time_ns));
        let statements = self.statements(&seen, time_ns);
        let mut agreed = !frozen;
        let mut first = None;
        for (slopes, residual, variance) in statements.iter().flatten() {
            let (residual, variance) = self.state.innovation(&ScalarMeasurement {
                jacobian: slopes,
                residual: *residual,
                variance: *variance,
            });
            let r = residual / Real::sqrt(variance);
            agreed &= r.abs() <= self.settings.gate;
            first.get_or_insert(r);
        }
        // one side for long is a scale or a delay, though no single reading is far off
        let r = first.unwrap_or(0.0).clamp(-BREAKS, BREAKS);
        self.reference.pull += ONE_SIDE * (r - self.reference.pull);
        agreed &= self.reference.pull.abs() <= ONE_SIDED;
        let had_failed = self.reference.watch.has_failed();
        let mut near = true;
        if had_failed && let Some((_, residual, _)) = statements[0] {
            // Without it the speed is known so badly that anything would agree.
            let most = RETURNS * self.state.mean(FORWARD).abs() + self.settings.low_speed;
            near = residual.abs() <= most;
            let told = seen.speed[0].unwrap_or(0.0);
            let plausible = self.is_lost(time_ns)
                && self.is_plausible(told)
                && self.agrees_with_free_wheel(told, time_ns);
            agreed = !frozen && (agreed && near || plausible);
        }
        let believed = self
            .reference
            .watch
            .judge(time_ns, agreed, self.settings.failure);
        if !agreed || !believed {
            return Ok(());
        }
        if had_failed
            && !near
            && let Some(told) = seen.speed[0]
        {
            self.begin_from(told);
            self.reference.pull = 0.0;
            return Ok(());
        }
        for (slopes, residual, variance) in statements.iter().flatten() {
            self.nis = self.state.update(&ScalarMeasurement {
                jacobian: slopes,
                residual: *residual,
                variance: *variance,
            });
        }
        self.reference.accepted_ns = Some(time_ns);
        self.reference_ns = Some(time_ns);
        Ok(())
    }

    /// How the speed wanders between readings, m/s per √s. With nothing but the wheels it goes where they go: a speed that
    /// were slow to change would make slip of every start.
    pub(super) fn walk(&self) -> f64 {
        let now_ns = self.now_ns.unwrap_or(0);
        let alone = self
            .reference_ns
            .is_none_or(|then| seconds_between(then, now_ns) > ALONE);
        if alone {
            LOOSE * self.settings.speed_walk
        } else if self.heard.is_some() && self.feels() {
            (self.settings.accelerometer_noise * Real::sqrt(self.felt_unrest))
                .min(LOOSE * self.settings.speed_walk)
        } else {
            self.settings.speed_walk
        }
    }

    /// A measured motion as statements about the present: what has changed since is added to its variance.
    pub(super) fn statements(&self, seen: &Seen, now_ns: i64) -> [Option<Statement>; 3] {
        let age =
            seconds_between(seen.to_ns, now_ns) + 0.5 * seconds_between(seen.from_ns, seen.to_ns);
        let walk = self.walk();
        let since = walk * walk * age;
        let turned = self.settings.yaw_rate_sigma * self.settings.yaw_rate_sigma;
        let variance = seen.sigma * seen.sigma;
        let one = |row: [f64; 3], value: Option<f64>, variance: f64| {
            value.map(|value| {
                let predicted = self.mean_along(row, seen.from_ns, seen.to_ns);
                (along(row), value - predicted, variance)
            })
        };
        [
            one([1.0, 0.0, 0.0], seen.speed[0], variance + since),
            one([0.0, 1.0, 0.0], seen.speed[1], variance + since),
            one([0.0, 0.0, 1.0], seen.turn, 25.0 * variance + turned),
        ]
    }
}
