//! The trade-off between objectives as a whole: Pareto fronts.
//!
//! An evolutionary search (NSGA-II for two objectives, NSGA-III for more) covers the front; then each point
//! is polished by a goal-attainment solve, which makes it exact to the solver's tolerance and gives it
//! multipliers.

mod archive;
mod das_dennis;
mod knee;
mod mutation;
mod nsga2;
mod nsga3;
#[cfg(test)]
mod operator_tests;
mod polish;
mod population;
mod sbx;
mod settings;

use core::ops::ControlFlow;

use crate::callback::{Callback, Progress, Stage};
use crate::error::{Error, Result};
use crate::problem::Problem;
use crate::random::Random;
use crate::sobol::Sobol;
use crate::solution::{Counts, Multipliers};

pub use das_dennis::das_dennis;
pub use knee::knee;
pub use mutation::Mutation;
pub use sbx::Crossover;
pub use settings::{Algorithm, MAX_POPULATION, ParetoSettings};

use archive::Archive;
use polish::nondominated;
use population::{Individual, evaluate, fronts};

/// One compromise.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FrontPoint {
    /// The variables.
    pub x: Vec<f64>,
    /// The objectives, |f| where absolute.
    pub objectives: Vec<f64>,
    /// The prices at this point, where the polishing solve converged: those of the objectives sum to 1, and
    /// Σ price_i df_i = 0 along the front.
    pub multipliers: Option<Multipliers>,
}

/// A set of compromises none of which beats another.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Front {
    /// The points, ordered by their first objective (then the second, …).
    pub points: Vec<FrontPoint>,
    /// The index of the knee in `points`, where there is one.
    pub knee: Option<usize>,
    /// The best value of each objective over the front.
    pub ideal: Vec<f64>,
    /// The worst value of each objective over the front.
    pub nadir: Vec<f64>,
    /// The least violation in the population; above 0 there is no front, for nothing feasible was found.
    pub violation: f64,
    /// What the search and the polishing cost.
    pub counts: Counts,
    /// Did the caller stop it? Then it is the front so far.
    pub stopped: bool,
}

impl Front {
    /// The objectives of all points.
    #[must_use]
    pub fn objectives(&self) -> Vec<Vec<f64>> {
        self.points.iter().map(|p| p.objectives.clone()).collect()
    }
}

