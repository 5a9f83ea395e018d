//! Levels of noise by maximum likelihood, jumps of the slip and outliers, over a whole log.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use grouser_real::Real;

use super::back::{Back, Residual, back, smoothed};
use super::jumps::Jumps;
use super::travel::travel;
use crate::motion::{
    Belief, CommonMotion, KINDS, Levels, Motion, Noise, OUTLIER_SIGMA, OUTLIERS, Step, Tape,
};
use crate::speed::Measured;

/// The result of [`fit`].
#[derive(Clone, Debug)]
pub struct Fit {
    /// The most likely levels.
    pub levels: Levels,
    /// The smoothed belief at each step's end.
    pub smoothed: Vec<Belief>,
    /// The wheels' common motion in each step.
    pub common: Vec<CommonMotion>,
    /// The distance in the direction in which the wheels ran, over the steps that are counted, m.
    pub travel: Measured,
    /// Steps at which the slip jumps.
    pub jumps: Vec<usize>,
    /// The log-likelihood less what the jumps cost.
    pub evidence: f64,
    /// The fit with the other prior of the slip, which has less evidence.
    pub other: Option<Box<Self>>,
}

/// A first pass takes readings for this many times as noisy as their prior has them.
const WIDE: f64 = 10.0;
/// The median of χ² with one degree of freedom.
const CHI_SQUARE_MEDIAN: f64 = 0.455;
/// The prior of a level weighs as much as this many readings.
const PRIOR_WEIGHT: f64 = 2.0;
/// No level falls below this: far below any sensor's, in the square of its unit.
const MIN_LEVEL: f64 = 1e-12;
/// Rounds of maximum likelihood; each is one pass forward and one back. More move no figure by 3 %.
const ROUNDS: usize = 10;
/// Rounds in which the slip keeps its prior's level while jumps are looked for, and the first ones without a search.
const JUMP_ROUNDS: usize = 8;
const SETTLING_ROUNDS: usize = 2;
/// The last rounds add no jumps, so that the levels settle.
const LAST_ROUNDS: usize = 3;

/// The steps, and what every pass over them needs.
struct Passes<'a> {
    steps: &'a mut [Step],
    start: Belief,
    learn: [bool; KINDS],
    counted: Range<f64>,
    scratch: Vec<f64>,
    /// The last pass forward.
    tape: Tape,
    common: Vec<CommonMotion>,
}

