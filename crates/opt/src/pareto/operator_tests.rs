//! Operators of the evolution against the distributions and rules that their sources state.

use proptest::prelude::*;

use super::mutation::{Mutation, change, mutate};
use super::nsga2;
use super::nsga3::{Normalisation, nearest, survive};
use super::population::{Individual, evaluate, fronts};
use super::sbx::{Crossover, cross};
use crate::problem::{LinearConstraint, Problem, ProblemParams};
use crate::random::Random;
use crate::{Exact, Functions};
use grouser_real::Scalar;

/// The greatest distance between the distribution of numbers and a distribution function (Kolmogorov); of 4000
/// numbers it exceeds 0.031 once in a thousand.
fn distance(mut numbers: Vec<f64>, distribution: impl Fn(f64) -> f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let n = numbers.len() as f64;
    let off = |(i, x): (usize, &f64)| {
        let p = distribution(*x);
        (p - i as f64 / n)
            .abs()
            .max((p - (i as f64 + 1.0) / n).abs())
    };
    numbers.iter().enumerate().map(off).fold(0.0, f64::max)
}

#[test]
fn children_spread_as_the_polynomial_says() {
    // Deb & Agrawal 1995: density ½ (η + 1) β^η inside and ½ (η + 1) β^−(η + 2) outside, cut at the bounds
    let mut random = Random::new(1);
    for (eta, low, high, lower, upper) in [
        (2.0_f64, 1.0, 2.0, -1e9, 1e9),
        (2.0, 1.0, 2.0, 0.8, 3.0),
        (15.0, -1.0, 3.0, -1.0, 3.5),
        (0.0, 0.0, 1.0, -0.5, 1.25),
    ] {
        let whole = |beta: f64| {
            if beta <= 1.0 {
                0.5 * beta.powf(eta + 1.0)
            } else {
                1.0 - 0.5 * beta.powf(-eta - 1.0)
            }
        };
        let (mut betas, mut swapped, mut crossed) = ([vec![], vec![]], 0, 0);
        for _ in 0..8000 {
            let (mut a, mut b) = ([low], [high]);
            cross(
                Crossover::new(eta, 1.0),
                &mut random,
                (&[lower], &[upper]),
                &mut a,
                &mut b,
            );
            if (a[0], b[0]) == (low, high) {
                continue;
            }
            crossed += 1;
            swapped += u32::from(a[0] > b[0]);
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            betas[0].push((middle - a[0].min(b[0])) / half);
            betas[1].push((a[0].max(b[0]) - middle) / half);
            assert!(a[0].min(b[0]) >= lower && a[0].max(b[0]) <= upper);
        }
        // each variable in half of the pairs, either child first
        assert!((3780..4220).contains(&crossed), "{crossed}");
        assert!(
            (f64::from(swapped) / f64::from(crossed) - 0.5).abs() < 0.03,
            "{swapped}"
        );
        for (betas, room) in betas.into_iter().zip([low - lower, upper - high]) {
            let greatest = 1.0 + 2.0 * room / (high - low);
            let off = distance(betas, |beta| whole(beta) / whole(greatest));
            assert!(off < 0.031, "{eta} {lower}: {off}");
        }
    }
    // both children are as far from the middle where the bounds are as far
    let (mut a, mut b) = ([1.0; 8], [3.0; 8]);
    cross(
        Crossover::new(5.0, 1.0),
        &mut random,
        (&[0.0; 8], &[4.0; 8]),
        &mut a,
        &mut b,
    );
    assert!(a.iter().zip(&b).all(|(a, b)| (a + b - 4.0).abs() < 1e-12) && a != [1.0; 8]);
    // pairs that are left as they are: by chance, and where both parents agree
    let changed = (0..4000).filter(|_| {
        let (mut a, mut b) = ([1.0; 64], [3.0; 64]);
        cross(
            Crossover::new(5.0, 0.3),
            &mut random,
            (&[0.0; 64], &[4.0; 64]),
            &mut a,
            &mut b,
        );
        a != [1.0; 64]
    });
    assert!((changed.count() as f64 / 4000.0 - 0.3).abs() < 0.025);
    // at a bound too; and parents on both sides of zero do not agree
    let mut crossed = |a: f64, b: f64, lower: f64| {
        let (mut a, mut b) = ([a], [b]);
        for _ in 0..99 {
            let bounds = (&[lower][..], &[4.0][..]);
            cross(
                Crossover::new(5.0, 1.0),
                &mut random,
                bounds,
                &mut a,
                &mut b,
            );
        }
        [a[0], b[0]]
    };
    assert_eq!(crossed(2.0, 2.0, 0.0), [2.0; 2]);
    assert_eq!(crossed(0.0, 0.0, 0.0), [0.0; 2]);
    assert_eq!(crossed(1e-14, 0.0, -4.0), [1e-14, 0.0]);
    assert!(crossed(-1.0, 1.0, -4.0)[0].abs() != 1.0);
}