/// Finds the front of a problem.
///
/// The same settings give the same front, on any number of threads.
///
/// # Errors
/// Fewer than two objectives, a variable without finite bounds, or a setting out of its range.
///
/// ```
/// use grouser_opt::{Differences, ParetoSettings, Problem, ProblemParams, Variable, pareto};
///
/// // Between the minima at 0 and 2 every point is a compromise: √f1 + √f2 = 2.
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| {
///     f[0] = x[0] * x[0];
///     f[1] = (x[0] - 2.0).powi(2);
/// });
/// let params = ProblemParams::new(&[1.0], 2, model)
///     .variables([Variable::bounded("x", 1.0, -1.0, 3.0)]);
/// let mut settings = ParetoSettings::default();
/// (settings.population, settings.generations) = (12, 10);
/// let front = pareto(&Problem::new(params)?, &settings)?;
/// for point in &front.points {
///     let sum: f64 = point.objectives.iter().map(|f| f.sqrt()).sum();
///     assert!((sum - 2.0).abs() < 1e-3);
/// }
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub fn pareto(problem: &Problem<'_>, settings: &ParetoSettings) -> Result<Front> {
    pareto_with(problem, settings, &mut |_| ControlFlow::Continue(()))
}

/// As [`pareto`], calling `callback` after each generation and for each iteration of the polishing solves: to show
/// progress, or to stop with the front so far.
///
/// # Errors
/// As [`pareto`].
pub fn pareto_with(
    problem: &Problem<'_>,
    settings: &ParetoSettings,
    callback: &mut Callback<'_>,
) -> Result<Front> {
    let m = problem.objectives().len();
    Error::check_range("the number of objectives", m as f64, 2.0, 20.0)?;
    settings.check(m)?;
    let (lower, upper) = problem.finite_box("a Pareto front")?;
    let archive = Archive::new(problem);
    let problem = &problem.recorded(&archive);
    let mut search = Search {
        problem,
        archive: &archive,
        settings,
        bounds: (&lower, &upper),
        crossover: settings.crossover_for(m),
        mutation: settings.mutation_for(m),
        random: Random::new(settings.seed),
        counts: Counts::default(),
        callback,
        stopped: false,
    };
    let directions = das_dennis(m, settings.divisions_for(m));
    let population = match settings.algorithm_for(m) {
        Algorithm::NsgaII => search.nsga2()?,
        Algorithm::NsgaIII => search.nsga3(&directions)?,
    };
    let (mut counts, mut stopped) = (search.counts, search.stopped);
    let callback = search.callback;
    let violation = population
        .iter()
        .map(|i| i.violation)
        .fold(f64::INFINITY, f64::min);
    let first = fronts(&population).into_iter().next().unwrap_or_default();
    let mut best: Vec<Individual> = Vec::new();
    for i in first {
        let candidate = &population[i];
        let repeated = best.iter().any(|b| b.objectives == candidate.objectives);
        if candidate.violation == 0.0 && !repeated {
            best.push(candidate.clone());
        }
    }
    let mut points: Vec<FrontPoint> = if settings.polish && !stopped {
        let spread = match settings.algorithm_for(m) {
            Algorithm::NsgaII => None,
            Algorithm::NsgaIII => Some(directions.as_slice()),
        };
        let watch = polish::Watch {
            callback,
            stopped: &mut stopped,
            counts: &mut counts,
        };
        polish::polish(problem, &settings.solve, &best, spread, watch)?
    } else {
        best.into_iter()
            .map(|i| FrontPoint {
                x: i.x,
                objectives: i.objectives,
                multipliers: None,
            })
            .collect()
    };
    archive.improve(&mut points);
    points = nondominated(&points);
    points.sort_by(|a, b| {
        a.objectives
            .iter()
            .zip(&b.objectives)
            .map(|(a, b)| a.total_cmp(b))
            .find(|order| order.is_ne())
            .unwrap_or(core::cmp::Ordering::Equal)
    });
    let objectives: Vec<Vec<f64>> = points.iter().map(|p| p.objectives.clone()).collect();
    let end = |pick: fn(f64, f64) -> f64, from: f64| -> Vec<f64> {
        (0..m)
            .map(|k| objectives.iter().map(|f| f[k]).fold(from, pick))
            .collect()
    };
    Ok(Front {
        knee: knee(&objectives),
        ideal: end(f64::min, f64::INFINITY),
        nadir: end(f64::max, f64::NEG_INFINITY),
        points,
        violation,
        counts,
        stopped,
    })
}

struct Search<'a, 'c, 'f> {
    problem: &'a Problem<'a>,
    archive: &'a Archive<'a>,
    settings: &'a ParetoSettings,
    bounds: (&'a [f64], &'a [f64]),
    crossover: Crossover,
    mutation: Mutation,
    random: Random,
    counts: Counts,
    callback: &'c mut Callback<'f>,
    stopped: bool,
}

