//! Each point of a front made exact: a goal-attainment solve from it, along its own direction.
//!
//! Along a direction w from the ideal point the best point is min γ with f_i − w_i γ ≤ ideal_i. With NSGA-III
//! the directions are the given ones; without them each point keeps its own, w_i = f_i − ideal_i, after
//! the ends of the front have been made exact.

use super::FrontPoint;
use super::nsga3::nearest;
use super::population::Individual;
use crate::callback::{Callback, Progress, Stage};
use crate::error::Result;
use crate::method::Method;
use crate::problem::Problem;
use crate::settings::Settings;
use crate::solution::{Counts, Multipliers, Solution};
use crate::solve::solve_with;
use crate::status::Status;
use crate::watched::watched;

/// So many iterations for one point.
const LONGEST: usize = 200;
/// A direction's least component: along 0 a goal would be a hard limit that nothing can move.
pub(super) const LEAST_WEIGHT: f64 = 1e-6;

/// The caller, and what is counted for it.
pub(super) struct Watch<'w, 'c, 'f> {
    pub(super) callback: &'c mut Callback<'f>,
    pub(super) stopped: &'w mut bool,
    pub(super) counts: &'w mut Counts,
}

/// The front with its points made exact; those that a stop came before stay as they are.
pub(super) fn polish(
    problem: &Problem<'_>,
    settings: &Settings,
    front: &[Individual],
    directions: Option<&[Vec<f64>]>,
    mut watch: Watch<'_, '_, '_>,
) -> Result<Vec<FrontPoint>> {
    let m = problem.objectives().len();
    if front.is_empty() {
        return Ok(Vec::new());
    }
    // A point that is near needs few steps; one that does not get there is kept as the search left it.
    let settings = &Settings {
        max_iterations: settings.max_iterations.min(LONGEST),
        // a point of the front is held against its neighbours instead
        probes: 0,
        ..settings.clone()
    };
    let ideal = ideal(problem, settings, front, &mut watch)?;
    // The ends alone do not span the front: an objective's best may be reached at several of them.
    let scale: Vec<f64> = (0..m)
        .map(|k| {
            let worst = front.iter().map(|p| p.objectives[k]);
            (worst.fold(f64::NEG_INFINITY, f64::max) - ideal[k]).max(1e-12)
        })
        .collect();
    let targets: Vec<(&Individual, Vec<f64>)> = match directions {
        None => front
            .iter()
            .map(|point| {
                let own = point.objectives.iter().zip(ideal.iter().zip(&scale));
                (point, own.map(|(f, (best, s))| (f - best) / s).collect())
            })
            .collect(),
        Some(directions) => directions
            .iter()
            .filter_map(|direction| {
                let one = std::slice::from_ref(direction);
                let off = |p: &Individual| nearest(&p.objectives, &ideal, &scale, one).1;
                front
                    .iter()
                    .min_by(|a, b| off(a).total_cmp(&off(b)))
                    .map(|point| (point, direction.clone()))
            })
            .collect(),
    };
    let of = targets.len();
    let (polished, stopped) = watched(
        if *watch.stopped { &[] } else { &targets },
        |done| Stage::Polishing { done, of },
        watch.callback,
        |(point, direction), own| {
            let weights: Vec<f64> = direction
                .iter()
                .zip(&scale)
                .map(|(d, s)| d.max(LEAST_WEIGHT) * s)
                .collect();
            let method = Method::Attain {
                goals: ideal.clone(),
                weights: weights.clone(),
            };
            let mut solution = solve_with(&problem.from_start(&point.x)?, &method, settings, own)?;
            per_objective(&mut solution.multipliers, &weights);
            Ok::<_, crate::error::Error>(solution)
        },
    );
    *watch.stopped = *watch.stopped || stopped;
    let polished = polished.into_iter().chain(std::iter::repeat_with(|| None));
    let mut points: Vec<FrontPoint> = Vec::new();
    for ((point, _), solution) in targets.iter().zip(polished) {
        let solution: Option<Solution> = solution.transpose()?;
        if let Some(solution) = &solution {
            *watch.counts += solution.counts;
        }
        points.push(
            match solution.filter(|solution| solution.status.is_solved()) {
                Some(solution) => FrontPoint {
                    objectives: magnitudes(problem, &solution.objectives),
                    x: solution.x,
                    multipliers: Some(solution.multipliers),
                },
                None => FrontPoint {
                    x: point.x.clone(),
                    objectives: point.objectives.clone(),
                    multipliers: None,
                },
            },
        );
    }
    Ok(points)
}