#[test]
fn mutants_spread_as_the_polynomial_says() {
    // Deb & Goyal 1996: half to either side, P(δ < d) = ½ ((1 + d)^(η+1) − r)/(1 − r) below, r the same at the bound
    let mut random = Random::new(2);
    for (eta, x) in [
        (0.0, 0.5),
        (3.0, 0.5),
        (3.0, 0.9),
        (20.0, 0.02),
        (5.0, 0.0),
        (5.0, 1.0),
    ] {
        let (lower, upper) = (-2.0, 6.0);
        let start = lower + 8.0 * x;
        let side = |away: f64, room: f64| {
            let rest = (1.0 - room).powf(eta + 1.0);
            if room == 0.0 {
                0.0
            } else {
                0.5 * ((1.0 - away).powf(eta + 1.0) - rest) / (1.0 - rest)
            }
        };
        let mut deltas = Vec::new();
        for _ in 0..4000 {
            let mut value = start;
            let changed = change(eta, &mut random, (lower, upper), &mut value);
            assert!(changed == (value != start) && (lower..=upper).contains(&value));
            deltas.push((value - start) / 8.0);
        }
        // what would pass a bound at which the value already is stays: a step of the distribution at 0
        let kept: Vec<f64> = deltas.iter().copied().filter(|d| *d != 0.0).collect();
        let of_half = if x == 0.0 || x == 1.0 { 2.0 } else { 1.0 };
        assert!(
            (kept.len() as f64 * of_half / 4000.0 - 1.0).abs() < 0.05,
            "{}",
            kept.len()
        );
        let off = distance(kept, |d| match (d < 0.0, x) {
            (true, _) => of_half * side(-d, x),
            (false, 0.0) => 1.0 - 2.0 * side(d, 1.0),
            (false, _) => 1.0 - of_half * side(d, 1.0 - x),
        });
        assert!(off < 0.031 * of_half.sqrt(), "{eta} {x}: {off}");
    }
    let mut fixed = 1.0;
    assert!(!change(5.0, &mut random, (1.0, 1.0), &mut fixed) && fixed == 1.0);
    // one variable of ten by default, or as often as the setting says
    for (probability, share) in [
        (None, 0.1),
        (Some(0.35), 0.35),
        (Some(1.0), 1.0),
        (Some(0.0), 0.0),
    ] {
        let mut mutation = Mutation::new(20.0);
        mutation.probability = probability;
        let mut changed = 0;
        for _ in 0..400 {
            let mut x = [0.5; 10];
            let any = mutate(mutation, &mut random, (&[0.0; 10], &[1.0; 10]), &mut x);
            let own = x.iter().filter(|x| **x != 0.5).count();
            assert_eq!(any, own > 0);
            changed += own;
        }
        assert!(
            (changed as f64 / 4000.0 - share).abs() < 0.03,
            "{share} {changed}"
        );
    }
}

fn individuals(points: &[Vec<f64>]) -> Vec<Individual> {
    let of = |objectives: &Vec<f64>| Individual {
        x: objectives.clone(),
        objectives: objectives.clone(),
        violation: 0.0,
    };
    points.iter().map(of).collect()
}

