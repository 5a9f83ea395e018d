//! The integrals of accelerometer and gyro over time: they carry a measurement over a past window to the present.

use super::kalman::Kalman;
use super::motion_model::{FORWARD, LEFT, YAW};
use crate::history::{History, nanoseconds, seconds_between};

/// Entries of the history at most: the longest latency and the horizon at 500 Hz; faster readings are merged.
const MAX_HISTORY_ENTRIES: usize = 512;

/// What the inertial sensors have measured of the motion so far.
#[derive(Clone, Debug)]
pub(super) struct InertialPath {
    history: History<3>,
    /// Change of speed forwards and to the left by the accelerometer (m/s), and angle turned by the gyro (rad).
    accel_integral: [f64; 3],
    /// The yaw rate by which the angle grows, rad/s: the gyro's where that is trusted.
    pub(super) yaw_rate: f64,
}

impl InertialPath {
    /// For sensors of at most `max_rate` (Hz).
    pub(super) fn new(span_s: f64, max_rate: f64) -> Self {
        Self {
            history: History::of_rate(span_s, max_rate, MAX_HISTORY_ENTRIES),
            accel_integral: [0.0; 3],
            yaw_rate: 0.0,
        }
    }

    pub(super) fn restart_clock(&mut self) {
        self.history.clear();
    }

    /// Adds `dt` seconds in which the accelerometer changed the speeds by `gained` (m/s).
    pub(super) fn advance(&mut self, dt: f64, gained: [f64; 2]) {
        self.accel_integral[0] += gained[0];
        self.accel_integral[1] += gained[1];
        self.accel_integral[2] += self.yaw_rate * dt;
    }

    pub(super) fn record(&mut self, time_ns: i64) {
        self.history.push(time_ns, self.accel_integral);
    }

    /// The change of speed forwards by the accelerometer so far, m/s.
    pub(super) const fn forward_integral(&self) -> f64 {
        self.accel_integral[0]
    }

    /// The robot's mean speed along `row` from `from_ns` to `to_ns` by the present state: its speed now less what the
    /// accelerometer measured since. Past states would bring back errors that measurements have removed since.
    pub(super) fn mean_along(
        &self,
        state: &Kalman,
        row: [f64; 3],
        from_ns: i64,
        to_ns: i64,
    ) -> f64 {
        let mut mean = [FORWARD, LEFT, YAW].map(|i| state.mean(i));
        let window = seconds_between(from_ns, to_ns);
        let middle = to_ns.saturating_sub(nanoseconds(0.5 * window));
        if let Some(then) = self.history.at(middle) {
            mean[0] -= self.accel_integral[0] - then[0];
            mean[1] -= self.accel_integral[1] - then[1];
        }
        mean[2] = self.mean_yaw_rate(state, from_ns, to_ns);
        crate::body::dot(row, mean)
    }

    /// The mean yaw rate from `from_ns` to `to_ns` by the present state, rad/s.
    pub(super) fn mean_yaw_rate(&self, state: &Kalman, from_ns: i64, to_ns: i64) -> f64 {
        let window = seconds_between(from_ns, to_ns);
        let rate = state.mean(YAW);
        match self.history.between(from_ns, to_ns) {
            Some([_, _, turned]) if window > 0.0 => rate + turned / window - self.yaw_rate,
            _ => rate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;
    /// Parts of the robot's three speeds in that of a wheel, none of them 0 or 1.
    const WHEEL_ROW: [f64; 3] = [0.8, -0.6, 0.4];
    /// Present speeds, m/s, and yaw rate, rad/s; accelerations, m/s²; and the gyro before and now, rad/s.
    const PRESENT_MOTION: [f64; 3] = [0.5, 0.2, 0.1];
    const ACCELERATION_M_PER_S2: [f64; 2] = [0.7, -0.3];
    const GYRO_RAD_PER_S: [f64; 2] = [0.3, 0.45];

    #[test]
    fn a_past_motion_is_the_present_one_less_what_was_measured_since() {
        let mut state = Kalman::new(3);
        for (i, mean) in [FORWARD, LEFT, YAW].into_iter().zip(PRESENT_MOTION) {
            state.set_mean(i, mean);
        }
        let mut path = InertialPath::new(1.0, 1000.0);
        for step in 0..=50 {
            path.yaw_rate = GYRO_RAD_PER_S[usize::from(step > 30)];
            path.advance(0.01, ACCELERATION_M_PER_S2.map(|a| a * 0.01));
            path.record(step * 10 * MS);
        }
        let near = |value: f64, expected: f64| (value - expected).abs() < 1e-12;
        assert!(near(
            path.forward_integral(),
            0.51 * ACCELERATION_M_PER_S2[0]
        ));
        // from 0.1 s to 0.2 s: 0.35 s before the end
        let yaw_rate = PRESENT_MOTION[2] + GYRO_RAD_PER_S[0] - GYRO_RAD_PER_S[1];
        let [forward, left] = [0, 1].map(|i| PRESENT_MOTION[i] - 0.35 * ACCELERATION_M_PER_S2[i]);
        let expected = WHEEL_ROW[0] * forward + WHEEL_ROW[1] * left + WHEEL_ROW[2] * yaw_rate;
        assert!(near(
            path.mean_along(&state, WHEEL_ROW, 100 * MS, 200 * MS),
            expected
        ));
        assert!(near(
            path.mean_yaw_rate(&state, 100 * MS, 200 * MS),
            yaw_rate
        ));
        // over no time, before the first entry and after the clock was set: the present one
        let present = WHEEL_ROW[0] * PRESENT_MOTION[0]
            + WHEEL_ROW[1] * PRESENT_MOTION[1]
            + WHEEL_ROW[2] * PRESENT_MOTION[2];
        let now_ns = 500 * MS;
        assert_eq!(
            path.mean_yaw_rate(&state, now_ns, now_ns),
            PRESENT_MOTION[2]
        );
        assert!(near(
            path.mean_along(&state, WHEEL_ROW, -200 * MS, -100 * MS),
            present
        ));
        path.restart_clock();
        assert!(near(
            path.mean_along(&state, WHEEL_ROW, 100 * MS, 200 * MS),
            present
        ));
    }
}
