//! The file as a whole.

use std::path::Path;
use std::sync::Arc;

use grouser_files::{Document, Section};
use grouser_opt::{Algorithm, LinearConstraint, ParetoSettings, Settings};

use super::objectives::{RawConstraint, read_constraints, read_objectives};
use super::soils::{Worlds, read_fixed, read_worlds};
use super::variables::read_variables;
use crate::design::{Constraint, Design, Program, Slot, Task, told_apart};
use crate::error::{Error, Result};
use crate::formula::{Formula, Relation};
use crate::quantity::{Parameter, Place, Quantity};
use crate::scope::{Scope, first_missing};

/// Reads a problem file.
///
/// # Errors
/// What the file lacks or says wrong, with its place.
pub fn read(path: &Path) -> Result<Design> {
    parse(&Document::read(path)?)
}

/// Reads a problem out of a document. `format` may be left out.
///
/// # Errors
/// As [`read`].
pub fn parse(document: &Document) -> Result<Design> {
    document.parse_or_format(1, |root| design(document, root))
}

fn design(document: &Document, root: &Section<'_>) -> Result<Design> {
    let title = root.optional_text("title")?.map(str::to_owned);
    root.optional_text("note")?;
    let task = root.choice("method", &Task::ALL)?;
    let absolute = root.flag("absolute")?;
    let starts = whole(root, "starts", 1, (1, 1_000_000))?;
    let seed = root.optional_integer("seed")?.unwrap_or(1);
    let (variables, units) = root
        .section("variables", read_variables)?
        .unwrap_or_default();
    if variables.is_empty() {
        return Err(Error::Contradiction {
            at: root.place_of("variables"),
            message: "the problem has no variables: [variables] is missing or empty".to_owned(),
        });
    }
    let scope = Scope::new(variables.iter().map(|v| v.name.clone()).collect());
    let (soil, fixed) = read_fixed(root, &scope)?;
    let Worlds {
        measure,
        list: worlds,
        sampled,
    } = read_worlds(root, &scope, fixed, seed.unsigned_abs())?;
    let objectives = root
        .section("objectives", |section| {
            read_objectives(section, &scope, task, absolute)
        })?
        .unwrap_or_default();
    if objectives.is_empty() {
        return Err(Error::Contradiction {
            at: root.place_of("objectives"),
            message: "the problem has no objectives: [objectives] is missing or empty".to_owned(),
        });
    }
    let raw = root
        .section("constraints", |section| read_constraints(section, &scope))?
        .unwrap_or_default();
    let mut quantities = Vec::new();
    let formulas = objectives
        .iter()
        .map(|(o, at)| (at, &o.name, &o.formula))
        .chain(raw.iter().map(|c| (&c.at, &c.name, &c.formula)));
    for (at, name, formula) in formulas {
        for world in &worlds {
            check_needs(at, name, &scope, &world.fixed, formula)?;
        }
        quantities.extend(scope.used(formula).1);
    }
    quantities.sort_unstable();
    quantities.dedup();
    let settings = root.section("settings", read_settings)?.unwrap_or_default();
    let pareto = root.section("pareto", read_pareto)?.unwrap_or_default();
    let objectives: Vec<_> = objectives.into_iter().map(|(o, _)| o).collect();
    let Sorted {
        linear,
        constraints,
        slots,
    } = sort(raw, scope.count(), |name| told_apart(&objectives, name));
    let mut design = Design {
        file: document.name().to_owned(),
        title,
        task,
        variables,
        units,
        objectives,
        starts,
        seed: seed.unsigned_abs(),
        pareto: ParetoSettings {
            seed: seed.unsigned_abs(),
            solve: settings.clone(),
            ..pareto
        },
        settings,
        soil,
        measure,
        sampled,
        worlds,
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

/// Puts the formulas in the solver's order.
fn compile(design: &mut Design) {
    let mut rows: Vec<(Formula, f64)> = design
        .solver_order()
        .into_iter()
        .map(|i| {
            let objective = &design.objectives[i];
            (objective.formula.clone(), objective.scale)
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

struct Sorted {
    linear: Vec<LinearConstraint>,
    constraints: Vec<Constraint>,
    slots: Vec<(String, Slot)>,
}

/// Linear constraints apart from the others: the solver never leaves them.
fn sort(raw: Vec<RawConstraint>, variables: usize, solver_name: impl Fn(&str) -> String) -> Sorted {
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
            sorted.linear.push(LinearConstraint {
                name: solver_name(&name),
                coefficients: affine.coefficients,
                relation: if equal {
                    grouser_opt::Relation::Equal
                } else {
                    grouser_opt::Relation::AtMost
                },
                bound: -affine.constant,
            });
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
fn check_needs(
    at: &grouser_files::Place,
    name: &str,
    scope: &Scope,
    fixed: &[f64; Parameter::COUNT],
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
        let mut needs = quantity.needs().to_vec();
        if quantity.needs_sinkage_or_load() {
            if loaded {
                needs.extend_from_slice(Quantity::point_parameters());
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

fn whole(
    section: &Section<'_>,
    key: &'static str,
    default: usize,
    (low, high): (i64, i64),
) -> Result<usize> {
    let Some(given) = section.optional_integer(key)? else {
        return Ok(default);
    };
    match usize::try_from(given) {
        Ok(count) if given >= low && given <= high => Ok(count),
        _ => Err(Error::File(grouser_files::Error::OutOfRange {
            at: section.place_of(key),
            key: key.to_owned(),
            value: given as f64,
            low: low as f64,
            high: high as f64,
        })),
    }
}

fn read_settings(section: &Section<'_>) -> Result<Settings> {
    let default = Settings::default();
    let tolerance = |key, default| {
        section
            .optional_number(key, (0.0, 1.0))
            .map(|given| given.unwrap_or(default))
    };
    Ok(Settings {
        optimality_tolerance: tolerance("optimality_tolerance", default.optimality_tolerance)?,
        constraint_tolerance: tolerance("constraint_tolerance", default.constraint_tolerance)?,
        step_tolerance: tolerance("step_tolerance", default.step_tolerance)?,
        max_iterations: whole(
            section,
            "max_iterations",
            default.max_iterations,
            (0, 1_000_000_000),
        )?,
        max_values: whole(
            section,
            "max_values",
            default.max_values,
            (1, 1_000_000_000),
        )?,
    })
}

fn read_pareto(section: &Section<'_>) -> Result<ParetoSettings> {
    let default = ParetoSettings::default();
    let algorithms = [("nsga2", Algorithm::NsgaII), ("nsga3", Algorithm::NsgaIII)];
    let divisions = match section.optional_integer("divisions")? {
        Some(_) => Some(whole(section, "divisions", 1, (1, 1000))?),
        None => None,
    };
    let keep = section.flag("keep_unpolished")?;
    Ok(ParetoSettings {
        algorithm: section.optional_choice("algorithm", &algorithms)?,
        population: whole(section, "population", default.population, (4, 1_000_000))?,
        generations: whole(section, "generations", default.generations, (0, 1_000_000))?,
        divisions,
        polish: !keep,
        ..default
    })
}