/// Crowding distances of a front, all computed anew: the sum over objectives of the gap between the neighbours.
fn crowding(front: &[Vec<f64>], widths: &[f64]) -> Vec<f64> {
    let gap = |i: usize, k: usize| {
        let mut order: Vec<usize> = (0..front.len()).collect();
        order.sort_by(|&a, &b| front[a][k].total_cmp(&front[b][k]));
        let place = order.iter().position(|j| *j == i).unwrap();
        if place == 0 || place + 1 == order.len() {
            return f64::INFINITY;
        }
        (front[order[place + 1]][k] - front[order[place - 1]][k]) / widths[k]
    };
    (0..front.len())
        .map(|i| {
            (0..widths.len())
                .filter(|k| widths[*k] > 0.0)
                .map(|k| gap(i, k))
                .sum()
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Thinning one by one leaves what repeated sorting leaves; the better fronts stay whole.
    #[test]
    fn the_most_crowded_leave_first(
        mut front in prop::collection::vec(prop::collection::vec(0.0..1.0_f64, 3), 2..40),
        count in 1..40_usize,
        flat in any::<bool>(),
    ) {
        // on the plane f1 + f2 + f3 = 3 none dominates another
        for f in &mut front {
            f[2] = 3.0 - f[0] - f[1];
            if flat {
                (f[1], f[2]) = (3.0 - f[0], 7.0);
            }
        }
        let count = count.min(front.len());
        let width = |k: usize| {
            let of = front.iter().map(|f| f[k]);
            of.clone().fold(f64::NEG_INFINITY, f64::max) - of.fold(f64::INFINITY, f64::min)
        };
        let widths = [width(0), width(1), width(2)];
        let behind = front.iter().map(|f| f.iter().map(|f| f + 5.0).collect::<Vec<f64>>());
        let population: Vec<Vec<f64>> = behind.chain(front.iter().cloned()).collect();
        let (survivors, _) = nsga2::survive(individuals(&population), count);
        let mut left = front.clone();
        while left.len() > count {
            let distances = crowding(&left, &widths);
            let most = (0..left.len()).min_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap();
            left.remove(most);
        }
        let objectives: Vec<Vec<f64>> = survivors.into_iter().map(|one| one.objectives).collect();
        prop_assert_eq!(&objectives, &left);
        // with more room both fronts, the better one first
        let (survivors, fitness) = nsga2::survive(individuals(&population), front.len() + 1);
        prop_assert!(survivors.len() == front.len() + 1 && survivors[..front.len()].iter().zip(&front).all(|(a, b)| a.objectives == *b));
        let mut random = Random::new(9);
        let last = (0..900).filter(|_| nsga2::tournament(&fitness, &mut random) == front.len()).count() as f64;
        // the last one wins against itself alone
        prop_assert!(last / 900.0 <= 1.0 / (front.len() as f64 + 1.0).powi(2) + 0.06, "{last}");
    }

    /// The direction that a point belongs to is at the least angle; distances are perpendicular.
    #[test]
    fn the_nearest_direction_is_that_of_least_angle(
        point in prop::array::uniform3(0.1..5.0_f64),
        ideal in prop::array::uniform3(-1.0..0.0_f64),
        scale in prop::array::uniform3(0.5..2.0_f64),
    ) {
        let directions = super::das_dennis(3, 6);
        let (found, square) = nearest(&point, &ideal, &scale, &directions);
        let p: Vec<f64> = (0..3).map(|k| (point[k] - ideal[k]) / scale[k]).collect();
        let sine = |d: &Vec<f64>| {
            let cross = [p[1] * d[2] - p[2] * d[1], p[2] * d[0] - p[0] * d[2], p[0] * d[1] - p[1] * d[0]];
            (cross.iter().map(|c| c * c).sum::<f64>() / d.iter().map(|d| d * d).sum::<f64>()).sqrt()
        };
        let least = directions.iter().map(sine).fold(f64::INFINITY, f64::min);
        prop_assert!((sine(&directions[found]) - least).abs() < 1e-9 && (square.max(0.0).sqrt() - least).abs() < 1e-6);
    }

    /// A front on a plane with the intercepts s is spread over the directions whatever s is: one point for each.
    #[test]
    fn every_direction_keeps_its_point(scale in prop::array::uniform3(0.1..50.0_f64), shift in prop::array::uniform3(-9.0..9.0_f64), seed in any::<u64>()) {
        let directions = super::das_dennis(3, 4);
        let mut random = Random::new(seed);
        let place = |w: &[f64]| -> Vec<f64> { (0..3).map(|k| shift[k] + scale[k] * w[k]).collect() };
        let mut points: Vec<Vec<f64>> = directions.iter().map(|w| place(w)).collect();
        // companions of the inner points, farther from their directions
        for w in &directions {
            if w.iter().all(|w| *w > 0.0) {
                points.push(place(&[w[0] + 0.02, w[1] - 0.01, w[2] - 0.01]));
                points.push(place(&[w[0] - 0.01, w[1] + 0.02, w[2] - 0.01]));
            }
        }
        let mut memory = Normalisation::new(3);
        let kept = survive(individuals(&points), directions.len(), &directions, &mut memory, &mut random);
        let mut found: Vec<Vec<f64>> = kept.into_iter().map(|one| one.objectives).collect();
        let mut wanted = points[..directions.len()].to_vec();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        wanted.sort_by(|a, b| a.partial_cmp(b).unwrap());
        prop_assert_eq!(found, wanted);
    }
}

/// f1 = −x, f2 = y; y ≤ 2, x y = 1.
struct Sized;

impl Functions for Sized {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = -x[0];
        f[1] = x[1];
        f[2] = x[1] - R::from_f64(2.0);
        f[3] = x[0] * x[1] - R::ONE;
    }
}

#[test]
fn violations_add_up_and_come_before_objectives() {
    let params = ProblemParams::new(&[1.0, 1.0], 2, Exact(Sized))
        .inequalities(vec!["most".to_owned()])
        .equalities(vec!["product".to_owned()])
        .linear(vec![
            LinearConstraint::at_most("sum", vec![1.0, 1.0], 3.0),
            LinearConstraint::equal("twice", vec![2.0, -1.0], 1.0),
        ])
        .absolute(1);
    let problem = Problem::new(params).unwrap();
    let points = [
        [1.0, 1.0],
        [4.0, 3.0],
        [-1.0, -3.5],
        [0.5, f64::NAN],
        [0.5, 0.0],
    ];
    let points = points.map(Vec::from);
    let found = evaluate(&problem, points.to_vec());
    // (4, 3): 1 + |12 − 1| + 4 + |8 − 3 − 1|; (−1, −3.5): |3.5 − 1| + |−2 + 3.5 − 1|; (0.5, 0): |0 − 1|
    let violations: Vec<f64> = found.iter().map(|one| one.violation).collect();
    assert_eq!(violations, [0.0, 20.0, 3.0, f64::INFINITY, 1.0]);
    assert_eq!(
        (&found[1].objectives[..], &found[2].objectives[..]),
        (&[4.0, 3.0][..], &[1.0, -3.5][..])
    );
    assert_eq!(fronts(&found), [[0], [4], [2], [1], [3]].map(Vec::from));
    assert!(
        found[0].dominates(&found[2])
            && !found[2].dominates(&found[0])
            && !found[0].dominates(&found[0])
    );
}

proptest! {
    /// Whatever the objectives' units and zeros are, the knee is the corner of the front.
    #[test]
    fn a_knee_does_not_depend_on_units(scale in prop::array::uniform2(0.01..100.0_f64), shift in prop::array::uniform2(-50.0..50.0_f64), corner in 0.05..0.3_f64) {
        let front = [[1.0, 0.0], [0.6, 0.35], [corner, 0.4 - corner], [0.0, 1.0]];
        let place = |f: [f64; 2]| vec![shift[0] + scale[0] * f[0], shift[1] + scale[1] * f[1]];
        let placed: Vec<Vec<f64>> = front.into_iter().map(place).collect();
        prop_assert_eq!(super::knee(&placed), Some(2));
        prop_assert_eq!(super::knee(&placed[1..]), Some(1));
        prop_assert_eq!(super::knee(&placed[2..]), None);
    }
}

#[test]
fn a_front_without_extent_has_no_knee_and_no_objectives_no_directions() {
    assert_eq!(
        super::knee(&[vec![0.0, 1.0], vec![0.0, 2.0], vec![0.0, 3.0]]),
        None
    );
    assert!(super::das_dennis(0, 3).is_empty() && super::das_dennis(3, 0).is_empty());
    assert_eq!(super::das_dennis(1, 3), [[1.0]]);
}

/// Σ x and −Σ x of seventy variables, more than a Sobol sequence has; points are kept.
struct Kept(std::sync::Mutex<Vec<Vec<f64>>>);

impl crate::Model for &Kept {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        let sum: f64 = x.iter().sum();
        values.copy_from_slice(&[sum, -sum]);
        self.0.lock().unwrap().push(x.to_vec());
    }
    fn derivatives(&self, x: &[f64], values: &mut [f64], _: &mut crate::Jacobian) {
        self.values(x, values);
    }
}

