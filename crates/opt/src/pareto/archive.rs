//! The feasible points of a search for a front: none of them beats a point of the front that is returned.

use std::sync::{Mutex, PoisonError};

use super::FrontPoint;
use super::polish::LEAST_WEIGHT;
use super::population::Individual;
use crate::problem::Problem;
use crate::record::{REFUTING_DECREASE, Record};

/// So many points are kept before those that a generation beats are dropped: some megabytes.
const FIRST_LIMIT: usize = 16_384;

pub(super) struct Archive<'p> {
    problem: &'p Problem<'p>,
    /// The points, and how many there may be before some are dropped.
    kept: Mutex<(Vec<Individual>, usize)>,
}

impl Record for Archive<'_> {
    fn note(&self, x: &[f64], functions: &[f64]) {
        let is_inside = |(x, v): (&f64, &crate::problem::Variable)| (v.lower..=v.upper).contains(x);
        if !x.iter().zip(self.problem.variables()).all(is_inside) {
            return;
        }
        let own = Individual::new(self.problem, x.to_vec(), functions.to_vec());
        if own.violation == 0.0 {
            let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            kept.0.push(own);
        }
    }
}

/// An end of a front that is worse by no more than this share of 1 + |f| is kept: polishing leaves a half of it open
/// ([`LEAST_WEIGHT`]).
const END_SHARE: f64 = 2.0 * LEAST_WEIGHT;

/// Is `value` less than another one by more than this share?
fn is_less(value: f64, than: f64, share: f64) -> bool {
    value < than - share * (1.0 + than.abs())
}

impl<'p> Archive<'p> {
    pub(super) fn new(problem: &'p Problem<'p>) -> Self {
        let kept = Mutex::new((Vec::new(), FIRST_LIMIT));
        Self { problem, kept }
    }

    /// Drops what the population beats, where many points are kept.
    pub(super) fn prune(&self, population: &[Individual]) {
        let mut locked = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let (kept, limit) = &mut *locked;
        if kept.len() > *limit {
            kept.retain(|own| !population.iter().any(|other| other.dominates(own)));
            *limit = FIRST_LIMIT.max(2 * kept.len());
        }
    }

    /// Puts the best point that beats it in the place of each of these, and adds the least value of each objective.
    pub(super) fn improve(&self, points: &mut Vec<FrontPoint>) {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let best = |beats: &dyn Fn(&[f64]) -> bool, rank: &dyn Fn(&[f64]) -> f64| {
            let beating = kept.0.iter().filter(|own| beats(&own.objectives));
            let sum = |own: &Individual| own.objectives.iter().sum::<f64>();
            let found = beating.min_by(|a, b| {
                let by_rank = rank(&a.objectives).total_cmp(&rank(&b.objectives));
                let by_sum = by_rank.then(sum(a).total_cmp(&sum(b)));
                by_sum.then_with(|| a.x.partial_cmp(&b.x).unwrap_or(core::cmp::Ordering::Equal))
            })?;
            Some(FrontPoint {
                x: found.x.clone(),
                objectives: found.objectives.clone(),
                multipliers: None,
            })
        };
        for point in points.iter_mut() {
            let beats = |own: &[f64]| {
                let pairs = || own.iter().zip(&point.objectives);
                pairs().all(|(a, b)| a <= b)
                    && pairs().any(|(a, b)| is_less(*a, *b, REFUTING_DECREASE))
            };
            if let Some(better) = best(&beats, &|own| own.iter().sum()) {
                *point = better;
            }
        }
        for k in 0..self.problem.objectives().len() {
            let least = points.iter().map(|point| point.objectives[k]);
            let least = least.fold(f64::INFINITY, f64::min);
            points.extend(best(&|own| is_less(own[k], least, END_SHARE), &|own| {
                own[k]
            }));
        }
    }
}
