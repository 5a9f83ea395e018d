//! `[variables]`, `[objectives]` and `[constraints]`.

use grouser_files::Section;
use grouser_opt::Variable;

use crate::builder::{DesignBuilder, ObjectiveParams};
use crate::error::{Error, Result};

const FINITE: (f64, f64) = (f64::MIN, f64::MAX);
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// `name = { start, lower, upper, unit }`, in the order of the file.
pub(super) fn read_variables(section: &Section<'_>, builder: &mut DesignBuilder) -> Result<()> {
    for entry in section.entries() {
        let (variable, unit) = entry.section("a table with `start`", |table| {
            let start = table.number("start", FINITE)?;
            let lower = table.optional_number("lower", ANY)?;
            let upper = table.optional_number("upper", ANY)?;
            let unit = table.optional_text("unit")?.unwrap_or_default();
            let variable = Variable::bounded(
                entry.name(),
                start,
                lower.unwrap_or(f64::NEG_INFINITY),
                upper.unwrap_or(f64::INFINITY),
            );
            Ok::<_, Error>((variable, unit.to_owned()))
        })?;
        let at = entry.place().clone();
        builder.variables.push((variable, unit, at));
    }
    Ok(())
}

/// `name = "formula"` or `name = { expr or maximise, scale, goal, weight, absolute }`, in the order of the file.
pub(super) fn read_objectives(
    section: &Section<'_>,
    absolute: bool,
    builder: &mut DesignBuilder,
) -> Result<()> {
    for entry in section.entries() {
        let mut objective = match entry.as_text() {
            Some(text) => ObjectiveParams::new(entry.name(), text),
            None => entry.section("a formula, or a table with `expr`", |table| {
                let maximise = table.optional_text("maximise")?;
                let text = match maximise {
                    Some(text) => text,
                    None => table.text("expr")?,
                };
                let mut objective = ObjectiveParams::new(entry.name(), text);
                objective.maximise = maximise.is_some();
                objective.scale = table.optional_number("scale", FINITE)?.unwrap_or(1.0);
                objective.goal = table.optional_number("goal", FINITE)?;
                let weight = table.optional_number("weight", (0.0, f64::MAX))?;
                objective.weight = weight.unwrap_or(1.0);
                objective.absolute = table.flag("absolute")?;
                Ok::<_, Error>(objective)
            })?,
        };
        objective.absolute |= absolute;
        builder.objectives.push((objective, entry.place().clone()));
    }
    Ok(())
}

/// `name = "expression relation expression"`, in the order of the file.
pub(super) fn read_constraints(section: &Section<'_>, builder: &mut DesignBuilder) -> Result<()> {
    for entry in section.entries() {
        let row = (
            entry.name().to_owned(),
            entry.text()?.to_owned(),
            entry.place().clone(),
        );
        builder.constraints.push(row);
    }
    Ok(())
}
