//! Gyro and accelerometer: taken, gated, and watched.

use grouser_real::Real;

use super::motion_model::{GYRO_BIAS, Heard, YAW};
use super::kalman::ScalarMeasurement;
use super::wheel_update::BEND;
use super::{BREAKS, FELT, FELT_UNREST, MAX_FORCE, MAX_YAW_RATE, SAME, SlipFilter};
use crate::fault::Fault;
use crate::history::seconds_between;

/// How much of the gap between gyro and wheels its bias may change by, a share per √s.
const CHANGED: f64 = 0.3;

impl SlipFilter {
    pub(super) fn take_yaw_rate(
        &mut self,
        time_ns: i64,
        rate: f64,
    ) -> core::result::Result<(), Fault> {
        Fault::check_range("yaw rate", rate, -MAX_YAW_RATE, MAX_YAW_RATE, "rad/s")?;
        let sigma = self.settings.yaw_rate_sigma;
        let seen = ScalarMeasurement {
            jacobian: &[(YAW, 1.0), (GYRO_BIAS, 1.0)],
            residual: rate - self.state.mean(YAW) - self.state.mean(GYRO_BIAS),
            variance: sigma * sigma,
        };
        let (residual, variance) = self.state.innovation(&seen);
        let agreed = residual.abs() <= self.settings.gate * Real::sqrt(variance)
            && !self.is_stuck(time_ns, rate);
        let believed = self.gyro.judge(time_ns, agreed, self.settings.failure);
        self.gyro_ns = Some(time_ns);
        if let Some(wheels) = self.turn_by_wheels() {
            let dt = seconds_between(self.turned_ns.replace(time_ns).unwrap_or(time_ns), time_ns);
            self.turn.take(rate, wheels, dt);
            let gap = rate - self.state.mean(GYRO_BIAS) - wheels;
            if wheels.abs() < BEND
                && let Some(off) = self.turn.straight(gap, dt)
            {
                // the bias has changed more than it should
                let bias = self.settings.gyro_bias;
                let doubt = (CHANGED * off) * (CHANGED * off) * dt;
                self.state.inflate(GYRO_BIAS, doubt, bias * bias);
            }
        }
        let same_way = !self.turn.contradicts();
        self.contradicted
            .judge(time_ns, same_way, self.settings.failure);
        if !agreed || !believed || self.contradicted.has_failed() {
            self.turning = self.state.mean(YAW);
            return Ok(());
        }
        self.turning = rate;
        self.nis = self.state.update(&seen);
        Ok(())
    }

    /// Has the gyro shown the same to the bit for long, while wheels turn?
    pub(super) fn is_stuck(&mut self, time_ns: i64, rate: f64) -> bool {
        let same = rate.to_bits();
        let moves = self.wheels.iter().any(super::wheel_channel::Tracked::turns);
        match self.gyro_same {
            Some((bits, since)) if bits == same && moves => seconds_between(since, time_ns) >= SAME,
            _ => {
                self.gyro_same = Some((same, time_ns));
                false
            }
        }
    }

    /// Is the gyro heard, and believed?
    pub(super) fn gyro_is_believed(&self, now_ns: i64) -> bool {
        let heard = self
            .gyro_ns
            .is_some_and(|then| seconds_between(then, now_ns) <= self.settings.dropout);
        heard && !self.gyro.has_failed() && !self.contradicted.has_failed()
    }

    /// The yaw rate that the powered wheels would give without slip, where all point one way.
    pub(super) fn turn_by_wheels(&self) -> Option<f64> {
        self.sideways?;
        let powered = || self.wheels.iter().filter(|wheel| !wheel.free);
        let count = powered().count() as f64;
        let (mut rims, mut arms) = (0.0, 0.0);
        for wheel in powered() {
            rims += wheel.rim?.0.value;
            arms += wheel.row[2];
        }
        let (mut product, mut square) = (0.0, 0.0);
        for wheel in powered() {
            let arm = wheel.row[2] - arms / count;
            product += arm * (wheel.rim?.0.value - rims / count);
            square += arm * arm;
        }
        (square > 1e-6).then(|| product / square)
    }

    pub(super) fn take_acceleration(
        &mut self,
        time_ns: i64,
        force: [f64; 2],
    ) -> core::result::Result<(), Fault> {
        for (field, value) in [
            ("acceleration forward", force[0]),
            ("acceleration left", force[1]),
        ] {
            Fault::check_range(field, value, -MAX_FORCE, MAX_FORCE, "m/s²")?;
        }
        self.heard = Some(Heard { time_ns, force });
        Ok(())
    }

    /// Is the accelerometer better than nothing?
    pub(super) fn feels(&self) -> bool {
        self.settings.accelerometer_noise * Real::sqrt(self.felt_unrest) < self.settings.speed_walk
    }

    /// A speed that comes out otherwise than the accelerometer foresaw makes that less certain.
    pub(super) fn learn_felt(&mut self, residual: f64, variance: f64) {
        let r = (residual / Real::sqrt(variance)).clamp(-BREAKS, BREAKS);
        let learnt = Real::exp(FELT * (r * r - 1.0));
        self.felt_unrest = (self.felt_unrest * learnt).clamp(FELT_UNREST.0, FELT_UNREST.1);
    }
}
