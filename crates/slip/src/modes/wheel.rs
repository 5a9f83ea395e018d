//! What a wheel has of its own beyond the common slip, by the same modes.

use core::array;

use grouser_real::Real;

use super::exceeds::normal_tail;
use super::table::{MODES, WALKS, mixed, weighed};
use crate::motion::{
    Belief, CREEP, CommonMotion, DRIFT, JITTER, MIN_SPEED, MIN_SQUARED_SPEED, Row, SIZE, SLIP,
    SPEED, TURN_BIAS, WheelStep, log_slip, slip_within, surprise,
};

/// Prior of the level: the wheels' own logarithmic slips differ by a tenth (wear, load, ground).
const PRIOR_VARIANCE: f64 = 0.01;

/// A wheel's slip and the variance of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSlip {
    /// The slip: 1 − v/u where the wheel drives, u/v − 1 where it brakes.
    pub slip: f64,
    /// Variance of its error.
    pub variance: f64,
}

/// What a wheel's logarithmic slip is beyond the common one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OwnSlip {
    mean: [f64; MODES],
    variance: [f64; MODES],
    weights: [f64; MODES],
    /// Mean and variance of the mixture.
    merged: [f64; 2],
    /// Variance of the wheel's speed over ground by drift and turn, over the square of that speed.
    by_motion: f64,
    moved: bool,
}

impl Default for OwnSlip {
    fn default() -> Self {
        Self {
            mean: [0.0; MODES],
            variance: [PRIOR_VARIANCE; MODES],
            weights: [1.0 / MODES as f64; MODES],
            merged: [0.0, PRIOR_VARIANCE],
            by_motion: 0.0,
            moved: false,
        }
    }
}

/// Mean and variance of a mixture.
fn moments(weights: &[f64; MODES], mean: &[f64; MODES], variance: &[f64; MODES]) -> [f64; 2] {
    let centre: f64 = weights.iter().zip(mean).map(|(w, m)| w * m).sum();
    let spread = |mode: usize| {
        let off = mean[mode] - centre;
        weights[mode] * (variance[mode] + off * off)
    };
    [centre, (0..MODES).map(spread).sum()]
}

impl OwnSlip {
    /// Passes over one step, by the belief at its end; `turn_noise` is the variance of the turn rate over the step by the gyro, and by the
    /// wheels, whose errors last.
    pub(super) fn advance(
        &mut self,
        wheel: &WheelStep,
        dt: f64,
        belief: &Belief,
        common: &CommonMotion,
        [by_gyro, by_wheels]: [f64; 2],
    ) {
        let distance = wheel.distance.unwrap_or(0.0);
        self.moved = distance.abs() >= MIN_SPEED * dt;
        if !self.moved {
            return;
        }
        let (sin, cos) = Real::sin_cos(common.direction);
        let (speed, drift) = (belief.mean[SPEED], belief.mean[DRIFT]);
        let [along_x, along_y, lever] = wheel.row;
        // the wheel's speed over ground by speed, drift and turn; errors of the speed are those of the common slip
        let along = along_x * (cos - drift * sin) + along_y * (sin + drift * cos);
        let mut row: Row = [0.0; SIZE];
        row[DRIFT] = speed * (along_y * cos - along_x * sin);
        row[TURN_BIAS] = -lever;
        let turn = common.turned / dt - belief.mean[TURN_BIAS];
        let ground = along * speed + lever * turn + wheel.swing / dt;
        let square = (ground * ground).max(MIN_SQUARED_SPEED);
        self.by_motion = (belief.variance_of(&row) + lever * lever * by_wheels) / square;
        let noise = (wheel.variance + CREEP * CREEP * dt * dt) / (distance * distance)
            + lever * lever * by_gyro / square
            + JITTER * JITTER;
        let reading = log_slip(distance, ground * dt) - belief.mean[SLIP];
        self.read(reading, noise, dt);
    }

    fn read(&mut self, value: f64, noise: f64, dt: f64) {
        let (weights, shares) = mixed(&self.weights, dt);
        let before: [[f64; 2]; MODES] =
            array::from_fn(|to| moments(&shares[to], &self.mean, &self.variance));
        let mut likelihoods = [0.0; MODES];
        for (mode, [mean, variance]) in before.into_iter().enumerate() {
            let variance = variance + WALKS[mode] * WALKS[mode] * dt;
            let total = variance + noise;
            let gain = variance / total;
            self.mean[mode] = mean + gain * (value - mean);
            self.variance[mode] = variance * (1.0 - gain);
            likelihoods[mode] = surprise(value - mean, total);
        }
        self.weights = weighed(&weights, &likelihoods);
        self.merged = moments(&self.weights, &self.mean, &self.variance);
    }

    /// Mean and variance of its logarithmic slip by a belief.
    fn log_slip(&self, belief: &Belief) -> (f64, f64) {
        let [own, variance] = self.merged;
        let common = belief.covariance[SLIP][SLIP];
        (belief.mean[SLIP] + own, common + self.by_motion + variance)
    }

    /// The wheel's slip by a belief.
    pub(super) fn slip(&self, belief: &Belief) -> Option<WheelSlip> {
        let (log, variance) = self.log_slip(belief);
        let (slip, variance) = slip_within(log, variance);
        self.moved.then_some(WheelSlip { slip, variance })
    }

    /// The probability that its slip exceeds a limit in [−1, 1], by a belief.
    pub(super) fn exceeds(&self, belief: &Belief, limit: f64) -> f64 {
        let limit = if limit >= 0.0 {
            -Real::ln_1p(-limit)
        } else {
            Real::ln_1p(limit)
        };
        let (log, variance) = self.log_slip(belief);
        normal_tail((limit - log) / Real::sqrt(variance))
    }
}
