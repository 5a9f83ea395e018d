//! The pass back over a tape: the disturbance smoother of de Jong (1989) and Koopman (1993).
//!
//! r is the gradient of the log-likelihood by the state, N the variance of r. The smoothed state is x + P r, its covariance
//! P − P N P. No covariance is inverted, so that numbers without any variance are allowed.

use alloc::vec;
use alloc::vec::Vec;

use grouser_real::Real;

use crate::motion::{Belief, Correction, Entry, KINDS, Noise, Row, SIZE, Tape, dot};

/// A reading against what all other readings predict: the reading less its prediction is u/m, with a variance of 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Index of the step.
    pub step: usize,
    /// Index of the reading in the step.
    pub reading: usize,
    /// The smoothing error u.
    pub u: f64,
    /// Its variance m.
    pub m: f64,
}

/// What the pass back found.
#[derive(Clone, Debug)]
pub struct Back {
    /// For each kind of noise the sum of r² and of its expectation N (of u² and m for a measurement), each times its exposure:
    /// they are equal where the level is the most likely one.
    pub scores: [[f64; 2]; KINDS],
    /// For each step r and N of a shock to the slip.
    pub shocks: Vec<[f64; 2]>,
    /// The readings, the last one first.
    pub residuals: Vec<Residual>,
    /// The log-likelihood of all innovations, up to a constant.
    pub likelihood: f64,
}

/// r and N.
struct Gradient {
    r: Row,
    n: [Row; SIZE],
}

impl Gradient {
    /// Over a scalar measurement; returns u and m.
    fn update(&mut self, correction: &Correction) -> (f64, f64) {
        let (row, gain) = (&correction.row, &correction.gain);
        let spread: Row = core::array::from_fn(|i| dot(&self.n[i], gain));
        let u = correction.innovation / correction.variance - dot(gain, &self.r);
        let m = 1.0 / correction.variance + dot(gain, &spread);
        for i in 0..SIZE {
            self.r[i] += row[i] * u;
            for j in 0..SIZE {
                self.n[i][j] += row[i] * row[j] * m - row[i] * spread[j] - spread[i] * row[j];
            }
        }
        (u, m)
    }

    /// Over one row of the transition: r ← Fᵀ r, N ← Fᵀ N F.
    fn propagate(&mut self, index: usize, row: &Row) {
        let own = self.n[index][index];
        let r = core::mem::take(&mut self.r[index]);
        let mut column: Row = core::array::from_fn(|j| self.n[j][index]);
        column[index] = 0.0;
        for j in 0..SIZE {
            self.n[index][j] = 0.0;
            self.n[j][index] = 0.0;
        }
        for j in 0..SIZE {
            self.r[j] += row[j] * r;
            for k in 0..SIZE {
                self.n[j][k] += row[j] * column[k] + column[j] * row[k] + own * row[j] * row[k];
            }
        }
    }

    /// x + P r and P − P N P.
    fn smoothed(&self, belief: &Belief) -> Belief {
        let p = &belief.covariance;
        let mut out = *belief;
        let np: [Row; SIZE] = core::array::from_fn(|i| {
            core::array::from_fn(|j| (0..SIZE).map(|k| self.n[i][k] * p[k][j]).sum())
        });
        for (i, row) in p.iter().enumerate() {
            out.mean[i] += dot(row, &self.r);
            for (j, value) in out.covariance[i].iter_mut().enumerate() {
                *value -= row.iter().zip(&np).map(|(p, np)| p * np[j]).sum::<f64>();
            }
        }
        out
    }
}

/// The smoothed belief at each step's end.
#[must_use]
pub fn smoothed(tape: &Tape) -> Vec<Belief> {
    let mut out = tape.ends.clone();
    pass(tape, |step, gradient| {
        out[step] = gradient.smoothed(&out[step]);
    });
    out
}

/// What the pass back over the tape finds.
#[must_use]
pub fn back(tape: &Tape) -> Back {
    pass(tape, |_, _| ())
}

/// Passes back over the tape; `at_end` is shown r and N at each step's end.
fn pass(tape: &Tape, mut at_end: impl FnMut(usize, &Gradient)) -> Back {
    let steps = tape.ends.len();
    let mut out = Back {
        scores: [[0.0; 2]; KINDS],
        shocks: vec![[0.0; 2]; steps],
        residuals: Vec::new(),
        likelihood: 0.0,
    };
    let mut gradient = Gradient {
        r: [0.0; SIZE],
        n: [[0.0; SIZE]; SIZE],
    };
    let mut step = steps;
    for entry in tape.entries.iter().rev() {
        match entry {
            Entry::End => {
                step -= 1;
                at_end(step, &gradient);
            }
            Entry::Update {
                noise,
                correction,
                variance,
                reading,
            } => {
                let (u, m) = gradient.update(correction);
                let (innovation, total) = (correction.innovation, correction.variance);
                out.likelihood -= 0.5 * (innovation * innovation / total + Real::ln(total));
                let score = &mut out.scores[*noise as usize];
                score[0] += u * u * variance;
                score[1] += m * variance;
                if let Some(reading) = *reading {
                    out.residuals.push(Residual {
                        step,
                        reading,
                        u,
                        m,
                    });
                }
            }
            Entry::Propagate { index, row } => gradient.propagate(*index, row),
            Entry::Noise {
                noise,
                index,
                exposure,
            } => {
                let (r, n) = (gradient.r[*index], gradient.n[*index][*index]);
                let score = &mut out.scores[*noise as usize];
                score[0] += r * r * exposure;
                score[1] += n * exposure;
                if *noise == Noise::Slip && *exposure > 0.0 {
                    out.shocks[step.saturating_sub(1)] = [r, n];
                }
            }
        }
    }
    out
}
