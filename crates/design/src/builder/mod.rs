//! A design built in a program; problem files are read onto it.

mod compile;

use std::sync::Arc;

use grouser_files::Place as FilePlace;
use grouser_opt::{Measure, ParetoSettings, Settings, Variable};
use grouser_terra::{RigidWheel, Soil};

use crate::design::{Design, Program, Task, WorldInputs, told_apart};
use crate::error::{Error, Result};
use crate::formula::is_free_name;
use crate::quantity::{Fixed, Parameter, Quantity};
use crate::scope::Scope;
use compile::{Sorted, check_needs, compile, objective, raw_constraint, sort};

/// The load or the sinkage of the wheel of a design, and its motion.
///
/// ```
/// use grouser_design::State;
/// let state = State::under_load(60.0).slip(0.2).slope_deg(5.0); // N, and degrees
/// assert_ne!(state, State::at_sinkage(0.01)); // m
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    given: (Parameter, f64),
    slip: Option<f64>,
    slope_deg: Option<f64>,
}

impl State {
    /// A wheel that carries a load, N.
    #[must_use]
    pub const fn under_load(load_n: f64) -> Self {
        Self::new(Parameter::Load, load_n)
    }

    /// A wheel at a sinkage, m.
    ///
    /// ```
    /// use grouser_design::State;
    ///
    /// assert_ne!(State::at_sinkage(0.01), State::at_sinkage(0.02)); // m
    /// ```
    #[must_use]
    pub const fn at_sinkage(sinkage_m: f64) -> Self {
        Self::new(Parameter::Sinkage, sinkage_m)
    }

    const fn new(parameter: Parameter, value: f64) -> Self {
        Self {
            given: (parameter, value),
            slip: None,
            slope_deg: None,
        }
    }

    /// The same state at a slip.
    #[must_use]
    pub const fn slip(mut self, slip: f64) -> Self {
        self.slip = Some(slip);
        self
    }

    /// The same state on a slope, degrees.
    #[must_use]
    pub const fn slope_deg(mut self, slope_deg: f64) -> Self {
        self.slope_deg = Some(slope_deg);
        self
    }
}

/// An objective that a builder is given.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ObjectiveParams {
    /// Its name.
    pub name: String,
    /// Its formula.
    pub formula: String,
    /// The solver minimises scale · f.
    pub scale: f64,
    /// The goal, in the objective's own unit: for goal attainment and Chebyshev distances.
    pub goal: Option<f64>,
    /// Its weight.
    pub weight: f64,
    /// Does |f| count?
    pub absolute: bool,
    /// Is the formula to be as large as possible? Goal and printed value keep the formula's sign.
    pub maximise: bool,
}

impl ObjectiveParams {
    /// An objective of scale 1 and weight 1 without a goal.
    ///
    /// ```
    /// use grouser_design::ObjectiveParams;
    /// let mut pull = ObjectiveParams::new("pull", "-drawbar_pull_n");
    /// pull.goal = Some(-20.0);
    /// assert_eq!(pull.weight, 1.0);
    /// ```
    #[must_use]
    pub fn new(name: impl Into<String>, formula: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            formula: formula.into(),
            scale: 1.0,
            goal: None,
            weight: 1.0,
            absolute: false,
            maximise: false,
        }
    }
}

/// Builds a [`Design`] without a file: [`Design::builder`].
///
/// A name in a formula is a variable, a parameter of the wheel, the soil or the state under its key of problem
/// files (`radius_m`, `phi_deg`, `load_n`), or a [`Quantity`].
///
/// ```
/// use grouser_design::{Answer, Design, State};
/// use grouser_opt::Variable;
/// use grouser_terra::{RigidWheel, catalogue};
///
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let wheel = RigidWheel::new(0.125, 0.10)?;
/// let design = Design::builder(&wheel, &soil, State::under_load(60.0))
///     .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
///     .minimise("efficiency", "-tractive_efficiency")
///     .constraint("reserve", "gradeability_deg >= 3")
///     .build()?;
/// let Answer::Optimum(optimum) = design.solve()? else {
///     unreachable!("minimax gives one point");
/// };
/// assert!((optimum.x[0] - 0.4771).abs() < 1e-3 && optimum.status.is_solved());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct DesignBuilder {
    pub(crate) name: String,
    pub(crate) title: Option<String>,
    pub(crate) task: Task,
    pub(crate) variables: Vec<(Variable, String, FilePlace)>,
    pub(crate) objectives: Vec<(ObjectiveParams, FilePlace)>,
    pub(crate) constraints: Vec<(String, String, FilePlace)>,
    pub(crate) starts: usize,
    pub(crate) seed: u64,
    pub(crate) settings: Settings,
    pub(crate) pareto: ParetoSettings,
    pub(crate) soil: Option<String>,
    pub(crate) measure: Measure,
    pub(crate) sampled: bool,
    pub(crate) fixed: Fixed,
    pub(crate) worlds: Vec<WorldInputs>,
}

