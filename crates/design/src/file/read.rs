//! The file as a whole.

use std::path::Path;

use grouser_files::{Document, Section};
use grouser_opt::{Algorithm, MAX_POPULATION, Measure, ParetoSettings, Settings, Variable};

use super::soils::{read_fixed, read_worlds};
use super::variables::{read_constraints, read_objectives, read_variables};
use crate::builder::DesignBuilder;
use crate::design::{Design, Task};
use crate::error::Result;

/// Starts of a problem whose file names none and whose variables all have finite bounds: a local search from one
/// start finds one of several optima. Eight found the best of each shipped problem (`tests/refuted.rs`).
const BOUNDED_STARTS: usize = 8;

/// Reads a problem file.
///
/// # Errors
/// What is missing or wrong in the file, with its place.
///
/// ```
/// let design = grouser_design::read("../../examples/problems/paper.toml".as_ref())?;
/// assert!(!design.objectives.is_empty());
/// # Ok::<(), grouser_design::Error>(())
/// ```
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
    let mut builder = DesignBuilder::new(document.name());
    builder.title = root.optional_text("title")?.map(str::to_owned);
    root.optional_text("note")?;
    builder.task = root.choice("method", &Task::ALL)?;
    let absolute = root.flag("absolute")?;
    let starts = whole(root, "starts", 0, (1, 1_000_000))?;
    builder.seed = root.optional_integer("seed")?.unwrap_or(1).unsigned_abs();
    root.section("variables", |section| read_variables(section, &mut builder))?;
    read_fixed(root, &mut builder)?;
    read_worlds(root, &mut builder)?;
    root.section("objectives", |section| {
        read_objectives(section, absolute, &mut builder)
    })?;
    root.section("constraints", |section| {
        read_constraints(section, &mut builder)
    })?;
    builder.settings = root.section("settings", read_settings)?.unwrap_or_default();
    builder.pareto = root.section("pareto", read_pareto)?.unwrap_or_default();
    let bounded = |(v, ..): &(Variable, _, _)| v.lower.is_finite() && v.upper.is_finite();
    // a conditional value at risk has helper variables without bounds
    let spread = builder.task != Task::Pareto
        && !matches!(builder.measure, Measure::ConditionalValueAtRisk { .. })
        && builder.variables.iter().all(bounded);
    builder.starts = match starts {
        0 if spread => BOUNDED_STARTS,
        0 => 1,
        given => given,
    };
    builder.build()
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
        _ => Err(section
            .out_of_range(key, given as f64, (low as f64, high as f64))
            .into()),
    }
}

fn read_settings(section: &Section<'_>) -> Result<Settings> {
    let mut settings = Settings::default();
    let tolerance = |key, default| {
        section
            .optional_number(key, (0.0, 1.0))
            .map(|given| given.unwrap_or(default))
    };
    settings.optimality_tolerance =
        tolerance("optimality_tolerance", settings.optimality_tolerance)?;
    settings.constraint_tolerance =
        tolerance("constraint_tolerance", settings.constraint_tolerance)?;
    settings.step_tolerance = tolerance("step_tolerance", settings.step_tolerance)?;
    let iterations = settings.max_iterations;
    settings.max_iterations = whole(section, "max_iterations", iterations, (0, 1_000_000_000))?;
    settings.max_values = whole(
        section,
        "max_values",
        settings.max_values,
        (1, 1_000_000_000),
    )?;
    Ok(settings)
}

fn read_pareto(section: &Section<'_>) -> Result<ParetoSettings> {
    let mut settings = ParetoSettings::default();
    let algorithms = [("nsga2", Algorithm::NsgaII), ("nsga3", Algorithm::NsgaIII)];
    settings.divisions = match section.optional_integer("divisions")? {
        Some(_) => Some(whole(section, "divisions", 1, (1, 1000))?),
        None => None,
    };
    settings.algorithm = section.optional_choice("algorithm", &algorithms)?;
    settings.population = whole(
        section,
        "population",
        settings.population,
        (4, i64::from(MAX_POPULATION)),
    )?;
    settings.generations = whole(section, "generations", settings.generations, (0, 1_000_000))?;
    settings.polish = !section.flag("keep_unpolished")?;
    Ok(settings)
}
