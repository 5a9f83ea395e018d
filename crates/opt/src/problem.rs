//! What is to be solved: variables, functions and linear constraints, checked once.

use std::collections::BTreeSet;

use crate::error::{Error, Result};
use crate::model::Model;
use crate::record::{Record, Recorded};

/// One variable: where the search starts and how far it may go.
///
/// ```
/// use grouser_opt::Variable;
///
/// let radius = Variable::bounded("radius", 0.12, 0.05, 0.3);
/// assert_eq!((radius.lower, radius.upper), (0.05, 0.3));
/// assert_eq!(Variable::free("x", 0.0).upper, f64::INFINITY);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Variable {
    /// Its name in every report.
    pub name: String,
    /// Where the search starts; moved onto the nearer bound if it lies outside.
    pub start: f64,
    /// The least value allowed; −∞ for none.
    pub lower: f64,
    /// The greatest value allowed; +∞ for none.
    pub upper: f64,
}

impl Variable {
    /// A variable without bounds.
    #[must_use]
    pub fn free(name: impl Into<String>, start: f64) -> Self {
        Self::bounded(name, start, f64::NEG_INFINITY, f64::INFINITY)
    }

    /// A variable between two bounds.
    #[must_use]
    pub fn bounded(name: impl Into<String>, start: f64, lower: f64, upper: f64) -> Self {
        Self {
            name: name.into(),
            start,
            lower,
            upper,
        }
    }
}

/// How a linear expression relates to its bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// a·x ≤ b.
    AtMost,
    /// a·x = b.
    Equal,
}

/// A row of A x ≤ b or A_eq x = b_eq. No iterate ever leaves these, once inside.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinearConstraint {
    /// Its name in every report.
    pub name: String,
    /// One coefficient per variable.
    pub coefficients: Vec<f64>,
    /// ≤ or =.
    pub relation: Relation,
    /// The right-hand side.
    pub bound: f64,
}

impl LinearConstraint {
    /// coefficients · x ≤ bound.
    ///
    /// ```
    /// use grouser_opt::{LinearConstraint, Relation};
    ///
    /// let row = LinearConstraint::at_most("sum", vec![1.0, 1.0], 3.0);
    /// assert_eq!(row.relation, Relation::AtMost);
    /// ```
    #[must_use]
    pub fn at_most(name: impl Into<String>, coefficients: Vec<f64>, bound: f64) -> Self {
        let (name, relation) = (name.into(), Relation::AtMost);
        Self {
            name,
            coefficients,
            relation,
            bound,
        }
    }

    /// coefficients · x = bound.
    ///
    /// ```
    /// use grouser_opt::{LinearConstraint, Relation};
    ///
    /// let row = LinearConstraint::equal("difference", vec![1.0, -1.0], 0.0);
    /// assert_eq!(row.relation, Relation::Equal);
    /// ```
    #[must_use]
    pub fn equal(name: impl Into<String>, coefficients: Vec<f64>, bound: f64) -> Self {
        let relation = Relation::Equal;
        Self {
            relation,
            ..Self::at_most(name, coefficients, bound)
        }
    }
}

/// Everything a [`Problem`] is made of.
///
/// ```
/// use grouser_opt::{Differences, LinearConstraint, Method, Problem, ProblemParams, Settings, Variable, solve};
///
/// // x² + y² on the line x + y = 2: the optimum is (1, 1), where the objective is 2.
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = x[0] * x[0] + x[1] * x[1]);
/// let params = ProblemParams::new(&[3.0, 0.0], 1, model)
///     .variables([Variable::bounded("x", 3.0, 0.0, 5.0), Variable::free("y", 0.0)])
///     .linear([LinearConstraint::equal("line", vec![1.0, 1.0], 2.0)]);
/// let solution = solve(&Problem::new(params)?, &Method::Minimax, &Settings::default())?;
/// assert!((solution.maximum - 2.0).abs() < 1e-6);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
#[non_exhaustive]
pub struct ProblemParams<'a> {
    /// The variables, in the order of the model's `x`.
    pub variables: Vec<Variable>,
    /// The objectives' names, in the model's order.
    pub objectives: Vec<String>,
    /// The names of the inequalities c(x) ≤ 0, which follow the objectives in the model.
    pub inequalities: Vec<String>,
    /// The names of the equalities c_eq(x) = 0, which follow the inequalities in the model.
    pub equalities: Vec<String>,
    /// A x ≤ b and A_eq x = b_eq.
    pub linear: Vec<LinearConstraint>,
    /// So many of the first objectives count with their absolute value.
    pub absolute: usize,
    /// So many neighbours among the objectives are one objective in as many worlds: a weighted sum counts the worst of them.
    pub worlds: usize,
    /// The functions.
    pub model: Box<dyn Model + 'a>,
}