impl Design {
    /// A design of a wheel on a soil in a state, to which variables and objectives are added.
    #[must_use]
    pub fn builder(wheel: &RigidWheel, soil: &Soil, state: State) -> DesignBuilder {
        let mut builder = DesignBuilder::new("the design");
        builder.fixed.set_wheel(wheel);
        builder.fixed.set_soil(soil);
        let (given, value) = state.given;
        builder.fixed.set(given, value);
        for (parameter, value) in [
            (Parameter::Slip, state.slip),
            (Parameter::Slope, state.slope_deg),
        ] {
            if let Some(value) = value {
                builder.fixed.set(parameter, value);
            }
        }
        builder
    }
}

impl DesignBuilder {
    pub(crate) fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            title: None,
            task: Task::Minimax,
            variables: Vec::new(),
            objectives: Vec::new(),
            constraints: Vec::new(),
            starts: 1,
            seed: 1,
            settings: Settings::default(),
            pareto: ParetoSettings::default(),
            soil: None,
            measure: Measure::WorstCase,
            sampled: false,
            fixed: Fixed::default(),
            worlds: Vec::new(),
        }
    }

    /// Where errors point to that have no place in a file.
    pub(crate) fn place(&self) -> FilePlace {
        FilePlace {
            file: self.name.clone(),
            line: 1,
            column: 1,
        }
    }

    /// A title for reports.
    #[must_use]
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = Some(title.into());
        self
    }

    /// What becomes of the objectives; minimax where nothing is said.
    #[must_use]
    pub fn task(mut self, task: Task) -> Self {
        self.task = task;
        self
    }

    /// One more variable; it replaces a parameter of its name.
    #[must_use]
    pub fn variable(mut self, variable: Variable) -> Self {
        let at = self.place();
        self.variables.push((variable, String::new(), at));
        self
    }

    /// One more objective, of scale 1 and weight 1.
    #[must_use]
    pub fn minimise(self, name: &str, formula: &str) -> Self {
        self.objective(ObjectiveParams::new(name, formula))
    }

    /// One more objective that is to be as large as possible, of scale 1 and weight 1.
    ///
    /// ```
    /// use grouser_design::{Answer, Design, State};
    /// use grouser_opt::Variable;
    /// use grouser_terra::{RigidWheel, catalogue};
    /// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let design = Design::builder(&RigidWheel::new(0.125, 0.10)?, &soil, State::under_load(60.0))
    ///     .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
    ///     .maximise("efficiency", "tractive_efficiency")
    ///     .build()?;
    /// let Answer::Optimum(optimum) = design.solve()? else { unreachable!("minimax gives one point") };
    /// assert!(optimum.objectives[0].1 > 0.15 && optimum.utility < -0.15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn maximise(self, name: &str, formula: &str) -> Self {
        let mut objective = ObjectiveParams::new(name, formula);
        objective.maximise = true;
        self.objective(objective)
    }

    /// One more objective.
    #[must_use]
    pub fn objective(mut self, objective: ObjectiveParams) -> Self {
        let at = self.place();
        self.objectives.push((objective, at));
        self
    }

    /// One more constraint: two formulas with `<=`, `>=` or `=` between them.
    ///
    /// ```
    /// use grouser_design::{Answer, Design, State};
    /// use grouser_opt::Variable;
    /// use grouser_terra::{RigidWheel, catalogue};
    ///
    /// // The greatest pull at a sinkage of at most 15 mm.
    /// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let design = Design::builder(&RigidWheel::new(0.125, 0.1)?, &soil, State::under_load(60.0))
    ///     .variable(Variable::bounded("width_m", 0.1, 0.05, 0.3))
    ///     .variable(Variable::bounded("slip", 0.3, 0.01, 0.8))
    ///     .maximise("pull", "drawbar_pull_n")
    ///     .constraint("shallow", "sinkage_m <= 0.015")
    ///     .build()?;
    /// let Answer::Optimum(optimum) = design.solve()? else { unreachable!("minimax gives one point") };
    /// assert!(optimum.status.is_solved());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn constraint(mut self, name: impl Into<String>, relation: impl Into<String>) -> Self {
        let at = self.place();
        self.constraints.push((name.into(), relation.into(), at));
        self
    }

    /// The design must hold on each of these soils, whose objectives are joined by `measure`.
    ///
    /// ```
    /// use grouser_design::{Answer, Design, State};
    /// use grouser_opt::{Measure, Variable};
    /// use grouser_terra::{RigidWheel, catalogue};
    ///
    /// let soil = |key| catalogue::find(key).expect("in the catalogue").soil();
    /// let (dry, lunar) = (soil("dry-sand")?, soil("lunar")?);
    /// let design = Design::builder(&RigidWheel::new(0.125, 0.1)?, &dry, State::under_load(60.0))
    ///     .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
    ///     .minimise("pull", "-drawbar_pull_n")
    ///     .worlds(Measure::WorstCase, &[("dry", dry), ("lunar", lunar)])
    ///     .build()?;
    /// assert_eq!(design.worlds(), ["dry", "lunar"]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn worlds(mut self, measure: Measure, soils: &[(&str, Soil)]) -> Self {
        self.measure = measure;
        self.worlds = soils
            .iter()
            .map(|(name, soil)| {
                let mut fixed = self.fixed;
                fixed.set_soil(soil);
                WorldInputs {
                    name: (*name).to_owned(),
                    fixed,
                }
            })
            .collect();
        self
    }

    /// How many starts, and the seed of everything random.
    #[must_use]
    pub fn starts(mut self, starts: usize, seed: u64) -> Self {
        self.starts = starts;
        self.seed = seed;
        self
    }

    /// How exactly to solve.
    #[must_use]
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// How to search for a front; its seed and the settings of its solves are those of the design.
    #[must_use]
    pub fn pareto(mut self, pareto: ParetoSettings) -> Self {
        self.pareto = pareto;
        self
    }

    /// Checks everything.
    ///
    /// # Errors
    /// A formula or a name that is wrong, a number that a quantity needs and nothing gives, a load beside a
    /// sinkage, no variables or no objectives.
    pub fn build(mut self) -> Result<Design> {
        let empty = |what: &str| Error::Contradiction {
            at: self.place(),
            message: format!("the problem has no {what}: [{what}] is missing or empty"),
        };
        if self.variables.is_empty() {
            return Err(empty("variables"));
        }
        if self.objectives.is_empty() {
            return Err(empty("objectives"));
        }
        for (variable, _, at) in &self.variables {
            self.check_variable(variable, at)?;
        }
        let scope = self.scope();
        let has = |p| scope.is_replaced(p) || self.fixed.get(p).is_some();
        if has(Parameter::Load) && has(Parameter::Sinkage) {
            return Err(Error::Contradiction {
                at: self.place(),
                message: "both `load_n` and `sinkage_m` are given; exactly one of them can be"
                    .to_owned(),
            });
        }
        if self.worlds.is_empty() {
            self.worlds.push(WorldInputs {
                name: String::new(),
                fixed: self.fixed,
            });
        }
        let objectives = self
            .objectives
            .iter()
            .map(|(params, at)| objective(params, at, self.task, &scope))
            .collect::<Result<Vec<_>>>()?;
        let raw = self
            .constraints
            .iter()
            .map(|(name, text, at)| raw_constraint(name, text, at, &scope))
            .collect::<Result<Vec<_>>>()?;
        let mut quantities = Vec::new();
        let places = self.objectives.iter().map(|(_, at)| at);
        let formulas = places
            .zip(&objectives)
            .map(|(at, o)| (at, &o.name, &o.formula))
            .chain(raw.iter().map(|c| (c.at, &c.name, &c.formula)));
        for (at, name, formula) in formulas {
            for world in &self.worlds {
                check_needs(at, name, &scope, &world.fixed, formula)?;
            }
            quantities.extend(scope.used(formula).1);
        }
        quantities.sort_unstable();
        quantities.dedup();
        let Sorted {
            linear,
            constraints,
            slots,
        } = sort(raw, scope.count(), |name| told_apart(&objectives, name));
        let mut pareto = self.pareto;
        pareto.seed = self.seed;
        pareto.solve = self.settings.clone();
        let (variables, units) = self.variables.into_iter().map(|(v, u, _)| (v, u)).unzip();
        let mut design = Design {
            file: self.name,
            title: self.title,
            task: self.task,
            variables,
            units,
            objectives,
            starts: self.starts,
            seed: self.seed,
            pareto,
            settings: self.settings,
            soil: self.soil,
            measure: self.measure,
            sampled: self.sampled,
            worlds: self.worlds,
            linear,
            constraints,
            slots,
            program: Arc::new(Program {
                scope,
                rows: Vec::new(),
                quantities,
                plain: false,
            }),
        };
        compile(&mut design);
        Ok(design)
    }

    /// What names mean in its formulas.
    pub(crate) fn scope(&self) -> Scope {
        Scope::new(
            self.variables
                .iter()
                .map(|(v, ..)| v.name.clone())
                .collect(),
        )
    }

    fn check_variable(&self, variable: &Variable, at: &FilePlace) -> Result<()> {
        let name = &variable.name;
        let refuse = |reason| Error::Name {
            at: at.clone(),
            name: name.chars().take(64).collect(),
            what: "variable",
            reason,
        };
        if !is_free_name(name) {
            return Err(refuse(
                "names have small letters, digits and `_`, begin with no digit and are no function",
            ));
        }
        let parameter = Parameter::named(name);
        if Quantity::named(name).is_some() && parameter.is_none() {
            return Err(refuse("it is a quantity that is computed"));
        }
        if parameter.is_some_and(|parameter| self.fixed.is_meaningless(parameter)) {
            return Err(refuse("the soil has another pressure-sinkage law"));
        }
        if variable.lower > variable.upper {
            return Err(Error::Contradiction {
                at: at.clone(),
                message: format!(
                    "the bounds of `{name}` are inconsistent: lower {} is greater than upper {}",
                    variable.lower, variable.upper
                ),
            });
        }
        Ok(())
    }
}
