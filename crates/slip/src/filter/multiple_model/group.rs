//! Hypotheses about how slip changes that belong together: one alone; some that may follow one another (interacting multiple
//! models: Blom and Bar-Shalom, IEEE TAC 33, 1988); or one for each time at which slip may have jumped last (Bayesian online
//! change-point detection: Adams and MacKay, arXiv:0710.3742, 2007).

use alloc::boxed::Box;

use grouser_real::Real;

use super::model::{Model, Since};

/// Models that follow one another.
pub(super) const INTERACTING: usize = 3;
/// Hypotheses of the last jump, that of a jump now among them: of earlier jumps one is left after some readings.
const JUMP_TIMES: usize = 5;
const MAX_MODELS: usize = JUMP_TIMES;
/// Smallest weight of a model: no hypothesis is ever ruled out.
const MIN_WEIGHT: f64 = 1e-6;
/// Likelihoods are at least this, so that their logarithm is finite.
const MIN_LIKELIHOOD: f64 = 1e-200;
/// Models are mixed this often, s: much faster than they change into one another.
const MIXING_PERIOD_S: f64 = 0.02;
/// Jumps less than this apart count as one, s, and a jump within a gap of the reference has at most this probability.
const MIN_JUMP_PERIOD_S: f64 = 0.1;
const MAX_JUMP_PROBABILITY: f64 = 0.3;

/// Memory of a group's evidence, s. Over logs of an independent world half as long a memory costs 2 % of RMSE, and one of 40 s
/// costs where the ground changes.
const EVIDENCE_MEMORY_S: f64 = 13.0;

/// Rates of change from one model to another, 1/s.
pub(super) type Rates = [[f64; INTERACTING]; INTERACTING];

/// How the models of a group follow one another.
#[derive(Clone, Debug)]
enum Succession {
    Lone,
    Interacting {
        rates: Rates,
        mixed_s: f64,
    },
    /// The first model is that slip jumps now; the others jumped at a time each, and have been steady since.
    Jumps {
        rate_per_s: f64,
        since_s: f64,
    },
}

/// Models of one group with their weights.
#[derive(Clone, Debug)]
pub(super) struct Group {
    models: Box<[Model]>,
    weights: [f64; MAX_MODELS],
    succession: Succession,
    /// Logarithm of the likelihood of the readings so far, with forgetting.
    pub(super) log_evidence: f64,
    /// Does it use the accelerometer?
    pub(super) is_inertial: bool,
}

impl Group {
    /// A lone model.
    pub(super) fn lone(slip_noise: f64, bias_noise: Option<f64>) -> Self {
        Self::of(&[slip_noise], bias_noise, Succession::Lone)
    }

    /// Models that change into one another at these rates, 1/s.
    pub(super) fn interacting(
        slip_noise: [f64; INTERACTING],
        bias_noise: Option<f64>,
        rates: Rates,
    ) -> Self {
        let mixed_s = 0.0;
        Self::of(
            &slip_noise,
            bias_noise,
            Succession::Interacting { rates, mixed_s },
        )
    }

    /// Slip that jumps at this rate, 1/s, and is steady otherwise, with the process noise densities of both, 1/√s.
    pub(super) fn jumps(steady: f64, jump: f64, rate_per_s: f64) -> Self {
        let mut slip_noise = [steady; JUMP_TIMES];
        slip_noise[0] = jump;
        let since_s = 0.0;
        Self::of(
            &slip_noise,
            None,
            Succession::Jumps {
                rate_per_s,
                since_s,
            },
        )
    }

    fn of(slip_noise: &[f64], bias_noise: Option<f64>, succession: Succession) -> Self {
        Self {
            models: slip_noise
                .iter()
                .map(|noise| Model::new(*noise, bias_noise.unwrap_or(0.0)))
                .collect(),
            weights: [1.0 / slip_noise.len() as f64; MAX_MODELS],
            succession,
            log_evidence: 0.0,
            is_inertial: bias_noise.is_some(),
        }
    }

    pub(super) fn models(&self) -> impl Iterator<Item = (&Model, f64)> {
        self.models.iter().zip(self.weights)
    }

    /// Changes every model.
    pub(super) fn each(&mut self, change: impl Fn(&mut Model)) {
        self.models.iter_mut().for_each(change);
    }

