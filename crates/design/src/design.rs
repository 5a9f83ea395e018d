//! A checked problem, and the functions that the solver works on.

use std::sync::Arc;

use grouser_opt::{
    Binary, DerivativeCheck, Exact, Functions, Jacobian, LinearConstraint, Measure, Model, Node,
    ParetoSettings, Problem, ProblemParams, Settings, Tape, TapedFunctions, Variable, World,
    check_derivatives, robust,
};
use grouser_real::Scalar;
use grouser_terra::{Cautions, ModelError};

use crate::error::{Error, Result};
use crate::formula::Formula;
use crate::quantity::{Fixed, Quantity};
use crate::scope::{Scope, by_name};
use crate::worst_objectives::WorstObjectives;

/// How the objectives are joined.
///
/// ```
/// assert_eq!(grouser_design::Task::Attain.name(), "attain");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The best worst case.
    Minimax,
    /// Goals, as nearly as their weights allow.
    Attain,
    /// The least weighted sum.
    Weighted,
    /// The least weighted distance from the goals.
    Chebyshev,
    /// The whole front.
    Pareto,
}

impl Objective {
    /// What the solver minimises is this times the objective.
    pub(crate) fn factor(&self) -> f64 {
        if self.maximise {
            -self.scale
        } else {
            self.scale
        }
    }
}

impl Task {
    /// Every task by its name in files.
    pub const ALL: [(&'static str, Self); 5] = [
        ("minimax", Self::Minimax),
        ("attain", Self::Attain),
        ("weighted", Self::Weighted),
        ("chebyshev", Self::Chebyshev),
        ("pareto", Self::Pareto),
    ];

    /// Its name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }
}

/// An objective of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Objective {
    /// Its name.
    pub name: String,
    /// Its formula as written.
    pub text: String,
    /// The solver sees scale · f.
    pub scale: f64,
    /// What is to be reached, in the objective's own unit.
    pub goal: Option<f64>,
    /// How much it counts.
    pub weight: f64,
    /// Does |f| count?
    pub absolute: bool,
    /// Is it to be as large as possible?
    pub maximise: bool,
    pub(crate) formula: Formula,
}

/// A nonlinear constraint, as f ≤ 0 or f = 0.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Constraint {
    pub(crate) name: String,
    pub(crate) formula: Formula,
    pub(crate) equal: bool,
}

/// A constraint of the file: its name, and its place among the solver's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    Linear(usize),
    Inequality(usize),
    Equality(usize),
}

/// A world in which the design must hold.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WorldInputs {
    pub(crate) name: String,
    pub(crate) fixed: Fixed,
}

/// A problem file, checked and ready to be solved.
///
/// ```
/// let design = grouser_design::read("../../examples/problems/paper.toml".as_ref())?;
/// assert!(design.check_derivatives(&design.variables.iter().map(|v| v.start).collect::<Vec<_>>(), 1e-5)?.wrong.is_empty());
/// # Ok::<(), grouser_design::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Design {
    /// The file as it was named.
    pub file: String,
    /// A title, if the file gives one.
    pub title: Option<String>,
    /// How the objectives are joined.
    pub task: Task,
    /// The variables, in the order of the file.
    pub variables: Vec<Variable>,
    /// The unit of each variable; empty if the file gives none.
    pub units: Vec<String>,
    /// The objectives, in the order of the file.
    pub objectives: Vec<Objective>,
    /// How many starts.
    pub starts: usize,
    /// The seed of everything random.
    pub seed: u64,
    /// How exactly to solve.
    pub settings: Settings,
    /// How to search for a front.
    pub pareto: ParetoSettings,
    /// The catalogue's key of the soil, if one is used.
    pub soil: Option<String>,
    pub(crate) measure: Measure,
    /// Are the worlds drawn at random?
    pub(crate) sampled: bool,
    pub(crate) worlds: Vec<WorldInputs>,
    pub(crate) linear: Vec<LinearConstraint>,
    pub(crate) constraints: Vec<Constraint>,
    /// The constraints by name, in the order of the file.
    pub(crate) slots: Vec<(String, Slot)>,
    pub(crate) program: Arc<Program>,
}

