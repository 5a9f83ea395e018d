//! From the formulas of a builder to the functions that the solver evaluates.

use std::sync::Arc;

use grouser_files::Place as FilePlace;
use grouser_opt::LinearConstraint;
use grouser_terra::OutOfRange;

use super::ObjectiveParams;
use crate::design::{Constraint, Design, Objective, Program, Slot, Task};
use crate::error::{Error, Result};
use crate::formula::{Formula, FormulaError, Relation, constraint};
use crate::quantity::{Fixed, POINT, Parameter, Place};
use crate::scope::{Scope, first_missing};

fn refuse(at: &FilePlace, name: &str, source: FormulaError) -> Error {
    Error::Formula {
        at: at.clone(),
        name: name.chars().take(64).collect(),
        source,
    }
}

pub(super) fn objective(
    params: &ObjectiveParams,
    at: &FilePlace,
    task: Task,
    scope: &Scope,
) -> Result<Objective> {
    let name = &params.name;
    if !(params.scale > 0.0 && params.scale.is_finite()) {
        return Err(Error::File(grouser_files::Error::OutOfRange {
            at: at.clone(),
            range: OutOfRange {
                field: "scale".to_owned(),
                value: params.scale,
                low: f64::MIN_POSITIVE,
                high: f64::MAX,
                unit: "",
            },
        }));
    }
    if params.maximise && params.absolute {
        return Err(Error::Contradiction {
            at: at.clone(),
            message: format!("objective `{name}` is both maximised and `absolute`"),
        });
    }
    let has_goals = matches!(task, Task::Attain | Task::Chebyshev);
    if has_goals && params.goal.is_none() {
        return Err(Error::Contradiction {
            at: at.clone(),
            message: format!(
                "objective `{name}` has no `goal`, which method \"{}\" needs",
                task.name()
            ),
        });
    }
    Ok(Objective {
        name: name.clone(),
        text: params.formula.clone(),
        scale: params.scale,
        goal: params.goal.filter(|_| has_goals),
        weight: params.weight,
        absolute: params.absolute,
        maximise: params.maximise,
        formula: Formula::parse(&params.formula, scope).map_err(|e| refuse(at, name, e))?,
    })
}

/// A constraint as f ≤ 0 or f = 0.
pub(super) struct RawConstraint<'a> {
    pub(super) name: String,
    pub(super) formula: Formula,
    relation: Relation,
    pub(super) at: &'a FilePlace,
}

pub(super) fn raw_constraint<'a>(
    name: &str,
    text: &str,
    at: &'a FilePlace,
    scope: &Scope,
) -> Result<RawConstraint<'a>> {
    let (left, relation, right) = constraint(text, scope).map_err(|e| refuse(at, name, e))?;
    let difference = left.minus(&right);
    Ok(RawConstraint {
        name: name.to_owned(),
        formula: match relation {
            Relation::AtLeast => difference.negated(),
            Relation::AtMost | Relation::Equal => difference,
        },
        relation,
        at,
    })
}

/// Puts the formulas in the solver's order.
pub(super) fn compile(design: &mut Design) {
    let mut rows: Vec<(Formula, f64)> = design
        .solver_order()
        .into_iter()
        .map(|i| {
            let objective = &design.objectives[i];
            (objective.formula.clone(), objective.factor())
        })
        .collect();
    for equal in [false, true] {
        let own = design.constraints.iter().filter(|c| c.equal == equal);
        rows.extend(own.map(|c| (c.formula.clone(), 1.0)));
    }
    let count = design.program.scope.count();
    let plain = rows
        .iter()
        .all(|(formula, _)| formula.variables().iter().all(|index| *index < count));
    design.program = Arc::new(Program {
        rows,
        plain,
        ..(*design.program).clone()
    });
}

pub(super) struct Sorted {
    pub(super) linear: Vec<LinearConstraint>,
    pub(super) constraints: Vec<Constraint>,
    pub(super) slots: Vec<(String, Slot)>,
}

/// Linear constraints apart from the others: the solver never leaves them.
pub(super) fn sort(
    raw: Vec<RawConstraint<'_>>,
    variables: usize,
    solver_name: impl Fn(&str) -> String,
) -> Sorted {
    let mut sorted = Sorted {
        linear: Vec::new(),
        constraints: Vec::new(),
        slots: Vec::new(),
    };
    for RawConstraint {
        name,
        formula,
        relation,
        ..
    } in raw
    {
        let equal = relation == Relation::Equal;
        let same = |c: &&Constraint| c.equal == equal;
        let slot = if let Some(affine) = formula.affine(variables) {
            let row = if equal {
                LinearConstraint::equal
            } else {
                LinearConstraint::at_most
            };
            sorted.linear.push(row(
                solver_name(&name),
                affine.coefficients,
                -affine.constant,
            ));
            Slot::Linear(sorted.linear.len() - 1)
        } else {
            let place = sorted.constraints.iter().filter(same).count();
            sorted.constraints.push(Constraint {
                name: solver_name(&name),
                formula,
                equal,
            });
            if equal {
                Slot::Equality(place)
            } else {
                Slot::Inequality(place)
            }
        };
        sorted.slots.push((name, slot));
    }
    sorted
}

/// Everything that a formula's names need must be given.
pub(super) fn check_needs(
    at: &FilePlace,
    name: &str,
    scope: &Scope,
    fixed: &Fixed,
    formula: &Formula,
) -> Result<()> {
    let missing = |quantity: &'static str, parameter: Parameter| Error::MissingParameter {
        at: at.clone(),
        name: name.to_owned(),
        quantity,
        parameter: parameter.name(),
        section: match parameter.place() {
            Place::Wheel => "wheel",
            Place::Soil => "soil",
            Place::State => "state",
        },
    };
    let (parameters, quantities) = scope.used(formula);
    if let Some(parameter) = first_missing(scope, fixed, &parameters) {
        return Err(missing(parameter.name(), parameter));
    }
    let given = |p: Parameter| first_missing(scope, fixed, &[p]).is_none();
    let loaded = given(Parameter::Load);
    for quantity in quantities {
        let mut needs = quantity.needs();
        if quantity.needs_sinkage_or_load() {
            if loaded {
                needs.extend_from_slice(&POINT);
            } else {
                needs.push(Parameter::Sinkage);
            }
        }
        if let Some(parameter) = first_missing(scope, fixed, &needs) {
            return Err(missing(quantity.name(), parameter));
        }
    }
    Ok(())
}
