//! Hypotheses that may follow one another: interacting multiple models (Blom and Bar-Shalom, IEEE TAC 33, 1988).

use alloc::boxed::Box;

use grouser_real::Real;

use super::model::Model;

/// The largest number of models of a group.
pub(super) const MAX_MODELS: usize = 3;
/// Smallest weight of a model: no hypothesis is ever ruled out.
const MIN_WEIGHT: f64 = 1e-6;
/// Likelihoods are at least this, so that their logarithm is finite.
const MIN_LIKELIHOOD: f64 = 1e-200;

/// Rates of change from one model to another, 1/s.
type Rates = [[f64; MAX_MODELS]; MAX_MODELS];

/// Models of one group with their weights.
#[derive(Clone, Debug)]
pub(super) struct Group {
    models: Box<[Model]>,
    weights: [f64; MAX_MODELS],
    count: usize,
    /// Rate of change from one model to another, 1/s.
    rates: Rates,
    /// Logarithm of the likelihood of the readings so far, with forgetting.
    pub(super) log_evidence: f64,
    mixed_s: f64,
    /// Does it use the accelerometer?
    pub(super) is_inertial: bool,
}

/// Models are mixed this often, s: much faster than they change into one another.
const MIXING_PERIOD_S: f64 = 0.02;

impl Group {
    /// A lone model.
    pub(super) fn lone(slip_noise: f64, bias_noise: Option<f64>) -> Self {
        Self::of(
            [slip_noise; MAX_MODELS],
            bias_noise,
            [[0.0; MAX_MODELS]; MAX_MODELS],
            1,
        )
    }

    /// Models that change into one another at these rates, 1/s.
    pub(super) fn interacting(
        slip_noise: [f64; MAX_MODELS],
        bias_noise: Option<f64>,
        rates: Rates,
    ) -> Self {
        Self::of(slip_noise, bias_noise, rates, MAX_MODELS)
    }

    fn of(
        slip_noise: [f64; MAX_MODELS],
        bias_noise: Option<f64>,
        rates: Rates,
        count: usize,
    ) -> Self {
        Self {
            models: slip_noise[..count]
                .iter()
                .map(|noise| Model::new(*noise, bias_noise.unwrap_or(0.0)))
                .collect(),
            weights: [1.0 / count as f64; MAX_MODELS],
            count,
            rates,
            log_evidence: 0.0,
            mixed_s: 0.0,
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
        for weight in &mut self.weights[..self.count] {
            *weight = (*weight / total).max(MIN_WEIGHT);
            sum += *weight;
        }
        for weight in &mut self.weights[..self.count] {
            *weight /= sum;
        }
        total
    }

    /// As [`Group::weigh`], and the group itself is judged by it.
    pub(super) fn weigh_and_score(&mut self, take: impl Fn(&mut Model) -> f64) {
        let likelihood = self.weigh(take);
        self.log_evidence += Real::ln(likelihood.max(MIN_LIKELIHOOD));
    }

    /// Lets models change into one another over `dt` (s).
    pub(super) fn mix(&mut self, dt: f64) {
        self.mixed_s += dt;
        if self.count == 1 || self.mixed_s < MIXING_PERIOD_S {
            return;
        }
        let dt = self.mixed_s.min(0.2);
        self.mixed_s = 0.0;
        let mut old = [self.models[0]; MAX_MODELS];
        old[..self.count].copy_from_slice(&self.models);
        let mut mixing = [[0.0; MAX_MODELS]; MAX_MODELS];
        let mut weights = [0.0; MAX_MODELS];
        for (i, row) in mixing.iter_mut().enumerate().take(self.count) {
            let mut stays = 1.0;
            for j in (0..self.count).filter(|j| *j != i) {
                let goes = (self.rates[i][j] * dt).min(0.4);
                stays -= goes;
                row[j] = goes * self.weights[i];
            }
            row[i] = stays * self.weights[i];
            for (weight, share) in weights.iter_mut().zip(row) {
                *weight += *share;
            }
        }
        for j in 0..self.count {
            let shares: [f64; MAX_MODELS] =
                core::array::from_fn(|i| mixing[i][j] / weights[j].max(MIN_LIKELIHOOD));
            self.models[j].blend(&old, &shares, self.count);
            self.weights[j] = weights[j];
        }
    }
}