/// The formulas in the solver's order, and what they need.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(crate) scope: Scope,
    /// (formula, scale), objectives first, those that count by magnitude before the others.
    pub(crate) rows: Vec<(Formula, f64)>,
    pub(crate) quantities: Vec<Quantity>,
    /// Do the formulas use variables alone?
    pub(crate) plain: bool,
}

impl Program {
    /// The rows on a tape; `None` where one uses a number without a node.
    pub(crate) fn rows_on(&self, tape: &mut Tape, numbers: &[Option<Node>]) -> Option<Vec<Node>> {
        let mut nodes = Vec::with_capacity(self.rows.len());
        for (formula, scale) in &self.rows {
            let mut node = formula.onto(tape, numbers)?;
            if *scale != 1.0 {
                let factor = tape.constant(*scale);
                node = tape.binary(Binary::Mul, node, factor);
            }
            nodes.push(node);
        }
        Some(nodes)
    }
}

/// The program in one world.
struct InWorld {
    program: Arc<Program>,
    fixed: Fixed,
}

impl Functions for InWorld {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        let program = &self.program;
        let numbers;
        let at = if program.plain {
            x
        } else {
            numbers = program.scope.numbers(x, &self.fixed, &program.quantities);
            &numbers
        };
        for ((formula, scale), out) in program.rows.iter().zip(out) {
            let value = formula.evaluate(at);
            *out = if *scale == 1.0 {
                value
            } else {
                value * R::from_f64(*scale)
            };
        }
    }
}

/// The functions with exact derivatives, and as operations on a tape where all of them are formulas.
struct WorldModel(Exact<InWorld>);

impl Model for WorldModel {
    fn failure(&self, x: &[f64]) -> Option<String> {
        let Exact(InWorld { program, fixed }) = &self.0;
        let (quantity, reason) = program.scope.no_value(x, fixed, &program.quantities)?;
        Some(format!("`{quantity}` has no value: {reason}"))
    }

    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.0.values(x, values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.0.derivatives(x, values, jacobian);
    }

    fn taped(&self, _variables: usize, _functions: usize) -> Option<TapedFunctions> {
        let Exact(InWorld { program, fixed }) = &self.0;
        let mut tape = Tape::new();
        let (numbers, _) = program
            .scope
            .taped(&mut tape, fixed, &program.quantities, None);
        let functions = program.rows_on(&mut tape, &numbers)?;
        Some(TapedFunctions { tape, functions })
    }
}

/// What a constraint is called among everything that may be active: its name, marked where an objective has
/// the same.
pub(crate) fn told_apart(objectives: &[Objective], name: &str) -> String {
    if objectives.iter().any(|o| o.name == name) {
        format!("{name} (constraint)")
    } else {
        name.to_owned()
    }
}

impl Design {
    /// What a constraint is called in lists that hold objectives too, such as what is active.
    #[must_use]
    pub fn constraint_name(&self, name: &str) -> String {
        told_apart(&self.objectives, name)
    }

    /// The objectives' places in the file, in the solver's order: those that count by magnitude first.
    #[must_use]
    pub fn solver_order(&self) -> Vec<usize> {
        let of = |absolute: bool| {
            let all = self.objectives.iter().enumerate();
            all.filter(move |(_, o)| o.absolute == absolute)
                .map(|(i, _)| i)
        };
        of(true).chain(of(false)).collect()
    }