#[test]
fn every_evaluation_is_counted_and_every_child_is_new() {
    for (algorithm, n) in [
        (super::Algorithm::NsgaII, 70),
        (super::Algorithm::NsgaIII, 3),
    ] {
        let model = Kept(std::sync::Mutex::default());
        let variables = (0..n).map(|i| crate::Variable::bounded(format!("x{i}"), 2.1, 2.0, 2.5));
        let params = ProblemParams::new(&vec![2.1; n], 2, &model).variables(variables);
        let problem = Problem::new(params).unwrap();
        let mut settings = super::ParetoSettings {
            algorithm: Some(algorithm),
            ..super::ParetoSettings::default()
        };
        (settings.population, settings.generations, settings.polish) = (20, 3, false);
        // children that no operator changes are changed in one variable
        settings.crossover = Some(Crossover::new(20.0, 0.0));
        let mut mutation = Mutation::new(20.0);
        mutation.probability = Some(0.0);
        settings.mutation = Some(mutation);
        let front = super::pareto(&problem, &settings).unwrap();
        let points = model.0.lock().unwrap().clone();
        assert_eq!((front.counts.values, points.len()), (80, 80));
        assert!(points.iter().flatten().all(|x| (2.0..=2.5).contains(x)));
        // the parallel evaluation keeps generations apart, not the order within them
        for (index, child) in points.iter().enumerate().skip(20) {
            let apart = |other: &Vec<f64>| child.iter().zip(other).filter(|(a, b)| a != b).count();
            let earlier = points[..20 * (index / 20)].iter().map(apart);
            assert_eq!(earlier.min(), Some(1), "{index}");
        }
    }
}

