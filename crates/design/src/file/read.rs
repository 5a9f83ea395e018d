//! The file as a whole.

use std::path::Path;

use grouser_files::{Document, Section};
use grouser_opt::{Algorithm, MAX_POPULATION, ParetoSettings, Settings, Variable};

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
    let starts = root.optional_whole("starts", (1, 1_000_000))?.unwrap_or(0);
    builder.seed = root.optional_whole("seed", (0, i64::MAX))?.unwrap_or(1);
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
    let spread = builder.task != Task::Pareto && builder.variables.iter().all(bounded);
    builder.starts = match starts {
        0 if spread => BOUNDED_STARTS,
        0 => 1,
        given => given,
    };
    builder.build()
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
    let whole = |key, low, default| -> Result<usize> {
        let given = section.optional_whole(key, (low, 1_000_000_000))?;
        Ok(given.unwrap_or(default))
    };
    settings.max_iterations = whole("max_iterations", 0, settings.max_iterations)?;
    settings.max_values = whole("max_values", 1, settings.max_values)?;
    Ok(settings)
}

fn read_pareto(section: &Section<'_>) -> Result<ParetoSettings> {
    let mut settings = ParetoSettings::default();
    let algorithms = [("nsga2", Algorithm::NsgaII), ("nsga3", Algorithm::NsgaIII)];
    settings.divisions = section.optional_whole("divisions", (1, 1000))?;
    settings.algorithm = section.optional_choice("algorithm", &algorithms)?;
    let whole = |key, limits, default| -> Result<usize> {
        Ok(section.optional_whole(key, limits)?.unwrap_or(default))
    };
    let most = i64::from(MAX_POPULATION);
    settings.population = whole("population", (4, most), settings.population)?;
    settings.generations = whole("generations", (0, 1_000_000), settings.generations)?;
    settings.polish = !section.flag("keep_unpolished")?;
    Ok(settings)
}
