//! One belief a mode: mixed, passed over a step, weighed.

use alloc::vec;
use alloc::vec::Vec;
use core::array;

use super::learnt::LearntNoise;
use super::refused::Refused;
use super::table::{MODES, WALKS, mixed, weighed};
use super::wheel::{OwnSlip, WheelSlip};
use crate::motion::{
    Belief, CommonMotion, Evidence, Levels, Motion, Noise, Record, Row, SIZE, Step,
};

/// The filter over the modes. Its size is fixed once it is made.
#[derive(Clone, Debug)]
pub struct ModeFilter {
    motions: [Motion; MODES],
    weights: [f64; MODES],
    belief: Belief,
    noise: LearntNoise,
    own: Vec<OwnSlip>,
    scratch: Vec<f64>,
}

impl ModeFilter {
    /// Before the first step. The level of the slip's random walk is each mode's own.
    #[must_use]
    pub fn new(start: Belief, levels: Levels, wheels: usize) -> Self {
        Self {
            motions: array::from_fn(|_| Motion::new(start)),
            weights: [1.0 / MODES as f64; MODES],
            belief: start,
            noise: LearntNoise::new(levels),
            own: vec![OwnSlip::default(); wheels],
            scratch: vec![0.0; wheels],
        }
    }

    /// Passes over one step. A step that is refused changes nothing.
    ///
    /// # Errors
    /// [`Refused`] where a number is not finite or not positive, or the number of wheels is another one.
    pub fn advance(&mut self, step: &Step) -> Result<(), Refused> {
        Refused::check(step, self.own.len())?;
        let (weights, shares) = mixed(&self.weights, step.dt);
        let beliefs: [Belief; MODES] = array::from_fn(|to| self.merged(&shares[to]));
        let mut evidence = [Evidence::default(); MODES];
        for (mode, motion) in self.motions.iter_mut().enumerate() {
            motion.belief = beliefs[mode];
            let mut levels = *self.noise.levels();
            levels.0[Noise::Slip as usize] = WALKS[mode] * WALKS[mode];
            let record = Record::Evidence(&mut evidence[mode]);
            motion.pass(step, &levels, 0.0, &mut self.scratch, record);
            motion.belief.floor_variances();
        }
        self.weights = weighed(&weights, &evidence.map(|of| of.likelihood));
        self.noise.learn(&evidence, &self.weights);
        self.belief = self.merged(&self.weights);
        let common = *self.common();
        // without a gyro the turn is that of the wheels themselves
        let turn = step
            .turn
            .map_or(0.0, |_| self.noise.levels().of(Noise::Turn) / step.dt);
        for (own, wheel) in self.own.iter_mut().zip(&step.wheels) {
            own.advance(wheel, step.dt, &self.belief, &common, turn);
        }
        Ok(())
    }

    /// The Gaussian with the moments of the modes' mixture by weights.
    fn merged(&self, weights: &[f64; MODES]) -> Belief {
        let mut out = Belief {
            mean: [0.0; SIZE],
            covariance: [[0.0; SIZE]; SIZE],
        };
        for (weight, motion) in weights.iter().zip(&self.motions) {
            for (out, of) in out.mean.iter_mut().zip(&motion.belief.mean) {
                *out += weight * of;
            }
        }
        for (weight, motion) in weights.iter().zip(&self.motions) {
            let of = &motion.belief;
            let off: Row = array::from_fn(|i| of.mean[i] - out.mean[i]);
            for (i, row) in out.covariance.iter_mut().enumerate() {
                for (j, p) in row.iter_mut().enumerate() {
                    *p += weight * (of.covariance[i][j] + off[i] * off[j]);
                }
            }
        }
        out
    }

    /// The belief with the moments of all modes.
    #[must_use]
    pub const fn belief(&self) -> &Belief {
        &self.belief
    }

    /// The probability of each mode.
    #[must_use]
    pub const fn weights(&self) -> &[f64; MODES] {
        &self.weights
    }

    /// The levels of noise as they are learnt.
    #[must_use]
    pub const fn levels(&self) -> &Levels {
        self.noise.levels()
    }

    /// The wheels' common motion in the last step, by the likeliest mode.
    #[must_use]
    pub fn common(&self) -> &CommonMotion {
        let likeliest = (1..MODES).fold(0, |best, mode| {
            if self.weights[mode] > self.weights[best] {
                mode
            } else {
                best
            }
        });
        &self.motions[likeliest].common
    }

    /// The slip of a wheel at the last step's end; `None` where it did not move in that step, or there is no such wheel.
    #[must_use]
    pub fn wheel_slip(&self, wheel: usize) -> Option<WheelSlip> {
        self.own.get(wheel)?.slip(&self.belief)
    }

    /// The probability that the slip of a wheel exceeds a limit; `None` as in [`Self::wheel_slip`], and for a limit outside [−1, 1].
    #[must_use]
    pub fn exceeds(&self, wheel: usize, limit: f64) -> Option<f64> {
        let own = self.own.get(wheel)?;
        own.slip(&self.belief)?;
        let of_modes = self.weights.iter().zip(&self.motions);
        let probability = of_modes
            .map(|(weight, motion)| weight * own.exceeds(&motion.belief, limit))
            .sum();
        (-1.0..=1.0).contains(&limit).then_some(probability)
    }
}