/// From multipliers of (f_i − ideal_i)/w_i to those of f_i, which say what one costs in the other; again
/// with the sum 1.
fn per_objective(multipliers: &mut Multipliers, weights: &[f64]) {
    for (price, weight) in multipliers.objectives.iter_mut().zip(weights) {
        *price /= weight;
    }
    let sum: f64 = multipliers.objectives.iter().sum();
    let Multipliers {
        objectives,
        hard_goals,
        inequalities,
        equalities,
        linear,
        lower,
        upper,
    } = multipliers;
    for list in [
        objectives,
        hard_goals,
        inequalities,
        equalities,
        linear,
        lower,
        upper,
    ] {
        for price in list.iter_mut() {
            *price /= sum;
        }
    }
}

/// The least of each objective alone, found from the front's own best.
fn ideal(
    problem: &Problem<'_>,
    settings: &Settings,
    front: &[Individual],
    watch: &mut Watch<'_, '_, '_>,
) -> Result<Vec<f64>> {
    let m = problem.objectives().len();
    let mut ideal = Vec::with_capacity(m);
    for k in 0..m {
        let best = front
            .iter()
            .min_by(|a, b| a.objectives[k].total_cmp(&b.objectives[k]));
        let Some(best) = best else { continue };
        let mut least = best.objectives[k];
        if !*watch.stopped {
            // A whisper of the others picks, among equally good ends, the one that costs them least.
            let weights = (0..m).map(|i| if i == k { 1.0 } else { 1e-6 }).collect();
            let own = &mut |progress: &Progress<'_>| {
                let stage = Stage::Polishing {
                    done: 0,
                    of: front.len(),
                };
                (watch.callback)(&Progress { stage, ..*progress })
            };
            let solution = solve_with(
                &problem.from_start(&best.x)?,
                &Method::Weighted { weights },
                settings,
                own,
            )?;
            *watch.stopped = solution.status == Status::Stopped;
            *watch.counts += solution.counts;
            if solution.status.is_solved() {
                least = least.min(magnitudes(problem, &solution.objectives)[k]);
            }
        }
        ideal.push(least);
    }
    Ok(ideal)
}

fn magnitudes(problem: &Problem<'_>, objectives: &[f64]) -> Vec<f64> {
    objectives
        .iter()
        .enumerate()
        .map(|(i, f)| if i < problem.absolute() { f.abs() } else { *f })
        .collect()
}