#[test]
fn the_less_violated_of_two_is_the_parent() {
    let model = Kept(std::sync::Mutex::default());
    let problem = Problem::new(ProblemParams::new(&[1.0], 2, &model)).unwrap();
    let settings = super::ParetoSettings::default();
    let mut search = super::Search {
        archive: &super::archive::Archive::new(&problem),
        problem: &problem,
        settings: &settings,
        bounds: (&[], &[]),
        crossover: Crossover::new(20.0, 0.9),
        mutation: Mutation::new(20.0),
        random: Random::new(4),
        counts: crate::Counts::default(),
        callback: &mut |_| std::ops::ControlFlow::Continue(()),
        stopped: false,
    };
    // children of parents as far from either bound lie as far from their middle, unless a variable of them is mutated
    search.bounds = (&[0.0; 64], &[4.0; 64]);
    search.crossover = Crossover::new(5.0, 1.0);
    search.mutation.probability = Some(0.0);
    let [one, two] = search.children(&[1.0; 64], &[3.0; 64]);
    assert!(
        one != [1.0; 64]
            && one
                .iter()
                .zip(&two)
                .all(|(a, b)| (a + b - 4.0).abs() < 1e-12)
    );
    let mut population = individuals(&[vec![0.0, 0.0], vec![0.0, 0.0]]);
    population[0].violation = 1.0;
    let violated = (0..2000)
        .filter(|_| search.less_violated(&population) == 0)
        .count();
    // only where both draws are it: a quarter, and five standard deviations
    assert!((violated as f64 - 500.0).abs() < 97.0, "{violated}");
}