impl Passes<'_> {
    /// Over all steps and back.
    fn run(&mut self, levels: &Levels, jumps: &Jumps) -> Back {
        self.tape.clear();
        self.common.clear();
        let mut motion = Motion::new(self.start);
        for (step, extra) in self.steps.iter().zip(&jumps.extra) {
            let tape = Some(&mut self.tape);
            motion.advance(step, levels, *extra, &mut self.scratch, tape);
            self.common.push(motion.common);
        }
        back(&self.tape)
    }

    /// First levels of the readings by the median of their errors, from a pass with wide ones: outliers among them drag a first pass
    /// with narrow ones away, and levels that are too small would make outliers of all. Readings far beyond are left out at first.
    fn begin(&mut self, prior: &Levels, jumps: &Jumps) -> Levels {
        let is_learnt = |kind: Noise| !kind.is_process() && self.learn[kind as usize];
        let mut wide = *prior;
        for kind in Noise::ALL.into_iter().filter(|&kind| is_learnt(kind)) {
            wide.0[kind as usize] *= WIDE * WIDE;
        }
        let found = self.run(&wide, jumps);
        let mut levels = *prior;
        let noise_of =
            |steps: &[Step], of: &Residual| steps[of.step].readings[of.reading].value.noise();
        for kind in Noise::ALL {
            let of_kind = (found.residuals.iter()).filter(|of| noise_of(self.steps, of) == kind);
            let mut squares: Vec<f64> = of_kind.map(|of| of.u * of.u / of.m).collect();
            squares.sort_unstable_by(f64::total_cmp);
            if let Some(median) = squares.get(squares.len() / 2) {
                let level = &mut levels.0[kind as usize];
                *level = level.max(wide.of(kind) * median / CHI_SQUARE_MEDIAN);
            }
        }
        for of in &found.residuals {
            let level = levels.of(noise_of(self.steps, of));
            let square = of.u * of.u / (of.m * of.m);
            if square > OUTLIER_SIGMA * OUTLIER_SIGMA * level {
                self.steps[of.step].readings[of.reading].scale = square / level;
            }
        }
        levels
    }

    /// Gives each reading the variance that it deserves by what all other readings predict.
    fn weigh(&mut self, found: &Back, levels: &Levels) {
        // step, reading, gain in log-likelihood as an outlier, squared error over the level
        let mut gains: Vec<(usize, usize, f64, f64)> = Vec::new();
        for residual in &found.residuals {
            let (step, reading) = (residual.step, residual.reading);
            let error = residual.u / residual.m;
            let level = levels.of(self.steps[step].readings[reading].value.noise());
            let wide = 1.0 / residual.m + OUTLIER_SIGMA * OUTLIER_SIGMA * level;
            let (square, m) = (error * error, residual.m);
            let gain = 0.5 * (square * m - square / wide - Real::ln(wide * m));
            let size = square / level;
            match gains.last_mut() {
                // x and y of one place are outliers together
                Some(last) if (last.0, last.1) == (step, reading) => {
                    last.2 += gain;
                    last.3 = last.3.max(size);
                }
                _ => gains.push((step, reading, gain, size)),
            }
        }
        for (step, reading, gain, size) in gains {
            let odds = Real::exp((gain + Real::ln(OUTLIERS / (1.0 - OUTLIERS))).clamp(-50.0, 50.0));
            let share = odds / (1.0 + odds);
            // an outlier's variance is its own squared error, where that is larger
            let outlier = (OUTLIER_SIGMA * OUTLIER_SIGMA).max(size);
            self.steps[step].readings[reading].scale = 1.0 / (1.0 - share + share / outlier);
        }
    }

    /// One round of maximum likelihood, of all levels but one.
    fn learn(&self, found: &Back, levels: &mut Levels, kept: Option<Noise>) {
        for kind in Noise::ALL {
            if !self.learn[kind as usize] || kept == Some(kind) {
                continue;
            }
            let level = levels.of(kind);
            let scale = if kind.is_process() { level } else { 1.0 };
            let [found, expected] = found.scores[kind as usize].map(|score| score * scale);
            let ratio = (found + PRIOR_WEIGHT) / (expected + PRIOR_WEIGHT);
            levels.0[kind as usize] = (level * ratio).max(MIN_LEVEL);
        }
    }

    /// Fits levels and outliers of a slip that wanders.
    fn wandering(&mut self, prior: Levels, jumps: Jumps) -> Fit {
        for reading in self.steps.iter_mut().flat_map(|step| &mut step.readings) {
            reading.scale = 1.0;
        }
        let mut levels = self.begin(&prior, &jumps);
        for _ in 1..ROUNDS {
            self.round(&mut levels, &jumps, None);
        }
        self.end(levels, jumps)
    }

    /// Fits levels, outliers and jumps of a slip that is steady between them; `None` where there is no jump. It begins with the levels
    /// and outliers of another fit, but with the slip's `level` of the prior: one that has learnt to wander hides every jump.
    fn jumping(
        &mut self,
        from: Levels,
        level: f64,
        mut jumps: Jumps,
        times: &[f64],
    ) -> Option<Fit> {
        let mut levels = from;
        levels.0[Noise::Slip as usize] = level;
        for round in 0..JUMP_ROUNDS {
            let found = self.round(&mut levels, &jumps, Some(Noise::Slip));
            if round >= SETTLING_ROUNDS && !jumps.find(&found.shocks, times) {
                break;
            }
        }
        if jumps.at.is_empty() {
            return None;
        }
        for round in 1..ROUNDS {
            let found = self.round(&mut levels, &jumps, None);
            if round < ROUNDS - LAST_ROUNDS {
                jumps.find(&found.shocks, times);
            }
        }
        Some(self.end(levels, jumps))
    }

    /// One pass forward and back, from which outliers and all levels but one are learnt.
    fn round(&mut self, levels: &mut Levels, jumps: &Jumps, kept: Option<Noise>) -> Back {
        let found = self.run(levels, jumps);
        self.weigh(&found, levels);
        self.learn(&found, levels, kept);
        found
    }

    /// The last pass.
    fn end(&mut self, levels: Levels, jumps: Jumps) -> Fit {
        let evidence = jumps.evidence(self.run(&levels, &jumps).likelihood);
        let seconds = |(step, common): (&Step, &CommonMotion)| {
            let is_counted = self.counted.contains(&step.time) && step.has_wheels();
            let seconds = if is_counted { step.dt } else { 0.0 };
            seconds.copysign(common.distance)
        };
        let seconds: Vec<f64> = self.steps.iter().zip(&self.common).map(seconds).collect();
        Fit {
            levels,
            smoothed: smoothed(&self.tape),
            common: self.common.clone(),
            travel: travel(&self.tape, &seconds),
            jumps: jumps.at,
            evidence,
            other: None,
        }
    }
}

/// Fits the model to the steps: a slip that wanders, or one that is steady and jumps, whichever has more evidence.
///
/// `learn` says which levels are found; the others keep their prior. Steps with measured wheels that end in
/// `counted` (s) are those of [`Fit::travel`].
#[must_use]
pub fn fit(
    steps: &mut [Step],
    start: Belief,
    prior: Levels,
    learn: [bool; KINDS],
    counted: Range<f64>,
) -> Fit {
    let wheels = steps
        .iter()
        .map(|step| step.wheels.len())
        .max()
        .unwrap_or(0);
    let times: Vec<f64> = steps.iter().map(|step| step.time).collect();
    let readings = steps
        .iter()
        .filter(|step| !step.readings.is_empty())
        .count();
    // without a reference the wheels alone show a jump
    let shown = if readings > 0 { readings } else { steps.len() };
    let mut passes = Passes {
        steps,
        start,
        learn,
        counted,
        scratch: vec![0.0; wheels],
        tape: Tape::default(),
        common: Vec::new(),
    };
    let none = || Jumps::none(times.len(), shown);
    let wandering = passes.wandering(prior, none());
    let level = prior.of(Noise::Slip);
    let Some(jumping) = passes.jumping(wandering.levels, level, none(), &times) else {
        return wandering;
    };
    let (best, other) = if jumping.evidence > wandering.evidence {
        (jumping, wandering)
    } else {
        (wandering, jumping)
    };
    Fit {
        other: Some(Box::new(other)),
        ..best
    }
}