impl Search<'_, '_, '_> {
    /// A generation is done; is the search to go on?
    fn goes_on(&mut self, population: &[Individual]) -> bool {
        self.counts.iterations += 1;
        self.archive.prune(population);
        let greatest = |of: &Individual| {
            let all = of.objectives.iter().copied();
            all.fold(f64::NEG_INFINITY, f64::max)
        };
        let best = population.iter().min_by(|a, b| {
            let by_violation = a.violation.total_cmp(&b.violation);
            by_violation.then(greatest(a).total_cmp(&greatest(b)))
        });
        if let Some(best) = best {
            let progress = Progress {
                stage: Stage::Generations {
                    done: self.counts.iterations,
                    of: self.settings.generations,
                },
                iteration: self.counts.iterations,
                x: &best.x,
                utility: greatest(best),
                violation: best.violation,
                stationarity: None,
            };
            self.stopped = (self.callback)(&progress).is_break();
        }
        !self.stopped
    }

    /// The first population: the problem's start, and an even cover of the box.
    fn seeded(&mut self, count: usize) -> Result<Vec<Individual>> {
        let (lower, upper) = self.bounds;
        let variables = self.problem.variables();
        let mut points = vec![
            variables
                .iter()
                .map(|v| v.start.clamp(v.lower, v.upper))
                .collect(),
        ];
        match Sobol::new(lower.len(), Some(self.settings.seed)) {
            Ok(mut sobol) => points.extend((1..count).map(|_| sobol.next_in(lower, upper))),
            Err(Error::TooLarge { .. }) => points.extend((1..count).map(|_| {
                let at = |(low, high): (&f64, &f64)| low + self.random.uniform() * (high - low);
                lower.iter().zip(upper).map(at).collect()
            })),
            Err(other) => return Err(other),
        }
        Ok(self.evaluate(points))
    }

    fn evaluate(&mut self, points: Vec<Vec<f64>>) -> Vec<Individual> {
        self.counts.values += points.len();
        evaluate(self.problem, points)
    }

    /// Two children of two parents. A child that would repeat its parent is mutated in one variable.
    fn children(&mut self, a: &[f64], b: &[f64]) -> [Vec<f64>; 2] {
        let (mut one, mut two) = (a.to_vec(), b.to_vec());
        sbx::cross(
            self.crossover,
            &mut self.random,
            self.bounds,
            &mut one,
            &mut two,
        );
        for (child, parent) in [(&mut one, a), (&mut two, b)] {
            let changed = mutation::mutate(self.mutation, &mut self.random, self.bounds, child);
            if !changed && child.as_slice() == parent {
                let i = self.random.below(child.len());
                let bounds = (self.bounds.0[i], self.bounds.1[i]);
                let eta = self.mutation.eta;
                mutation::change(eta, &mut self.random, bounds, &mut child[i]);
            }
        }
        [one, two]
    }

    fn nsga2(&mut self) -> Result<Vec<Individual>> {
        let count = self.settings.population;
        let population = self.seeded(count)?;
        let (mut population, mut fitness) = nsga2::survive(population, count);
        for _ in 0..self.settings.generations {
            let mut offspring = Vec::new();
            while offspring.len() < count {
                let a = nsga2::tournament(&fitness, &mut self.random);
                let b = nsga2::tournament(&fitness, &mut self.random);
                offspring.extend(self.children(&population[a].x, &population[b].x));
            }
            offspring.truncate(count);
            let born = self.evaluate(offspring);
            population.extend(born);
            (population, fitness) = nsga2::survive(population, count);
            if !self.goes_on(&population) {
                break;
            }
        }
        Ok(population)
    }

    fn nsga3(&mut self, directions: &[Vec<f64>]) -> Result<Vec<Individual>> {
        let count = self.settings.population;
        let mut population = self.seeded(count)?;
        let mut memory = nsga3::Normalisation::new(self.problem.objectives().len());
        for _ in 0..self.settings.generations {
            let mut offspring = Vec::new();
            while offspring.len() < count {
                let a = self.less_violated(&population);
                let b = self.less_violated(&population);
                offspring.extend(self.children(&population[a].x, &population[b].x));
            }
            offspring.truncate(count);
            let born = self.evaluate(offspring);
            population.extend(born);
            population =
                nsga3::survive(population, count, directions, &mut memory, &mut self.random);
            if !self.goes_on(&population) {
                break;
            }
        }
        Ok(population)
    }

    /// The less violated of two random individuals; the first if neither is violated.
    fn less_violated(&mut self, population: &[Individual]) -> usize {
        let a = self.random.below(population.len());
        let b = self.random.below(population.len());
        if population[b].violation < population[a].violation {
            b
        } else {
            a
        }
    }
}
