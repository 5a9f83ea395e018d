//! NSGA-II: survival by rank, then by how empty the neighbourhood is.
//!
//! Source: Deb, Pratap, Agarwal & Meyarivan 2002, IEEE Trans. Evol. Comput. 6. One change: the most
//! crowded point leaves, the crowding of its neighbours is renewed, and so on (Kukkonen & Deb 2006);
//! removing all at once leaves holes where whole clusters go together.

use super::population::{Individual, fronts};
use crate::random::Random;

/// A survivor's place in the tournament.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitness {
    rank: usize,
    crowding: f64,
}

/// The `count` best of a population, with their fitness.
pub(super) fn survive(
    population: Vec<Individual>,
    count: usize,
) -> (Vec<Individual>, Vec<Fitness>) {
    let mut chosen: Vec<(usize, Fitness)> = Vec::with_capacity(count);
    for (rank, front) in fronts(&population).into_iter().enumerate() {
        let room = count - chosen.len();
        if room == 0 {
            break;
        }
        let objectives: Vec<&[f64]> = front
            .iter()
            .map(|&i| population[i].objectives.as_slice())
            .collect();
        for (place, crowding) in thin(&objectives, room) {
            chosen.push((front[place], Fitness { rank, crowding }));
        }
    }
    let mut slots: Vec<Option<Individual>> = population.into_iter().map(Some).collect();
    chosen
        .into_iter()
        .filter_map(|(i, fitness)| slots[i].take().map(|individual| (individual, fitness)))
        .unzip()
}

/// The better of two random individuals.
pub(super) fn tournament(fitness: &[Fitness], random: &mut Random) -> usize {
    let (a, b) = (random.below(fitness.len()), random.below(fitness.len()));
    let (fa, fb) = (fitness[a], fitness[b]);
    let first = fa.rank < fb.rank || (fa.rank == fb.rank && fa.crowding >= fb.crowding);
    if first { a } else { b }
}

/// Thins a front to `count` points, most crowded first; gives the rest with their crowding distances.
fn thin(objectives: &[&[f64]], count: usize) -> Vec<(usize, f64)> {
    let n = objectives.len();
    let m = objectives.first().map_or(0, |f| f.len());
    // For each objective the points in order, as a linked list: removal is then local.
    let (mut before, mut after) = (vec![usize::MAX; n * m], vec![usize::MAX; n * m]);
    let mut widths = vec![0.0; m];
    for k in 0..m {
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| objectives[a][k].total_cmp(&objectives[b][k]));
        for pair in order.windows(2) {
            after[pair[0] * m + k] = pair[1];
            before[pair[1] * m + k] = pair[0];
        }
        widths[k] = objectives[order[n - 1]][k] - objectives[order[0]][k];
    }
    let crowding = |i: usize, before: &[usize], after: &[usize]| -> f64 {
        (0..m)
            .filter(|&k| widths[k] > 0.0)
            .map(|k| {
                let (low, high) = (before[i * m + k], after[i * m + k]);
                if low == usize::MAX || high == usize::MAX {
                    f64::INFINITY
                } else {
                    (objectives[high][k] - objectives[low][k]) / widths[k]
                }
            })
            .sum()
    };
    let mut distance: Vec<f64> = (0..n).map(|i| crowding(i, &before, &after)).collect();
    let mut alive = vec![true; n];
    for _ in count..n {
        let Some(most) = (0..n)
            .filter(|&i| alive[i])
            .min_by(|&a, &b| distance[a].total_cmp(&distance[b]))
        else {
            break;
        };
        alive[most] = false;
        for k in 0..m {
            let (low, high) = (before[most * m + k], after[most * m + k]);
            if low != usize::MAX {
                after[low * m + k] = high;
            }
            if high != usize::MAX {
                before[high * m + k] = low;
            }
        }
        for k in 0..m {
            for neighbour in [before[most * m + k], after[most * m + k]] {
                if neighbour != usize::MAX {
                    distance[neighbour] = crowding(neighbour, &before, &after);
                }
            }
        }
    }
    (0..n)
        .filter(|&i| alive[i])
        .map(|i| (i, distance[i]))
        .collect()
}