impl<'a> ProblemParams<'a> {
    /// Objectives f1, f2, … over free variables x1, x2, … with these starts, and nothing else.
    pub fn new(start: &[f64], objectives: usize, model: impl Model + 'a) -> Self {
        Self {
            variables: start
                .iter()
                .enumerate()
                .map(|(i, &start)| Variable::free(format!("x{}", i + 1), start))
                .collect(),
            objectives: (1..=objectives).map(|i| format!("f{i}")).collect(),
            inequalities: Vec::new(),
            equalities: Vec::new(),
            linear: Vec::new(),
            absolute: 0,
            worlds: 1,
            model: Box::new(model),
        }
    }

    /// These variables.
    #[must_use]
    pub fn variables(mut self, variables: impl IntoIterator<Item = Variable>) -> Self {
        self.variables = variables.into_iter().collect();
        self
    }

    /// These names of the objectives.
    #[must_use]
    pub fn objectives(mut self, names: impl IntoIterator<Item = String>) -> Self {
        self.objectives = names.into_iter().collect();
        self
    }

    /// These names of the inequalities c(x) ≤ 0.
    #[must_use]
    pub fn inequalities(mut self, names: impl IntoIterator<Item = String>) -> Self {
        self.inequalities = names.into_iter().collect();
        self
    }

    /// These names of the equalities c_eq(x) = 0.
    #[must_use]
    pub fn equalities(mut self, names: impl IntoIterator<Item = String>) -> Self {
        self.equalities = names.into_iter().collect();
        self
    }

    /// These linear constraints.
    #[must_use]
    pub fn linear(mut self, rows: impl IntoIterator<Item = LinearConstraint>) -> Self {
        self.linear = rows.into_iter().collect();
        self
    }

    /// The first `count` objectives count with their absolute value.
    #[must_use]
    pub fn absolute(mut self, count: usize) -> Self {
        self.absolute = count;
        self
    }

    /// Each objective stands `count` times, once in each world.
    #[must_use]
    pub fn worlds(mut self, count: usize) -> Self {
        self.worlds = count;
        self
    }
}

/// A checked optimisation problem.
///
/// ```
/// use grouser_opt::{Differences, Problem, ProblemParams};
///
/// let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = x[0]);
/// let problem = Problem::new(ProblemParams::new(&[3.0], 1, model))?;
/// assert_eq!(problem.objectives(), ["f1"]);
/// assert_eq!(problem.variables()[0].start, 3.0);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub struct Problem<'a> {
    params: ProblemParams<'a>,
    /// The number of leading variables that enter the functions nonlinearly.
    curved: usize,
}

impl<'a> Problem<'a> {
    /// Checks the parameters.
    ///
    /// # Errors
    /// No variables or objectives; a start, coefficient or right-hand side that is not finite; a bound
    /// that is NaN or a lower one above its upper one; a row of the wrong length; a name used twice;
    /// more absolute objectives than objectives; worlds that objectives, or absolute ones, are no multiple of.
    pub fn new(params: ProblemParams<'a>) -> Result<Self> {
        if params.variables.is_empty() {
            return Err(Error::Empty { what: "variables" });
        }
        if params.objectives.is_empty() {
            return Err(Error::Empty { what: "objectives" });
        }
        check_names(params.variables.iter().map(|v| &v.name))?;
        check_names(
            params
                .objectives
                .iter()
                .chain(&params.inequalities)
                .chain(&params.equalities)
                .chain(params.linear.iter().map(|row| &row.name)),
        )?;
        for Variable {
            name,
            start,
            lower,
            upper,
        } in &params.variables
        {
            Error::check_finite("start", name, *start)?;
            for (field, bound, useless) in [
                ("lower", *lower, f64::INFINITY),
                ("upper", *upper, f64::NEG_INFINITY),
            ] {
                if bound.is_nan() || bound == useless {
                    let (name, value) = (name.clone(), bound);
                    return Err(Error::NotFinite { field, name, value });
                }
            }
            if lower > upper {
                return Err(Error::InconsistentBounds {
                    name: name.clone(),
                    lower: *lower,
                    upper: *upper,
                });
            }
        }
        for row in &params.linear {
            Error::check_length(
                &format!("the row `{}`", row.name),
                row.coefficients.len(),
                params.variables.len(),
            )?;
            Error::check_finite("right-hand side", &row.name, row.bound)?;
            for &coefficient in &row.coefficients {
                Error::check_finite("coefficient", &row.name, coefficient)?;
            }
        }
        if params.absolute > params.objectives.len() {
            return Err(Error::TooLarge {
                what: "the number of absolute objectives",
                given: params.absolute,
                limit: params.objectives.len(),
            });
        }
        for (what, count) in [
            ("the objectives of all worlds", params.objectives.len()),
            ("the absolute objectives of all worlds", params.absolute),
        ] {
            let whole = count.next_multiple_of(params.worlds.max(1));
            Error::check_length(what, count, whole)?;
        }
        let curved = params.variables.len();
        Ok(Self { params, curved })
    }

    /// Declares that the variables after the first `curved` ones enter the functions linearly.
    pub(crate) fn with_curved(mut self, curved: usize) -> Self {
        self.curved = curved;
        self
    }