    pub(crate) fn params(&self) -> ProblemParams<'static> {
        let named = |equal: bool| {
            let own = self.constraints.iter().filter(move |c| c.equal == equal);
            own.map(|c| c.name.clone()).collect::<Vec<_>>()
        };
        let order = self.solver_order();
        ProblemParams::new(&[], 0, self.in_world(0))
            .variables(self.variables.clone())
            .objectives(order.iter().map(|&i| self.objectives[i].name.clone()))
            .inequalities(named(false))
            .equalities(named(true))
            .linear(self.linear.clone())
            .absolute(self.objectives.iter().filter(|o| o.absolute).count())
    }

    fn in_world(&self, world: usize) -> WorldModel {
        WorldModel(Exact(InWorld {
            program: Arc::clone(&self.program),
            fixed: self.worlds[world].fixed,
        }))
    }

    /// The problem that the solver gets.
    pub(crate) fn problem(&self) -> Result<Problem<'static>> {
        let refuse = |source| Error::Problem {
            file: self.file.clone(),
            source,
        };
        if self.worlds.len() == 1 {
            return Problem::new(self.params()).map_err(refuse);
        }
        if !self.has_worst_front() {
            return self.joint_problem();
        }
        let joint = self.joint_problem()?;
        let mut params = self.params();
        params.inequalities = joint.inequalities().to_vec();
        params.equalities = joint.equalities().to_vec();
        params.model = Box::new(WorstObjectives {
            joint,
            objectives: self.objectives.len(),
            absolute: params.absolute,
        });
        Problem::new(params).map_err(refuse)
    }

    /// The problem of all worlds together, each with objectives of its own where the worst counts.
    pub(crate) fn joint_problem(&self) -> Result<Problem<'static>> {
        let worlds = (0..self.worlds.len())
            .map(|w| World::new(self.worlds[w].name.clone(), self.in_world(w)))
            .collect();
        robust(self.params(), worlds, self.measure).map_err(|source| Error::Problem {
            file: self.file.clone(),
            source,
        })
    }

    /// The worlds' names; one without a name if the design is for one world alone.
    #[must_use]
    pub fn worlds(&self) -> Vec<&str> {
        self.worlds.iter().map(|w| w.name.as_str()).collect()
    }

    /// Does the answer depend on the seed: several starts, a front, or sampled worlds?
    #[must_use]
    pub fn draws(&self) -> bool {
        self.starts > 1 || self.task == Task::Pareto || self.sampled
    }

    /// The numbers of `[wheel]`, `[soil]` and `[state]` by name, as the first world has them.
    #[must_use]
    pub fn fixed(&self) -> Vec<(&'static str, f64)> {
        by_name(&self.worlds[0].fixed).into_iter().collect()
    }

    /// A quantity's value at `x` in the first world, for reports; `None` where it has none.
    #[must_use]
    pub fn quantity(&self, quantity: Quantity, x: &[f64]) -> Option<f64> {
        let inputs = self.program.scope.inputs(x, &self.worlds[0].fixed);
        crate::quantity::Evaluation::new(&inputs)
            .quantity(quantity)
            .ok()
    }

    /// What to keep in mind about the wheel at `x`, in any world; nothing for a problem without a wheel under a load or at a
    /// sinkage.
    #[must_use]
    pub fn cautions(&self, x: &[f64]) -> Cautions {
        let mut all = Cautions::default();
        for world in &self.worlds {
            all.insert_all(self.program.scope.inputs(x, &world.fixed).cautions());
        }
        all
    }

    /// What the laws of its soils miss of measured wheels like the one at `x`, in the world where they miss most; `Some(None)` where a
    /// soil's laws were not compared, `None` for a problem without a wheel on a soil.
    #[must_use]
    pub fn model_error(&self, x: &[f64]) -> Option<Option<ModelError>> {
        let worlds = self.worlds.iter();
        let errors = worlds.map(|world| self.program.scope.inputs(x, &world.fixed).model_error());
        errors.reduce(|one, other| match (one?, other?) {
            (Some(one), Some(other)) if one.pull_per_load < other.pull_per_load => {
                Some(Some(other))
            }
            (Some(one), Some(_)) => Some(Some(one)),
            _ => Some(None),
        })?
    }

    /// Compares the exact derivatives of everything the solver sees with finite differences at `x` (the
    /// variables of the file); names each entry that is off by more than the tolerance.
    ///
    /// # Errors
    /// [`Error::Problem`] for a point of the wrong length or not finite.
    pub fn check_derivatives(&self, x: &[f64], tolerance: f64) -> Result<DerivativeCheck> {
        let problem = self.problem()?;
        let mut at: Vec<f64> = problem.variables().iter().map(|v| v.start).collect();
        for (own, given) in at.iter_mut().zip(x) {
            *own = *given;
        }
        check_derivatives(&problem, &at, tolerance).map_err(|source| Error::Problem {
            file: self.file.clone(),
            source,
        })
    }
}
