//! From a checked design to its answer.

use std::ops::ControlFlow;

use grouser_opt::{
    Callback, Counts, Front, Kkt, Merit, Method, MultiStart, Problem, Solution, Status,
    multi_start_with, pareto_with, solve_with,
};

use crate::design::{Design, Objective, Slot, Task};
use crate::error::{Error, Result};

/// Objectives whose scaled values differ by less than this · (1 + |value|) decide together.
const SAME_LEVEL: f64 = 1e-6;

/// One solve among several starts.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Start {
    /// Where it ended.
    pub x: Vec<f64>,
    /// The objective that decides there ([`Design::deciding`]), without scaling.
    pub maximum: f64,
    /// What was minimised, with scaling.
    pub utility: f64,
    /// How it ended.
    pub status: Status,
}

/// The answer to minimax, goal attainment, weighted and Chebyshev problems. Lists are in the order of the
/// file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Optimum {
    /// How the solve ended.
    pub status: Status,
    /// The variables.
    pub x: Vec<f64>,
    /// Every objective by name, without scaling; under several worlds one per world where they count
    /// separately.
    pub objectives: Vec<(String, f64)>,
    /// The one that decides ([`Design::deciding`]).
    pub maximum: f64,
    /// Its name.
    pub deciding: String,
    /// What was minimised: γ, with scaling.
    pub utility: f64,
    /// γ, for goal attainment.
    pub attainment: Option<f64>,
    /// The local trade-off between the (scaled) objectives; sums to 1.
    pub objective_multipliers: Vec<(String, f64)>,
    /// The scale of each, as the file gives it.
    pub objective_scales: Vec<f64>,
    /// What each constraint costs; hard goals by their objective's name. Once per world where there are
    /// several.
    pub constraint_multipliers: Vec<(String, f64)>,
    /// What the bounds of each variable cost: (lower, upper).
    pub bound_multipliers: Vec<(f64, f64)>,
    /// The names of what holds the point.
    pub active: Vec<String>,
    /// How well the optimality conditions hold.
    pub kkt: Kkt,
    /// What it cost, over all starts.
    pub counts: Counts,
    /// Every start.
    pub starts: Vec<Start>,
    /// The different local optima: (index into `starts`, how many starts led there), best first.
    pub optima: Vec<(usize, usize)>,
    /// Are there different points equally good?
    pub is_ambiguous: bool,
}

/// One compromise of a front.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Compromise {
    /// The variables.
    pub x: Vec<f64>,
    /// The objectives without scaling, in the order of the file; signed.
    pub objectives: Vec<f64>,
    /// The local trade-off between the scaled objectives, where the polishing solve converged.
    pub multipliers: Option<Vec<f64>>,
}

/// The answer to a Pareto problem.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Trade {
    /// The points, ordered by the solver's first objective.
    pub points: Vec<Compromise>,
    /// Where the front bends most.
    pub knee: Option<usize>,
    /// The least violation seen; above 0 there is no front.
    pub violation: f64,
    /// What it cost.
    pub counts: Counts,
}

/// What a design gives.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Answer {
    /// One compromise.
    Optimum(Box<Optimum>),
    /// A front.
    Trade(Box<Trade>),
}

impl Design {
    fn refuse(&self, source: grouser_opt::Error) -> Error {
        Error::Problem {
            file: self.file.clone(),
            source,
        }
    }

