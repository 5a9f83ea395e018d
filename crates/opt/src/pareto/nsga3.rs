//! NSGA-III: survival by rank, then by an even spread over reference directions.
//!
//! Source: Deb & Jain 2014, IEEE Trans. Evol. Comput. 18 (part I); constraints after Jain & Deb 2014 (part II).

use super::population::{Individual, fronts};
use crate::random::Random;

/// What the survival remembers from generation to generation.
#[derive(Clone, Debug)]
pub(super) struct Normalisation {
    /// The best value of each objective ever seen.
    ideal: Vec<f64>,
    /// The points that are best along each axis.
    extremes: Vec<Vec<f64>>,
}

impl Normalisation {
    pub(super) fn new(objectives: usize) -> Self {
        Self {
            ideal: vec![f64::INFINITY; objectives],
            extremes: Vec::new(),
        }
    }

    /// Learns from the nondominated points; gives the ideal point and the scale of each objective.
    fn update(&mut self, nondominated: &[&[f64]]) -> (Vec<f64>, Vec<f64>) {
        let m = self.ideal.len();
        for f in nondominated {
            for (best, f) in self.ideal.iter_mut().zip(*f) {
                *best = best.min(*f);
            }
        }
        let candidates: Vec<&[f64]> = self
            .extremes
            .iter()
            .map(Vec::as_slice)
            .chain(nondominated.iter().copied())
            .collect();
        let reach = |f: &[f64], axis: usize| {
            f.iter()
                .zip(&self.ideal)
                .enumerate()
                .map(|(k, (f, best))| (f - best) * if k == axis { 1.0 } else { 1e6 })
                .fold(f64::NEG_INFINITY, f64::max)
        };
        let extremes: Vec<Vec<f64>> = (0..m)
            .filter_map(|axis| {
                candidates
                    .iter()
                    .min_by(|a, b| reach(a, axis).total_cmp(&reach(b, axis)))
                    .map(|f| f.to_vec())
            })
            .collect();
        self.extremes = extremes;
        let worst: Vec<f64> = (0..m)
            .map(|k| {
                let greatest = nondominated.iter().map(|f| f[k]);
                greatest.fold(f64::NEG_INFINITY, f64::max) - self.ideal[k]
            })
            .collect();
        let scale = intercepts(&self.extremes, &self.ideal).unwrap_or_else(|| worst.clone());
        // An intercept beyond everything known, or of no extent, has no meaning.
        let scale = scale
            .iter()
            .zip(&worst)
            .map(|(&s, &w)| {
                if s > 1e-6 && s <= 10.0 * w.max(1e-12) {
                    s
                } else {
                    w.max(1e-12)
                }
            })
            .collect();
        (self.ideal.clone(), scale)
    }
}

/// Where the plane through the extreme points cuts the axes, measured from the ideal point.
fn intercepts(extremes: &[Vec<f64>], ideal: &[f64]) -> Option<Vec<f64>> {
    let m = ideal.len();
    // Σ_k a_k (f_k − ideal_k) = 1 for each extreme point: Gauss elimination with row exchange.
    let mut rows: Vec<Vec<f64>> = extremes
        .iter()
        .map(|f| {
            let mut row: Vec<f64> = f.iter().zip(ideal).map(|(f, best)| f - best).collect();
            row.push(1.0);
            row
        })
        .collect();
    if rows.len() != m {
        return None;
    }
    for k in 0..m {
        let pivot = (k..m).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
        rows.swap(k, pivot);
        if !(rows[k][k].abs() > 1e-12) {
            return None;
        }
        let pivot_row = rows[k].clone();
        for (i, row) in rows.iter_mut().enumerate() {
            if i != k {
                let factor = row[k] / pivot_row[k];
                for (entry, pivot) in row.iter_mut().zip(&pivot_row) {
                    *entry -= factor * pivot;
                }
            }
        }
    }
    let cuts: Vec<f64> = (0..m).map(|k| rows[k][k] / rows[k][m]).collect();
    cuts.iter()
        .all(|c| c.is_finite() && *c > 0.0)
        .then_some(cuts)
}