    pub(crate) fn curved(&self) -> usize {
        self.curved
    }

    /// The same problem from another start.
    ///
    /// # Errors
    /// The start has the wrong length or is not finite.
    ///
    /// ```
    /// use grouser_opt::{Differences, Problem, ProblemParams};
    ///
    /// let model = Differences::new(|x: &[f64], f: &mut [f64]| f[0] = x[0]);
    /// let problem = Problem::new(ProblemParams::new(&[3.0], 1, model))?;
    /// assert_eq!(problem.from_start(&[7.0])?.variables()[0].start, 7.0);
    /// assert!(problem.from_start(&[f64::NAN]).is_err());
    /// # Ok::<(), grouser_opt::Error>(())
    /// ```
    pub fn from_start<'b>(&'b self, start: &[f64]) -> Result<Problem<'b>> {
        Error::check_length("the start", start.len(), self.params.variables.len())?;
        let mut variables = self.params.variables.clone();
        for (variable, &value) in variables.iter_mut().zip(start) {
            Error::check_finite("start", &variable.name, value)?;
            variable.start = value;
        }
        Ok(self.with(variables, Box::new(&self.params.model)))
    }

    /// The same problem, each evaluation of which is noted.
    pub(crate) fn recorded<'b>(&'b self, record: &'b dyn Record) -> Problem<'b> {
        let model = Box::new(Recorded::new(self.model(), self.function_count(), record));
        self.with(self.params.variables.clone(), model)
    }

    fn with<'b>(&self, variables: Vec<Variable>, model: Box<dyn Model + 'b>) -> Problem<'b> {
        Problem {
            params: ProblemParams {
                variables,
                objectives: self.params.objectives.clone(),
                inequalities: self.params.inequalities.clone(),
                equalities: self.params.equalities.clone(),
                linear: self.params.linear.clone(),
                absolute: self.params.absolute,
                worlds: self.params.worlds,
                model,
            },
            curved: self.curved,
        }
    }

    /// The variables.
    #[must_use]
    pub fn variables(&self) -> &[Variable] {
        &self.params.variables
    }

    /// The objectives' names.
    #[must_use]
    pub fn objectives(&self) -> &[String] {
        &self.params.objectives
    }

    /// The names of the inequalities c(x) ≤ 0.
    #[must_use]
    pub fn inequalities(&self) -> &[String] {
        &self.params.inequalities
    }

    /// The names of the equalities c_eq(x) = 0.
    #[must_use]
    pub fn equalities(&self) -> &[String] {
        &self.params.equalities
    }

    /// The linear constraints.
    #[must_use]
    pub fn linear(&self) -> &[LinearConstraint] {
        &self.params.linear
    }

    /// So many of the first objectives count with their absolute value.
    #[must_use]
    pub fn absolute(&self) -> usize {
        self.params.absolute
    }

    /// The objectives' places, those of one objective in every world together, with their weights where these are above 0: one
    /// of weight 0 may have no value.
    pub(crate) fn weighted<'w>(
        &self,
        weights: &'w [f64],
    ) -> impl Iterator<Item = Vec<(usize, f64)>> + 'w {
        let worlds = self.params.worlds.max(1);
        weights.chunks(worlds).enumerate().map(move |(group, own)| {
            let places = (worlds * group..).zip(own.iter().copied());
            places.filter(|(_, weight)| *weight > 0.0).collect()
        })
    }

    /// The functions.
    #[must_use]
    pub fn model(&self) -> &(dyn Model + 'a) {
        &*self.params.model
    }

    /// Objectives and nonlinear constraints together.
    #[must_use]
    pub fn function_count(&self) -> usize {
        self.objectives().len() + self.inequalities().len() + self.equalities().len()
    }

    /// The name of a function of the model; empty past the last.
    #[must_use]
    pub fn function_name(&self, index: usize) -> &str {
        self.objectives()
            .iter()
            .chain(self.inequalities())
            .chain(self.equalities())
            .nth(index)
            .map_or("", String::as_str)
    }

    /// Both bounds of every variable, which must be finite.
    pub(crate) fn finite_box(&self, purpose: &'static str) -> Result<(Vec<f64>, Vec<f64>)> {
        for Variable {
            name, lower, upper, ..
        } in self.variables()
        {
            if !(lower.is_finite() && upper.is_finite()) {
                return Err(Error::UnboundedVariable {
                    name: name.clone(),
                    lower: *lower,
                    upper: *upper,
                    purpose,
                });
            }
        }
        Ok(self.variables().iter().map(|v| (v.lower, v.upper)).unzip())
    }
}

fn check_names<'n>(names: impl Iterator<Item = &'n String>) -> Result<()> {
    let mut seen = BTreeSet::new();
    for name in names {
        if !seen.insert(name) {
            return Err(Error::DuplicateName { name: name.clone() });
        }
    }
    Ok(())
}
