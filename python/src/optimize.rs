//! Optimisation of functions written in Python, and of problem files.

use std::ops::ControlFlow;
use std::path::PathBuf;

use grouser::design::{self, Answer, Design};
use grouser::files::Document;
use grouser::opt::{
    Counts, Front, LinearConstraint, Measure, Method, MultiStart, ParetoSettings, Problem,
    ProblemParams, Relation, Settings, Solution, Status, Variable, World, multi_start_with,
    pareto_with, robust, solve_with,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::callable::{Callable, Failure};
use crate::error::{Details, input_error, raised};
use crate::workers;

/// Variables: name, start, lower and upper bound.
type Variables = Vec<(String, f64, f64, f64)>;
/// Linear constraints: name, coefficients, equality, bound.
type LinearRows = Vec<(String, Vec<f64>, bool, f64)>;

/// What a problem in Python consists of.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Parts {
    functions: Py<PyAny>,
    gradients: Option<Py<PyAny>>,
    variables: Variables,
    objectives: Vec<String>,
    inequalities: Vec<String>,
    equalities: Vec<String>,
    linear: LinearRows,
    absolute: usize,
    /// Names of the worlds of a robust problem; empty for none.
    worlds: Vec<String>,
    /// `worst-case`, `mean-plus-deviations` or `cvar`, and its parameter.
    measure: (String, f64),
    /// `minimax`, `attain`, `weighted` or `chebyshev`, with goals and weights.
    method: (String, Vec<f64>, Vec<f64>),
    /// Tolerances of optimality, constraints and steps.
    tolerances: (f64, f64, f64),
    /// Greatest numbers of iterations and values, and pairs of probes.
    limits: (usize, usize, usize),
}

impl Parts {
    fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        (
            settings.optimality_tolerance,
            settings.constraint_tolerance,
            settings.step_tolerance,
        ) = self.tolerances;
        (
            settings.max_iterations,
            settings.max_values,
            settings.probes,
        ) = self.limits;
        settings
    }

    fn method(&self) -> PyResult<Method> {
        let (name, goals, weights) = self.method.clone();
        Ok(match name.as_str() {
            "minimax" => Method::Minimax,
            "attain" => Method::Attain { goals, weights },
            "weighted" => Method::Weighted { weights },
            "chebyshev" => Method::Chebyshev {
                ideal: goals,
                weights,
            },
            _ => return Err(unknown("method", &name)),
        })
    }

    fn measure(&self) -> PyResult<Measure> {
        let (name, parameter) = &self.measure;
        Ok(match name.as_str() {
            "worst-case" | "worst_case" => Measure::WorstCase,
            "mean-plus-deviations" | "mean_plus_deviations" => {
                Measure::MeanPlusDeviations { kappa: *parameter }
            }
            "cvar" => Measure::ConditionalValueAtRisk { alpha: *parameter },
            _ => return Err(unknown("measure", name)),
        })
    }

    fn callable(&self, world: Option<usize>, failure: &Failure) -> Callable {
        let bounds = self.variables.iter().map(|v| (v.2, v.3)).unzip();
        let (functions, gradients) = Python::attach(|py| {
            let gradients = self.gradients.as_ref().map(|g| g.clone_ref(py));
            (self.functions.clone_ref(py), gradients)
        });
        Callable::new(functions, gradients, world, bounds, failure.clone())
    }

    fn params(&self, failure: &Failure) -> ProblemParams<'static> {
        let mut params = ProblemParams::new(&[], 0, self.callable(None, failure));
        let variables = self.variables.iter();
        params.variables = variables
            .map(|(name, start, lower, upper)| Variable::bounded(name, *start, *lower, *upper))
            .collect();
        params.objectives.clone_from(&self.objectives);
        params.inequalities.clone_from(&self.inequalities);
        params.equalities.clone_from(&self.equalities);
        let linear = self.linear.iter().cloned();
        params.linear = linear
            .map(|(name, coefficients, is_equal, bound)| {
                let mut row = LinearConstraint::at_most(name, coefficients, bound);
                if is_equal {
                    row.relation = Relation::Equal;
                }
                row
            })
            .collect();
        params.absolute = self.absolute;
        params
    }

    /// Runs `job` with the problem, or with the problem over all worlds.
    fn with_problem<T>(
        &self,
        failure: &Failure,
        job: impl FnOnce(&Problem<'_>) -> grouser::opt::Result<T>,
    ) -> PyResult<T> {
        let params = self.params(failure);
        if self.worlds.is_empty() {
            return raised(Problem::new(params).and_then(|problem| job(&problem)));
        }
        let worlds = self.worlds.iter().enumerate();
        let worlds = worlds
            .map(|(k, name)| World::new(name, self.callable(Some(k), failure)))
            .collect();
        let joint = robust(params, worlds, self.measure()?);
        raised(joint.and_then(|joint| job(&joint)))
    }
}