/// The `count` survivors of a population.
pub(super) fn survive(
    population: Vec<Individual>,
    count: usize,
    directions: &[Vec<f64>],
    memory: &mut Normalisation,
    random: &mut Random,
) -> Vec<Individual> {
    let all = fronts(&population);
    let feasible = |i: &usize| population[*i].violation == 0.0;
    let best: Vec<&[f64]> = all
        .first()
        .into_iter()
        .flatten()
        .filter(|i| feasible(i))
        .map(|&i| population[i].objectives.as_slice())
        .collect();
    let mut kept: Vec<usize> = Vec::with_capacity(count);
    let mut last: Vec<usize> = Vec::new();
    for front in all {
        if kept.len() + front.len() > count {
            last = front;
            break;
        }
        kept.extend(front);
    }
    if kept.len() < count {
        if best.is_empty() {
            // Nothing feasible yet: the fronts are ordered by violation alone.
            last.truncate(count - kept.len());
            kept.extend(last);
        } else {
            let (ideal, scale) = memory.update(&best);
            let near = |i: usize| nearest(&population[i].objectives, &ideal, &scale, directions);
            let mut crowd = vec![0_usize; directions.len()];
            for &i in &kept {
                crowd[near(i).0] += 1;
            }
            let places: Vec<(usize, (usize, f64))> = last.iter().map(|&i| (i, near(i))).collect();
            fill(&mut kept, count, places, crowd, random);
        }
    }
    let mut slots: Vec<Option<Individual>> = population.into_iter().map(Some).collect();
    kept.into_iter().filter_map(|i| slots[i].take()).collect()
}

/// Niching: the direction with the fewest survivors takes its next point.
fn fill(
    kept: &mut Vec<usize>,
    count: usize,
    mut places: Vec<(usize, (usize, f64))>,
    mut crowd: Vec<usize>,
    random: &mut Random,
) {
    let mut open: Vec<bool> = vec![true; crowd.len()];
    while kept.len() < count {
        let Some(least) = (0..crowd.len())
            .filter(|&d| open[d])
            .map(|d| crowd[d])
            .min()
        else {
            return;
        };
        let emptiest: Vec<usize> = (0..crowd.len())
            .filter(|&d| open[d] && crowd[d] == least)
            .collect();
        let direction = emptiest[random.below(emptiest.len())];
        let mine: Vec<usize> = (0..places.len())
            .filter(|&p| places[p].1.0 == direction)
            .collect();
        let Some(&pick) = (if crowd[direction] == 0 {
            mine.iter()
                .min_by(|&&a, &&b| places[a].1.1.total_cmp(&places[b].1.1))
        } else {
            mine.get(random.below(mine.len()))
        }) else {
            open[direction] = false;
            continue;
        };
        kept.push(places.remove(pick).0);
        crowd[direction] += 1;
    }
}

/// The direction whose line from the ideal point passes nearest, and its distance.
pub(super) fn nearest(
    objectives: &[f64],
    ideal: &[f64],
    scale: &[f64],
    directions: &[Vec<f64>],
) -> (usize, f64) {
    let point: Vec<f64> = objectives
        .iter()
        .zip(ideal.iter().zip(scale))
        .map(|(f, (best, s))| (f - best) / s)
        .collect();
    let square: f64 = point.iter().map(|p| p * p).sum();
    let mut best = (0, f64::INFINITY);
    for (index, direction) in directions.iter().enumerate() {
        let (mut along, mut length) = (0.0, 0.0);
        for (p, d) in point.iter().zip(direction) {
            along += p * d;
            length += d * d;
        }
        let distance = square - along * along / length;
        if distance < best.1 {
            best = (index, distance);
        }
    }
    best
}

#[cfg(test)]
#[path = "nsga3_tests.rs"]
mod tests;
