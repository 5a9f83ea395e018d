//! A slip curve of one wheel under one load: most points begin where their neighbours say.
//!
//! Eight slips, Chebyshev's of the curve's range, are solved from nothing. What their searches ended with
//! is smooth in slip. Interpolated, it gives the sinkage of every other point to 1e-6 and better, and one evaluation
//! of the fine rule ends the search. The residual of every point is looked at; where the curve is less
//! smooth, the fine rule goes on.

use crate::status::SolveStatus;

use super::columns::{BatchColumns, Inputs};
use super::load::{LoadSheet, Start};
use super::machine::Level;
use super::plan::{CHUNK, Chunk};
use super::vector::Vector;

/// Slips that are solved from nothing: one group.
const CURVE_NODES: usize = 8;
/// Least number of points for which this is worth while.
const MIN_CURVE_POINTS: usize = if CHUNK < 24 { CHUNK } else { 24 };
/// How far the interpolated slopes are trusted: a residual of ln W below 2e-6 is gone straight.
pub(super) const SLOPE_TRUST: f64 = 1e-4;

/// cos(π i/16) for i from 0 to 8.
const COSINES: [f64; 9] = [
    1.0,
    0.980_785_280_403_230_4,
    0.923_879_532_511_286_7,
    0.831_469_612_302_545_2,
    core::f64::consts::FRAC_1_SQRT_2,
    0.555_570_233_019_602_3,
    0.382_683_432_365_089_84,
    0.195_090_322_016_128_33,
    0.0,
];

/// cos(π i/16)
const fn cosine(i: usize) -> f64 {
    let i = i % 32;
    let i = if i > 16 { 32 - i } else { i };
    if i > 8 { -COSINES[16 - i] } else { COSINES[i] }
}

/// What the value at the k-th node gives to the j-th coefficient, by the discrete orthogonality of the
/// cosines.
const TRANSFORM: [[f64; CURVE_NODES]; CURVE_NODES] = {
    let mut rows = [[0.0; CURVE_NODES]; CURVE_NODES];
    let mut k = 0;
    while k < CURVE_NODES {
        let mut j = 0;
        while j < CURVE_NODES {
            let share = if j == 0 { 1.0 } else { 2.0 };
            rows[k][j] = share / CURVE_NODES as f64 * cosine(j * (2 * k + 1));
            j += 1;
        }
        k += 1;
    }
    rows
};

/// Four smooth functions of slip as sums of Chebyshev polynomials.
pub(super) struct Smooth {
    coefficients: [[f64; CURVE_NODES]; 4],
    middle: f64,
    per_half: f64,
}

impl Smooth {
    fn new(values: [&[f64]; 4], (low, high): (f64, f64)) -> Self {
        let mut coefficients = [[0.0; CURVE_NODES]; 4];
        for (sums, values) in coefficients.iter_mut().zip(values) {
            for (value, row) in values.iter().zip(&TRANSFORM) {
                for (sum, share) in sums.iter_mut().zip(row) {
                    *sum += value * share;
                }
            }
        }
        Self {
            coefficients,
            middle: 0.5 * (low + high),
            per_half: 2.0 / (high - low),
        }
    }

    /// What the searches of a chunk's points end with, interpolated; `None` where it is not worth while or a
    /// node has no solution.
    pub(super) fn of(chunk: &mut Chunk<'_>, sheet: &mut LoadSheet, level: Level) -> Option<Self> {
        let inputs = chunk.inputs;
        let good = inputs
            .slip
            .iter()
            .filter(|slip| (0.0..=1.0).contains(*slip));
        let (low, high) = good.fold((1.0, 0.0), |(low, high): (f64, f64), &slip| {
            (low.min(slip), high.max(slip))
        });
        if inputs.len() < MIN_CURVE_POINTS || !(high - low > 1e-3) {
            return None;
        }
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let slip: [f64; CURVE_NODES] = core::array::from_fn(|k| middle + half * cosine(2 * k + 1));
        let [
            mut sinkage,
            mut vertical_force,
            mut drawbar_pull,
            mut torque,
        ] = [[0.0; CURVE_NODES]; 4];
        let mut status = [SolveStatus::NotConverged; CURVE_NODES];
        let mut nodes = Chunk {
            prepared: chunk.prepared,
            inputs: Inputs {
                radius: &inputs.radius[..CURVE_NODES],
                width: &inputs.width[..CURVE_NODES],
                rebound: &inputs.rebound[..CURVE_NODES],
                slip: &slip,
                given: &inputs.given[..CURVE_NODES],
            },
            plan: &mut *chunk.plan,
            out: BatchColumns {
                sinkage: &mut sinkage,
                vertical_force: &mut vertical_force,
                drawbar_pull: &mut drawbar_pull,
                torque: &mut torque,
                status: &mut status,
            },
        };
        level.load(&mut nodes, sheet, Start::Keeping);
        (status == [SolveStatus::Solved; CURVE_NODES]).then(|| {
            let values = sheet.kept.each_ref().map(|column| &column.0[..]);
            Self::new(values, (low, high))
        })
    }

    /// x, dx/d ln W and the slopes of DP/W and T/(r W) at eight slips, by Clenshaw's sum.
    #[inline(always)]
    pub(super) fn at<V: Vector>(&self, slip: V) -> [V; 4] {
        let t = (slip - V::from_f64(self.middle)) * V::from_f64(self.per_half);
        let twice = t + t;
        let mut out = [V::ZERO; 4];
        for (out, coefficients) in out.iter_mut().zip(&self.coefficients) {
            let (mut b, mut after) = (V::ZERO, V::ZERO);
            for &c in coefficients[1..].iter().rev() {
                (b, after) = (twice.mul_add(b, V::from_f64(c) - after), b);
            }
            *out = t.mul_add(b, V::from_f64(coefficients[0]) - after);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::super::Lanes;
    use super::*;

    #[test]
    fn smooth_functions_come_back() {
        let (low, high) = (0.1, 0.7);
        let slip: [f64; CURVE_NODES] = core::array::from_fn(|k| {
            0.4 + 0.3 * (core::f64::consts::PI * (k as f64 + 0.5) / CURVE_NODES as f64).cos()
        });
        let values = slip.map(|s| (3.0 * s).exp());
        let smooth = Smooth::new([&values, &slip, &values, &values], (low, high));
        for i in 0..=60 {
            let s = 0.1 + 0.01 * f64::from(i);
            let [exponential, line, ..] = smooth.at(Lanes([s; 8]));
            // eight points leave 2 e^2.1 0.9⁸/8!/2⁸ of it
            assert!((exponential.0[0] - (3.0 * s).exp()).abs() < 7e-7);
            assert!((line.0[7] - s).abs() < 1e-14);
        }
    }
}
