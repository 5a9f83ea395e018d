//! A level that wanders, read with noise: smoothed, with both variances by maximum likelihood.

use alloc::vec;
use alloc::vec::Vec;

/// A reading of the level.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelReading {
    pub(super) value: f64,
    /// Variance by the description; the true one is a multiple of it.
    pub(super) variance: f64,
    /// Time since the reading before, s.
    pub(super) dt: f64,
}

/// Prior of the level: the wheels' own logarithmic slips differ by a tenth (wear, load, ground).
const PRIOR_VARIANCE: f64 = 0.01;
/// Its random walk at first, 1/s, and the least that is learnt of it.
const WALK: f64 = 1e-3;
const MIN_WALK: f64 = 1e-9;
/// The least multiple of the described variance, and the least variance of a reading.
const MIN_SCALE: f64 = 1e-3;
const MIN_VARIANCE: f64 = 1e-8;
/// The prior of both weighs as much as this many readings.
const PRIOR_WEIGHT: f64 = 2.0;
const ROUNDS: usize = 12;

/// Mean and variance of the level at each reading.
pub(super) fn smoothed_level(readings: &[LevelReading]) -> Vec<(f64, f64)> {
    let (mut walk, mut scale) = (WALK, 1.0);
    let mut out = vec![(0.0, 0.0); readings.len()];
    for _ in 0..ROUNDS {
        let (mut mean, mut variance) = (0.0, PRIOR_VARIANCE);
        // innovation, its variance, gain
        let mut passed = Vec::with_capacity(readings.len());
        for (reading, out) in readings.iter().zip(&mut out) {
            variance += walk * reading.dt;
            let total = variance + reading.variance * scale + MIN_VARIANCE;
            let (gain, innovation) = (variance / total, reading.value - mean);
            mean += gain * innovation;
            variance *= 1.0 - gain;
            passed.push((innovation, total, gain));
            *out = (mean, variance);
        }
        let (mut r, mut n) = (0.0, 0.0);
        let (mut of_walk, mut of_scale) = ([PRIOR_WEIGHT; 2], [PRIOR_WEIGHT; 2]);
        for ((reading, out), (innovation, total, gain)) in
            readings.iter().zip(&mut out).zip(passed).rev()
        {
            let (mean, variance) = *out;
            *out = (mean + variance * r, variance - variance * n * variance);
            let u = innovation / total - gain * r;
            let m = 1.0 / total + gain * gain * n;
            of_scale[0] += u * u * reading.variance * scale;
            of_scale[1] += m * reading.variance * scale;
            r += u;
            n = n * (1.0 - gain) * (1.0 - gain) + 1.0 / total;
            of_walk[0] += r * r * reading.dt * walk;
            of_walk[1] += n * reading.dt * walk;
        }
        walk = (walk * of_walk[0] / of_walk[1]).max(MIN_WALK);
        scale = (scale * of_scale[0] / of_scale[1]).max(MIN_SCALE);
    }
    out
}
