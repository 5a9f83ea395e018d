//! `[objectives]` and `[constraints]`.

use grouser_files::{Entry, Place, Section};

use crate::design::{Objective, Task};
use crate::error::{Error, Result};
use crate::formula::{Formula, FormulaError, Relation, constraint};
use crate::scope::Scope;

const FINITE: (f64, f64) = (f64::MIN, f64::MAX);

fn refuse(entry: &Entry<'_, '_>, source: FormulaError) -> Error {
    Error::Formula {
        at: entry.place().clone(),
        name: entry.name().chars().take(64).collect(),
        source,
    }
}

/// `name = "formula"` or `name = { expr, scale, goal, weight, absolute }`, in the order of the file.
pub(super) fn read_objectives(
    section: &Section<'_>,
    scope: &Scope,
    task: Task,
    absolute: bool,
) -> Result<Vec<(Objective, Place)>> {
    let mut list = Vec::new();
    for entry in section.entries() {
        let formula = |text: &str| Formula::parse(text, scope).map_err(|e| refuse(&entry, e));
        let mut objective = match entry.as_text() {
            Some(text) => Objective {
                name: entry.name().to_owned(),
                text: text.to_owned(),
                scale: 1.0,
                goal: None,
                weight: 1.0,
                absolute,
                formula: formula(text)?,
            },
            None => entry.section("a formula, or a table with `expr`", |table| {
                let text = table.text("expr")?;
                let at_least_0 = (0.0, f64::MAX);
                let scale = table.optional_number("scale", FINITE)?.unwrap_or(1.0);
                if !(scale > 0.0) {
                    return Err(Error::File(grouser_files::Error::OutOfRange {
                        at: table.place_of("scale"),
                        key: "scale".to_owned(),
                        value: scale,
                        low: f64::MIN_POSITIVE,
                        high: f64::MAX,
                    }));
                }
                Ok::<_, Error>(Objective {
                    name: entry.name().to_owned(),
                    text: text.to_owned(),
                    scale,
                    goal: table.optional_number("goal", FINITE)?,
                    weight: table.optional_number("weight", at_least_0)?.unwrap_or(1.0),
                    absolute: absolute || table.flag("absolute")?,
                    formula: formula(text)?,
                })
            })?,
        };
        match task {
            Task::Attain | Task::Chebyshev if objective.goal.is_none() => {
                return Err(Error::Contradiction {
                    at: entry.place().clone(),
                    message: format!(
                        "objective `{}` has no `goal`, which method \"{}\" needs",
                        objective.name,
                        task.name()
                    ),
                });
            }
            Task::Attain | Task::Chebyshev => {}
            _ => objective.goal = None,
        }
        list.push((objective, entry.place().clone()));
    }
    Ok(list)
}

/// A constraint as f ≤ 0 or f = 0.
pub(super) struct RawConstraint {
    pub(super) name: String,
    pub(super) formula: Formula,
    pub(super) relation: Relation,
    pub(super) at: Place,
}

/// `name = "expression relation expression"`, in the order of the file.
pub(super) fn read_constraints(section: &Section<'_>, scope: &Scope) -> Result<Vec<RawConstraint>> {
    section
        .entries()
        .into_iter()
        .map(|entry| {
            let (left, relation, right) =
                constraint(entry.text()?, scope).map_err(|e| refuse(&entry, e))?;
            let difference = left.minus(&right);
            Ok(RawConstraint {
                name: entry.name().to_owned(),
                formula: match relation {
                    Relation::AtLeast => difference.negated(),
                    Relation::AtMost | Relation::Equal => difference,
                },
                relation,
                at: entry.place().clone(),
            })
        })
        .collect()
}