/// Without points that another one beats or repeats, to the solver's tolerance.
pub(super) fn nondominated(points: &[FrontPoint]) -> Vec<FrontPoint> {
    const SAME_POINT_DISTANCE: f64 = 1e-9;
    let beats = |a: &FrontPoint, b: &FrontPoint| {
        let pairs = || a.objectives.iter().zip(&b.objectives);
        pairs().all(|(a, b)| *a <= b + SAME_POINT_DISTANCE)
            && pairs().any(|(a, b)| *a < b - SAME_POINT_DISTANCE)
    };
    let same = |a: &FrontPoint, b: &FrontPoint| {
        let pairs = a.objectives.iter().zip(&b.objectives);
        pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) <= SAME_POINT_DISTANCE
    };
    let mut kept: Vec<FrontPoint> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let beaten = points
            .iter()
            .enumerate()
            .any(|(other, q)| other != index && beats(q, point));
        if !beaten && !kept.iter().any(|q| same(q, point)) {
            kept.push(point.clone());
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use core::ops::ControlFlow;

    use grouser_real::Scalar;

    use super::*;
    use crate::problem::{ProblemParams, Variable};
    use crate::{Exact, Functions};

    fn kept(points: &[[f64; 2]]) -> Vec<usize> {
        let of = |(index, f): (usize, &[f64; 2])| FrontPoint {
            x: vec![index as f64],
            objectives: f.to_vec(),
            multipliers: None,
        };
        let points: Vec<FrontPoint> = points.iter().enumerate().map(of).collect();
        let kept = nondominated(&points);
        let place = |point: &FrontPoint| points.iter().position(|p| p.x == point.x).unwrap();
        kept.iter().map(place).collect()
    }

    #[test]
    fn beaten_and_repeated_points_leave() {
        assert_eq!(
            kept(&[[0.0, 1.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5]]),
            [0, 1, 3]
        );
        // to the solver's tolerance of 1e-9: repeated, as good in one objective, beaten in one
        assert_eq!(
            kept(&[[0.0, 1.0], [5e-10, 1.0 - 5e-10], [2.0, 0.0]]),
            [0, 2]
        );
        assert_eq!(kept(&[[1.0, 1.0], [1.0 + 5e-10, 0.5]]), [1]);
        assert_eq!(kept(&[[1.0, 1.0], [1.0 + 5e-9, 0.5]]), [0, 1]);
        assert_eq!(kept(&[[1.0, 1.0 + 5e-9], [1.0 + 5e-10, 1.0]]), [1]);
        assert_eq!(kept(&[[1.0, 1.0 + 1.5e-9], [1.0 + 1.5e-9, 1.0]]), [0, 1]);
        // exactly that: still as good, not better, the same
        assert_eq!(kept(&[[0.0, 1.0], [1e-9, 0.0]]), [1]);
        assert_eq!(kept(&[[1e-9, 0.0], [0.0, 0.0]]), [0]);
        assert_eq!(kept(&[[0.0, 0.0], [1e-9, 0.0]]), [0]);
    }

    /// −x² − 100 and (x − 1)² − 9.
    struct Pair;
    impl Functions for Pair {
        fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
            f[0] = -(x[0].square() + R::from_f64(OFFSETS[0]));
            f[1] = (x[0] - R::ONE).square() + R::from_f64(OFFSETS[1]);
        }
    }
    /// Of the two objectives' least values from zero.
    const OFFSETS: [f64; 2] = [100.0, -9.0];

    /// x² + 100, as a magnitude, and (x − 1)² − 9 along given directions w from their ideal point: x² w₂ = (1 − x)² w₁. A stop
    /// before the end is kept.
    #[test]
    fn points_move_along_their_directions() {
        let params = ProblemParams::new(&[0.5], 2, Exact(Pair)).absolute(1);
        let variables = [Variable::bounded("x", 0.5, -2.0, 2.0)];
        let problem = Problem::new(params.variables(variables)).unwrap();
        assert_eq!(magnitudes(&problem, &[-1.0, -2.0]), [1.0, -2.0]);
        let front = [0.1, 0.4, 0.9].map(|x: f64| Individual {
            x: vec![x],
            objectives: vec![x * x + OFFSETS[0], (x - 1.0) * (x - 1.0) + OFFSETS[1]],
            violation: 0.0,
        });
        // those of the front reach so far from the ideal point
        let extent = [0.81_f64, 0.81];
        let directions = [[0.2, 0.8], [0.5, 0.5], [0.9, 0.1]];
        let all: Vec<Vec<f64>> = directions.iter().map(|w| w.to_vec()).collect();
        let polished = |last: usize| {
            let (mut calls, mut stopped, mut counts) = (0, false, Counts::default());
            let mut callback = |_: &Progress<'_>| {
                calls += 1;
                if calls == last {
                    return ControlFlow::Break(());
                }
                ControlFlow::Continue(())
            };
            let watch = Watch {
                callback: &mut callback,
                stopped: &mut stopped,
                counts: &mut counts,
            };
            let settings = Settings::default();
            let points = polish(&problem, &settings, &front, Some(&all), watch).unwrap();
            (points, stopped, calls)
        };
        let (points, stopped, calls) = polished(usize::MAX);
        assert!(!stopped && points.len() == 3);
        for (point, w) in points.iter().zip(directions) {
            let root = |k: usize| (w[k] * extent[k]).sqrt();
            let x = root(0) / (root(0) + root(1));
            assert!((point.x[0] - x).abs() < 1e-6, "{:?} {x}", point.x);
        }
        for last in 1..calls {
            let (_, stopped, again) = polished(last);
            assert!(stopped && again <= calls, "{last}");
        }
        assert_eq!(polished(1).2, 1, "nothing is called after a stop");
    }

    #[test]
    fn prices_are_of_the_objectives_themselves() {
        let mut prices = Multipliers {
            objectives: vec![0.5, 0.5],
            inequalities: vec![3.0],
            ..Multipliers::default()
        };
        // γ ≥ (f − ideal)/w: a half of f1/2 and a half of f2/0.5 are a quarter of f1 and one f2
        per_objective(&mut prices, &[2.0, 0.5]);
        assert_eq!(
            (&prices.objectives[..], prices.inequalities[0]),
            (&[0.2, 0.8][..], 2.4)
        );
    }
}
