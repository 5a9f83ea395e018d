//! Individuals, their evaluation, and who dominates whom.

use rayon::prelude::*;

use crate::problem::{Problem, Relation};

/// A point of the search with everything known about it.
#[derive(Clone, Debug)]
pub(super) struct Individual {
    pub(super) x: Vec<f64>,
    /// The objectives, |f| where absolute.
    pub(super) objectives: Vec<f64>,
    /// The sum of all violations beyond the tolerance; infinite where a function has no value.
    pub(super) violation: f64,
}

impl Individual {
    /// Constrained domination: feasible beats infeasible, less violation beats more, and among the
    /// feasible no worse in every objective and better in one.
    ///
    /// Source: Deb, Pratap, Agarwal & Meyarivan 2002, IEEE Trans. Evol. Comput. 6, section VI.
    pub(super) fn dominates(&self, other: &Self) -> bool {
        if self.violation != other.violation {
            return self.violation < other.violation;
        }
        let mut better = false;
        for (a, b) in self.objectives.iter().zip(&other.objectives) {
            if a > b {
                return false;
            }
            better |= a < b;
        }
        better
    }
}

/// Evaluates points, on all threads where that pays.
pub(super) fn evaluate(problem: &Problem<'_>, points: Vec<Vec<f64>>) -> Vec<Individual> {
    points
        .into_par_iter()
        .with_min_len(16)
        .map(|x| evaluate_one(problem, x))
        .collect()
}

fn evaluate_one(problem: &Problem<'_>, x: Vec<f64>) -> Individual {
    let mut values = vec![f64::NAN; problem.function_count()];
    problem.model().values(&x, &mut values);
    Individual::new(problem, x, values)
}

impl Individual {
    /// From the values of all functions at `x`.
    pub(super) fn new(problem: &Problem<'_>, x: Vec<f64>, mut values: Vec<f64>) -> Self {
        const FEASIBILITY_TOLERANCE: f64 = 1e-8;
        let m = problem.objectives().len();
        let p = problem.inequalities().len();
        let mut violation = 0.0;
        for (j, &value) in values[m..].iter().enumerate() {
            let off = if j < p { value.max(0.0) } else { value.abs() };
            if off > FEASIBILITY_TOLERANCE {
                violation += off;
            }
        }
        for row in problem.linear() {
            let value: f64 = row.coefficients.iter().zip(&x).map(|(a, x)| a * x).sum();
            let off = match row.relation {
                Relation::AtMost => (value - row.bound).max(0.0),
                Relation::Equal => (value - row.bound).abs(),
            };
            if off > FEASIBILITY_TOLERANCE {
                violation += off;
            }
        }
        for value in &mut values[..problem.absolute()] {
            *value = value.abs();
        }
        if values.iter().any(|v| !v.is_finite()) {
            violation = f64::INFINITY;
        }
        values.truncate(m);
        Self {
            x,
            objectives: values,
            violation,
        }
    }
}

/// Ranks: front 0 is dominated by nobody, front 1 only by front 0, and so on. Each is in rising order.
pub(super) fn fronts(population: &[Individual]) -> Vec<Vec<usize>> {
    let feasible = population.iter().all(|i| i.violation == 0.0);
    if feasible && population.iter().all(|i| i.objectives.len() == 2) {
        fronts_of_two(population)
    } else {
        fronts_by_pairs(population)
    }
}

/// For two objectives by one sweep: with the points in order of the first objective, a front dominates the
/// next point exactly if its last point does (Jensen 2003, IEEE Trans. Evol. Comput. 7).
fn fronts_of_two(population: &[Individual]) -> Vec<Vec<usize>> {
    let at = |i: usize| (population[i].objectives[0], population[i].objectives[1]);
    let mut order: Vec<usize> = (0..population.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (at(a), at(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut fronts: Vec<Vec<usize>> = Vec::new();
    for i in order {
        let rank = fronts.partition_point(|front| {
            front
                .last()
                .is_some_and(|&last| population[last].dominates(&population[i]))
        });
        match fronts.get_mut(rank) {
            Some(front) => front.push(i),
            None => fronts.push(vec![i]),
        }
    }
    for front in &mut fronts {
        front.sort_unstable();
    }
    fronts
}

fn fronts_by_pairs(population: &[Individual]) -> Vec<Vec<usize>> {
    let n = population.len();
    let mut beaten_by = vec![0_usize; n];
    let mut beats: Vec<Vec<usize>> = vec![Vec::new(); n];
    for i in 0..n {
        for j in i + 1..n {
            let (a, b) = (&population[i], &population[j]);
            if a.dominates(b) {
                beats[i].push(j);
                beaten_by[j] += 1;
            } else if b.dominates(a) {
                beats[j].push(i);
                beaten_by[i] += 1;
            }
        }
    }
    let mut current: Vec<usize> = (0..n).filter(|&i| beaten_by[i] == 0).collect();
    let mut all = Vec::new();
    while !current.is_empty() {
        let mut next = Vec::new();
        for &i in &current {
            for &j in &beats[i] {
                beaten_by[j] -= 1;
                if beaten_by[j] == 0 {
                    next.push(j);
                }
            }
        }
        next.sort_unstable();
        all.push(std::mem::replace(&mut current, next));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn the_sweep_ranks_as_the_pairs_do() {
        let mut random = Random::new(3);
        for size in [1, 2, 17, 120] {
            // A coarse grid, so that there are ties and repetitions.
            let mut grid = || (random.uniform() * 12.0).floor();
            let population: Vec<Individual> = (0..size)
                .map(|_| Individual {
                    x: Vec::new(),
                    objectives: vec![grid(), grid()],
                    violation: 0.0,
                })
                .collect();
            assert_eq!(fronts_of_two(&population), fronts_by_pairs(&population));
        }
    }
}