    /// Weighs the models by the likelihood that each returns; returns the group's own.
    pub(super) fn weigh(&mut self, take: impl Fn(&mut Model) -> f64) -> f64 {
        let mut total = 0.0;
        for (model, weight) in self.models.iter_mut().zip(&mut self.weights) {
            *weight *= take(model).max(MIN_LIKELIHOOD);
            total += *weight;
        }
        let mut sum = 0.0;
        for weight in &mut self.weights[..self.models.len()] {
            *weight = (*weight / total).max(MIN_WEIGHT);
            sum += *weight;
        }
        for weight in &mut self.weights[..self.models.len()] {
            *weight /= sum;
        }
        total
    }

    /// As [`Group::weigh`], and the group itself is judged by it unless the rims stand.
    pub(super) fn weigh_and_score(&mut self, stands: bool, take: impl Fn(&mut Model) -> f64) {
        let likelihood = self.weigh(take);
        if !stands {
            self.log_evidence += Real::ln(likelihood.max(MIN_LIKELIHOOD));
        }
    }

    /// Lets models change into one another over `dt` (s).
    pub(super) fn mix(&mut self, dt: f64) {
        match &mut self.succession {
            Succession::Lone => {}
            Succession::Jumps { since_s, .. } => *since_s += dt,
            Succession::Interacting { rates, mixed_s } => {
                *mixed_s += dt;
                if *mixed_s >= MIXING_PERIOD_S {
                    let (rates, dt) = (*rates, mixed_s.min(0.2));
                    *mixed_s = 0.0;
                    self.interact(&rates, dt);
                }
            }
        }
    }

    /// Lets slip change and the evidence fade as within `seconds`.
    pub(super) fn pass_time(&mut self, seconds: f64) {
        self.each(|model| model.pass_time(seconds));
        self.fade(seconds);
        match &mut self.succession {
            Succession::Lone => {}
            Succession::Jumps { since_s, .. } => *since_s += seconds,
            Succession::Interacting { rates, .. } => {
                let rates = *rates;
                self.interact(&rates, seconds);
            }
        }
    }

    /// Forgets evidence over `seconds`.
    pub(super) fn fade(&mut self, seconds: f64) {
        self.log_evidence *= Real::exp(-seconds / EVIDENCE_MEMORY_S);
    }

    fn interact(&mut self, rates: &Rates, dt: f64) {
        let mut old = [self.models[0]; INTERACTING];
        old.copy_from_slice(&self.models);
        let mut mixing = [[0.0; INTERACTING]; INTERACTING];
        let mut weights = [0.0; INTERACTING];
        for (i, row) in mixing.iter_mut().enumerate() {
            let mut stays = 1.0;
            for j in (0..INTERACTING).filter(|j| *j != i) {
                let goes = (rates[i][j] * dt).min(0.4);
                stays -= goes;
                row[j] = goes * self.weights[i];
            }
            row[i] = stays * self.weights[i];
            for (weight, share) in weights.iter_mut().zip(row) {
                *weight += *share;
            }
        }
        for (j, weight) in weights.into_iter().enumerate() {
            let shares: [f64; INTERACTING] =
                core::array::from_fn(|i| mixing[i][j] / weight.max(MIN_LIKELIHOOD));
            self.models[j].blend(&old, &shares);
            self.weights[j] = weight;
        }
    }

    /// After a reading of the reference: a jump before it becomes one of the hypotheses, in the place of the least probable one,
    /// and another jump may have begun from all of them `since` it was taken.
    pub(super) fn pass_jump(&mut self, since: &Since) {
        let Succession::Jumps {
            rate_per_s,
            since_s,
        } = &mut self.succession
        else {
            return;
        };
        if *since_s < MIN_JUMP_PERIOD_S {
            return;
        }
        let probability = (*rate_per_s * *since_s).min(MAX_JUMP_PROBABILITY);
        *since_s = 0.0;
        let least = (1..self.models.len()).fold(1, |least, i| {
            if self.weights[i] < self.weights[least] {
                i
            } else {
                least
            }
        });
        let mut jump = self.models[0];
        if self.weights[0] > self.weights[least] {
            self.models[least].adopt(&jump);
            self.weights[least] = self.weights[0];
        }
        let total: f64 = self.weights[1..self.models.len()].iter().sum();
        let weights = self.weights.map(|weight| weight / total);
        jump.blend(&self.models[1..], &weights[1..]);
        self.models[0] = jump;
        self.models[0].change_since(since);
        self.weights = weights.map(|weight| (1.0 - probability) * weight);
        self.weights[0] = probability;
    }
}

#[cfg(test)]
mod tests;