fn unknown(field: &str, name: &str) -> PyErr {
    input_error(
        format!("{field} is unknown: `{name}`"),
        Details::field(field),
    )
}

/// Solves a problem from its start, on the caller's thread; `progress` is called once an iteration with the
/// iteration, the point, the utility and the violation, and ends the solve by returning `False`.
#[pyfunction]
pub(crate) fn solve<'py>(
    py: Python<'py>,
    parts: Parts,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let failure = Failure::default();
    let (method, settings) = (parts.method()?, parts.settings());
    let solution = py.detach(|| {
        parts.with_problem(&failure, |problem| {
            let mut callback = |state: &grouser::opt::Progress<'_>| {
                let result = Python::attach(|py| {
                    // a large subproblem calls no function for minutes
                    py.check_signals()?;
                    let Some(progress) = &progress else {
                        return Ok(true);
                    };
                    let point = (
                        state.iteration,
                        state.x.to_vec(),
                        state.utility,
                        state.violation,
                    );
                    let goes_on = progress.bind(py).call1(point)?;
                    Ok::<_, PyErr>(goes_on.is_none() || goes_on.is_truthy()?)
                });
                match result {
                    Ok(true) => failure.goes_on(),
                    Ok(false) => ControlFlow::Break(()),
                    Err(error) => {
                        failure.set(Some(error));
                        ControlFlow::Break(())
                    }
                }
            };
            solve_with(problem, &method, &settings, &mut callback)
        })
    });
    failure.raise()?;
    solution_dict(py, &solution?)
}

/// Solves a problem from many starts; returns the best solution and the different optima.
#[pyfunction]
pub(crate) fn solve_many<'py>(
    py: Python<'py>,
    parts: Parts,
    starts: usize,
    seed: u64,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let failure = Failure::default();
    let (method, settings) = (parts.method()?, parts.settings());
    let inner = failure.clone();
    let found = workers::interruptible(
        py,
        threads,
        move || {
            parts.with_problem(&inner, |problem| {
                multi_start_with(problem, &method, &settings, (starts, seed), &mut |_| {
                    inner.goes_on()
                })
            })
        },
        || failure.set(None),
    )?;
    failure.raise()?;
    many_dict(py, &found?)
}

fn many_dict<'py>(py: Python<'py>, found: &MultiStart) -> PyResult<Bound<'py, PyDict>> {
    let dict = solution_dict(py, found.best())?;
    let optima: Vec<(&Vec<f64>, f64, usize)> = found
        .optima
        .iter()
        .map(|optimum| {
            let run = &found.runs[optimum.run];
            (&run.x, run.utility, optimum.reached_by.len())
        })
        .collect();
    dict.set_item("optima", optima)?;
    dict.set_item("is_ambiguous", found.is_ambiguous())?;
    dict.set_item("counts", counts_dict(py, &found.counts)?)?;
    Ok(dict)
}

/// The Pareto front of a problem.
#[pyfunction]
pub(crate) fn solve_front<'py>(
    py: Python<'py>,
    parts: Parts,
    population: usize,
    generations: usize,
    polish: bool,
    seed: u64,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let failure = Failure::default();
    let mut settings = ParetoSettings::default();
    settings.population = population;
    settings.generations = generations;
    settings.polish = polish;
    settings.seed = seed;
    settings.solve = parts.settings();
    let inner = failure.clone();
    let objectives = parts.objectives.len();
    let front = workers::interruptible(
        py,
        threads,
        move || {
            parts.with_problem(&inner, |problem| {
                pareto_with(problem, &settings, &mut |_| inner.goes_on())
            })
        },
        || failure.set(None),
    )?;
    failure.raise()?;
    let dict = front_dict(py, &front?)?;
    dict.set_item("objective_count", objectives)?;
    Ok(dict)
}

fn front_dict<'py>(py: Python<'py>, front: &Front) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let points = &front.points;
    let x: Vec<Vec<f64>> = points.iter().map(|point| point.x.clone()).collect();
    let multipliers: Vec<Option<Vec<f64>>> = points
        .iter()
        .map(|point| point.multipliers.as_ref().map(|m| m.objectives.clone()))
        .collect();
    dict.set_item("x", x)?;
    dict.set_item("objectives", front.objectives())?;
    dict.set_item("multipliers", multipliers)?;
    dict.set_item("knee", front.knee)?;
    dict.set_item("violation", front.violation)?;
    dict.set_item("counts", counts_dict(py, &front.counts)?)?;
    Ok(dict)
}

fn counts_dict<'py>(py: Python<'py>, counts: &Counts) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("iterations", counts.iterations)?;
    dict.set_item("values", counts.values)?;
    dict.set_item("jacobians", counts.jacobians)?;
    dict.set_item("probes", counts.probes)?;
    Ok(dict)
}

fn violations(status: &Status) -> Vec<(String, f64)> {
    match status {
        Status::NoFeasiblePoint(violations) => violations
            .iter()
            .map(|violation| (violation.name.clone(), violation.amount))
            .collect(),
        _ => Vec::new(),
    }
}