    /// The method for the solver's objectives.
    pub(crate) fn method(&self, problem: &Problem<'_>) -> Method {
        // Under several worlds an objective may occur once per world.
        let order = self.solver_order();
        let copies = (problem.objectives().len() / order.len()).max(1);
        let spread = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
            order
                .iter()
                .flat_map(|&i| std::iter::repeat_n(f(i), copies))
                .collect()
        };
        let weights = spread(&|i| self.objectives[i].weight);
        let goals =
            spread(&|i| self.objectives[i].goal.unwrap_or(0.0) * self.objectives[i].factor());
        match self.task {
            Task::Minimax | Task::Pareto => Method::Minimax,
            Task::Attain => Method::Attain { goals, weights },
            Task::Weighted => Method::Weighted { weights },
            Task::Chebyshev => Method::Chebyshev {
                ideal: goals,
                weights,
            },
        }
    }

    /// Solves it.
    ///
    /// # Errors
    /// As [`Design::solve_with`].
    pub fn solve(&self) -> Result<Answer> {
        self.solve_with(&mut |_| ControlFlow::Continue(()))
    }

    /// What a solve would minimise at `x` (the variables of the file), and the worst violation there.
    ///
    /// # Errors
    /// [`Error::Problem`] for a point of the wrong length.
    ///
    /// ```
    /// use grouser_design::{Design, State};
    /// use grouser_opt::Variable;
    /// use grouser_terra::{RigidWheel, catalogue};
    ///
    /// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let design = Design::builder(&RigidWheel::new(0.125, 0.1)?, &soil, State::under_load(60.0))
    ///     .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
    ///     .minimise("pull", "-drawbar_pull_n")
    ///     .build()?;
    /// assert!(design.merit(&[0.4])?.utility < design.merit(&[0.1])?.utility); // more slip, more pull
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn merit(&self, x: &[f64]) -> Result<Merit> {
        let problem = self.problem()?;
        let method = self.method(&problem);
        grouser_opt::evaluate(&problem, &method, x).map_err(|e| self.refuse(e))
    }

    /// Solves it; `callback` is called on this thread once an iteration of each solve and once a generation, and may
    /// stop it: the answer is then the best point or the front so far.
    ///
    /// # Errors
    /// [`Error::Problem`] for what the solver refuses, such as a search over an unbounded box. A solve
    /// that finds no answer is a status.
    pub fn solve_with(&self, callback: &mut Callback<'_>) -> Result<Answer> {
        let problem = self.problem()?;
        if self.task == Task::Pareto {
            let front =
                pareto_with(&problem, &self.pareto, callback).map_err(|e| self.refuse(e))?;
            return Ok(Answer::Trade(Box::new(self.trade(&problem, front))));
        }
        let method = self.method(&problem);
        let optimum = if self.starts > 1 {
            let starts = (self.starts, self.seed);
            let found = multi_start_with(&problem, &method, &self.settings, starts, callback)
                .map_err(|e| self.refuse(e))?;
            self.optimum_of_many(&problem, &found)
        } else {
            let solution = solve_with(&problem, &method, &self.settings, callback)
                .map_err(|e| self.refuse(e))?;
            let start = self.start(&problem, &solution);
            self.optimum(&problem, &solution, vec![start])
        };
        Ok(Answer::Optimum(Box::new(optimum)))
    }

    /// What the solver's objective `index` is of the file's: its scale, negative where it is maximised.
    fn scale_of(&self, problem: &Problem<'_>, index: usize) -> f64 {
        self.objectives[self.file_place(problem, index)].factor()
    }

    /// Which objective of the file the solver's objective `index` is.
    fn file_place(&self, problem: &Problem<'_>, index: usize) -> usize {
        let order = self.solver_order();
        let copies = (problem.objectives().len() / order.len()).max(1);
        order[(index / copies).min(order.len() - 1)]
    }

    /// The solver's objectives without scaling.
    fn unscaled(&self, problem: &Problem<'_>, values: &[f64]) -> Vec<f64> {
        values
            .iter()
            .enumerate()
            .map(|(i, f)| f / self.scale_of(problem, i))
            .collect()
    }

    /// Which of the solver's objectives decides, and its value.
    fn maximum(&self, problem: &Problem<'_>, unscaled: &[f64]) -> (usize, f64) {
        let values = unscaled.iter().enumerate();
        self.worst(values.map(|(i, f)| (&self.objectives[self.file_place(problem, i)], *f)))
    }

    /// The objective that decides among values in the order of the file, without its scale: the one that is greatest with it, |f|
    /// where absolute and −f where maximised; where all are maximised, in its own sign. Of several that are equal, the one that is greatest
    /// without.
    #[must_use]
    pub fn deciding(&self, objectives: &[f64]) -> f64 {
        self.worst(self.objectives.iter().zip(objectives.iter().copied()))
            .1
    }

    fn worst<'o>(&self, values: impl Iterator<Item = (&'o Objective, f64)>) -> (usize, f64) {
        let all = self.objectives.iter().all(|objective| objective.maximise);
        let sized = values.map(|(objective, f)| {
            let value = match (objective.absolute, objective.maximise) {
                (true, _) => f.abs(),
                (_, true) => -f,
                _ => f,
            };
            (objective.scale * value, value)
        });
        let sized: Vec<(f64, f64)> = sized.collect();
        let greater = |m: f64, v: f64| if v > m || v.is_nan() { v } else { m };
        let level = sized.iter().map(|(scaled, _)| *scaled);
        let level = level.fold(f64::NEG_INFINITY, greater);
        let decides = |scaled: f64| {
            level.is_nan() && scaled.is_nan() || level - scaled <= SAME_LEVEL * (1.0 + level.abs())
        };
        let deciding = sized.iter().enumerate();
        let deciding = deciding.filter(|(_, (scaled, _))| decides(*scaled));
        let most = deciding.max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
        let (place, value) = most.map_or((0, f64::NAN), |(place, (_, value))| (place, *value));
        (place, if all { -value } else { value })
    }

    fn start(&self, problem: &Problem<'_>, solution: &Solution) -> Start {
        Start {
            x: solution.x.clone(),
            maximum: self
                .maximum(problem, &self.unscaled(problem, &solution.objectives))
                .1,
            utility: solution.utility,
            status: solution.status.clone(),
        }
    }

    fn optimum_of_many(&self, problem: &Problem<'_>, found: &MultiStart) -> Optimum {
        let starts = found
            .runs
            .iter()
            .map(|run| self.start(problem, run))
            .collect();
        Optimum {
            counts: found.counts,
            optima: found
                .optima
                .iter()
                .map(|o| (o.run, o.reached_by.len()))
                .collect(),
            is_ambiguous: found.is_ambiguous(),
            ..self.optimum(problem, found.best(), starts)
        }
    }

    fn optimum(&self, problem: &Problem<'_>, solution: &Solution, starts: Vec<Start>) -> Optimum {
        let names = problem.objectives();
        let values = self.unscaled(problem, &solution.objectives);
        let parts = &solution.multipliers;
        // The order of the file: by its objectives, and within one by world.
        let mut places: Vec<usize> = (0..names.len()).collect();
        places.sort_by_key(|&i| (self.file_place(problem, i), i));
        let listed = |list: &[f64]| -> Vec<(String, f64)> {
            places
                .iter()
                .map(|&i| (names[i].clone(), list.get(i).copied().unwrap_or(0.0)))
                .collect()
        };
        let hard = |i: &usize| {
            let objective = &self.objectives[self.file_place(problem, *i)];
            self.task == Task::Attain && objective.weight == 0.0
        };
        let mut constraint_multipliers: Vec<(String, f64)> = places
            .iter()
            .filter(|i| hard(i))
            .map(|&i| (names[i].clone(), parts.hard_goals[i]))
            .collect();
        constraint_multipliers.extend(self.priced(solution));
        let n = self.variables.len();
        let (deciding, maximum) = self.maximum(problem, &values);
        Optimum {
            status: solution.status.clone(),
            x: solution.x.clone(),
            maximum,
            deciding: names[deciding].clone(),
            utility: solution.utility,
            attainment: (self.task == Task::Attain).then_some(solution.utility),
            objectives: listed(&values),
            objective_scales: places.iter().map(|&i| self.scale_of(problem, i)).collect(),
            objective_multipliers: listed(&parts.objectives),
            constraint_multipliers,
            bound_multipliers: parts.lower[..n]
                .iter()
                .copied()
                .zip(parts.upper[..n].iter().copied())
                .collect(),
            active: solution.active.clone(),
            kkt: solution.kkt,
            counts: solution.counts,
            optima: if solution.status.is_solved() {
                vec![(0, 1)]
            } else {
                Vec::new()
            },
            starts,
            is_ambiguous: false,
        }
    }

    /// Every constraint of the file with its multiplier; nonlinear ones once per world.
    fn priced(&self, solution: &Solution) -> Vec<(String, f64)> {
        let parts = &solution.multipliers;
        let worlds = self.worlds.len();
        let mut list = Vec::new();
        for (name, slot) in &self.slots {
            let (prices, from) = match *slot {
                Slot::Linear(l) => {
                    list.push((name.clone(), parts.linear[l]));
                    continue;
                }
                Slot::Inequality(j) => (&parts.inequalities, j * worlds),
                Slot::Equality(k) => (&parts.equalities, k * worlds),
            };
            for (world, price) in self.worlds.iter().zip(&prices[from..from + worlds]) {
                let name = if worlds > 1 {
                    format!("{name} @ {}", world.name)
                } else {
                    name.clone()
                };
                list.push((name, *price));
            }
        }
        list
    }

    /// The objectives of a front's problem at a point, in the order of the file, without scaling. The front has magnitudes;
    /// the file's objectives keep their signs.
    pub(crate) fn objectives_at(&self, problem: &Problem<'_>, x: &[f64]) -> Vec<f64> {
        let mut values = vec![f64::NAN; problem.function_count()];
        problem.model().values(x, &mut values);
        let values = self.unscaled(problem, &values[..problem.objectives().len()]);
        let mut out = vec![f64::NAN; values.len()];
        for (value, place) in values.iter().zip(self.solver_order()) {
            out[place] = *value;
        }
        out
    }

    fn trade(&self, problem: &Problem<'_>, front: Front) -> Trade {
        let order = self.solver_order();
        let points = front
            .points
            .into_iter()
            .map(|point| {
                let in_file = |list: &[f64]| {
                    let mut out = vec![f64::NAN; order.len()];
                    for (value, &place) in list.iter().zip(&order) {
                        out[place] = *value;
                    }
                    out
                };
                Compromise {
                    objectives: self.objectives_at(problem, &point.x),
                    multipliers: point.multipliers.map(|m| in_file(&m.objectives)),
                    x: point.x.clone(),
                }
            })
            .collect();
        Trade {
            points,
            knee: front.knee,
            violation: front.violation,
            counts: front.counts,
        }
    }
}