fn solution_dict<'py>(py: Python<'py>, solution: &Solution) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("status", solution.status.name())?;
    dict.set_item("is_solved", solution.status.is_solved())?;
    dict.set_item("violations", violations(&solution.status))?;
    dict.set_item("x", &solution.x)?;
    dict.set_item("objectives", &solution.objectives)?;
    dict.set_item("maximum", solution.maximum)?;
    dict.set_item("utility", solution.utility)?;
    dict.set_item("inequalities", &solution.inequalities)?;
    dict.set_item("equalities", &solution.equalities)?;
    let multipliers = PyDict::new(py);
    let m = &solution.multipliers;
    for (name, values) in [
        ("objectives", &m.objectives),
        ("hard_goals", &m.hard_goals),
        ("inequalities", &m.inequalities),
        ("equalities", &m.equalities),
        ("linear", &m.linear),
        ("lower", &m.lower),
        ("upper", &m.upper),
    ] {
        multipliers.set_item(name, values)?;
    }
    dict.set_item("multipliers", multipliers)?;
    dict.set_item("active", &solution.active)?;
    dict.set_item("stationarity", solution.kkt.stationarity)?;
    dict.set_item("violation", solution.kkt.violation)?;
    dict.set_item("counts", counts_dict(py, &solution.counts)?)?;
    dict.set_item("optima", Vec::<(Vec<f64>, f64, usize)>::new())?;
    dict.set_item("is_ambiguous", false)?;
    Ok(dict)
}

/// Solves a problem file, or the text of one: formulas over what a wheel on soil does.
#[pyfunction]
pub(crate) fn solve_file<'py>(
    py: Python<'py>,
    path: Option<PathBuf>,
    text: Option<String>,
    threads: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let document = match (path, text) {
        (Some(path), _) => raised(Document::read(&path))?,
        (None, text) => raised(Document::from_text("problem", text.unwrap_or_default()))?,
    };
    let design: Design = raised(design::parse(&document))?;
    let stop = Failure::default();
    let inner = stop.clone();
    let (design, answer) = workers::interruptible(
        py,
        threads,
        move || {
            let answer = design.solve_with(&mut |_| inner.goes_on());
            (design, answer)
        },
        || stop.set(None),
    )?;
    answer_dict(py, &design, raised(answer)?)
}

fn answer_dict<'py>(
    py: Python<'py>,
    design: &Design,
    answer: Answer,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item(
        "variables",
        design
            .variables
            .iter()
            .map(|v| v.name.clone())
            .collect::<Vec<_>>(),
    )?;
    match answer {
        Answer::Optimum(optimum) => {
            dict.set_item("status", optimum.status.name())?;
            dict.set_item("is_solved", optimum.status.is_solved())?;
            dict.set_item("violations", violations(&optimum.status))?;
            dict.set_item("x", &optimum.x)?;
            dict.set_item("objectives", &optimum.objectives)?;
            dict.set_item("maximum", optimum.maximum)?;
            dict.set_item("utility", optimum.utility)?;
            dict.set_item("attainment", optimum.attainment)?;
            dict.set_item("objective_multipliers", &optimum.objective_multipliers)?;
            dict.set_item("constraint_multipliers", &optimum.constraint_multipliers)?;
            dict.set_item("bound_multipliers", &optimum.bound_multipliers)?;
            dict.set_item("active", &optimum.active)?;
            dict.set_item("stationarity", optimum.kkt.stationarity)?;
            dict.set_item("violation", optimum.kkt.violation)?;
            dict.set_item("is_ambiguous", optimum.is_ambiguous)?;
            dict.set_item("counts", counts_dict(py, &optimum.counts)?)?;
            let starts = &optimum.starts;
            let optima: Vec<(Vec<f64>, f64, usize)> = optimum
                .optima
                .iter()
                .map(|(index, count)| (starts[*index].x.clone(), starts[*index].utility, *count))
                .collect();
            dict.set_item("optima", optima)?;
        }
        Answer::Trade(trade) => {
            let points = &trade.points;
            let x: Vec<&Vec<f64>> = points.iter().map(|point| &point.x).collect();
            let objectives: Vec<&Vec<f64>> = points.iter().map(|p| &p.objectives).collect();
            let multipliers: Vec<&Option<Vec<f64>>> =
                points.iter().map(|p| &p.multipliers).collect();
            dict.set_item("x", x)?;
            dict.set_item("objectives", objectives)?;
            dict.set_item("multipliers", multipliers)?;
            dict.set_item("objective_count", design.objectives.len())?;
            dict.set_item("knee", trade.knee)?;
            dict.set_item("violation", trade.violation)?;
            dict.set_item("counts", counts_dict(py, &trade.counts)?)?;
        }
        _ => {}
    }
    Ok(dict)
}
