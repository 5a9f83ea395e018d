//! Writing problem files.

use grouser_files::{Document, TomlText};
use grouser_opt::{Algorithm, ParetoSettings, Settings};

use super::read::parse;
use crate::builder::{DesignBuilder, ObjectiveParams};
use crate::error::{Error, Result};
use crate::quantity::{Parameter, Place};

/// The problem of a builder as a problem file; [`parse`] reads the same numbers back to the same bits.
///
/// # Errors
/// [`Error::Contradiction`] for what a problem file does not hold: several soils, laws beside Bekker's and
/// Janosi's, grousers by their share of the surface, settings without a key. What [`parse`] refuses.
///
/// ```
/// use grouser_design::{Design, State, parse, to_toml};
/// use grouser_files::Document;
/// use grouser_opt::Variable;
/// use grouser_terra::{RigidWheel, catalogue};
///
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let builder = Design::builder(&RigidWheel::new(0.125, 0.1)?, &soil, State::under_load(60.0))
///     .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
///     .maximise("pull", "drawbar_pull_n");
/// let text = to_toml(&builder)?;
/// assert!(text.contains("\"slip\" = { start = 0.2, lower = 0.01, upper = 0.8 }"));
/// let again = parse(&Document::from_text("pull.toml", text)?)?;
/// assert_eq!(again.objectives, builder.build()?.objectives);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_toml(builder: &DesignBuilder) -> Result<String> {
    check(builder)?;
    let mut out = TomlText::new(&[]);
    out.optional_text("title", builder.title.as_deref());
    out.text("method", builder.task.name());
    out.line(&format!("starts = {}", builder.starts));
    out.line(&format!("seed = {}", builder.seed));
    write_variables(builder, &mut out);
    for (place, header) in [
        (Place::Wheel, "[wheel]"),
        (Place::Soil, "[soil]"),
        (Place::State, "[state]"),
    ] {
        out.header(header);
        for (parameter, name, own, _) in Parameter::ALL {
            let value = builder.fixed.get(parameter).filter(|_| own == place);
            out.optional_number(name, value);
        }
    }
    out.header("[objectives]");
    for (objective, _) in &builder.objectives {
        write_objective(objective, &mut out);
    }
    if !builder.constraints.is_empty() {
        out.header("[constraints]");
        for (name, text, _) in &builder.constraints {
            let (name, text) = (TomlText::quoted(name), TomlText::quoted(text));
            out.line(&format!("{name} = {text}"));
        }
    }
    write_settings(&builder.settings, &mut out);
    write_pareto(&builder.pareto, &mut out);
    let text = out.finish();
    parse(&Document::from_text(&builder.name, text.clone())?)?;
    Ok(text)
}

/// What a problem file has no keys for is refused.
fn check(builder: &DesignBuilder) -> Result<()> {
    let pareto = &builder.pareto;
    let foreign = [
        (!builder.worlds.is_empty(), "several soils"),
        (
            builder.fixed.has_more_than_parameters(),
            "laws of the soil or of grousers that problem files have no keys for",
        ),
        (
            builder.settings.probes != Settings::default().probes,
            "another number of probes",
        ),
        (
            pareto.crossover.is_some() || pareto.mutation.is_some(),
            "crossover or mutation",
        ),
    ];
    match foreign.into_iter().find(|(is_there, _)| *is_there) {
        None => Ok(()),
        Some((_, what)) => Err(Error::Contradiction {
            at: builder.place(),
            message: format!("a problem file does not hold {what}"),
        }),
    }
}

fn write_variables(builder: &DesignBuilder, out: &mut TomlText) {
    out.header("[variables]");
    for (variable, unit, _) in &builder.variables {
        let mut fields = vec![format!("start = {:?}", variable.start)];
        for (key, bound) in [("lower", variable.lower), ("upper", variable.upper)] {
            if bound.is_finite() {
                fields.push(format!("{key} = {bound:?}"));
            }
        }
        if !unit.is_empty() {
            fields.push(format!("unit = {}", TomlText::quoted(unit)));
        }
        let name = TomlText::quoted(&variable.name);
        out.line(&format!("{name} = {{ {} }}", fields.join(", ")));
    }
}

fn write_objective(objective: &ObjectiveParams, out: &mut TomlText) {
    let key = if objective.maximise {
        "maximise"
    } else {
        "expr"
    };
    let mut fields = vec![format!("{key} = {}", TomlText::quoted(&objective.formula))];
    fields.push(format!("scale = {:?}", objective.scale));
    if let Some(goal) = objective.goal {
        fields.push(format!("goal = {goal:?}"));
    }
    fields.push(format!("weight = {:?}", objective.weight));
    if objective.absolute {
        fields.push("absolute = true".to_owned());
    }
    let name = TomlText::quoted(&objective.name);
    out.line(&format!("{name} = {{ {} }}", fields.join(", ")));
}

fn write_settings(settings: &Settings, out: &mut TomlText) {
    out.header("[settings]");
    out.number("optimality_tolerance", settings.optimality_tolerance);
    out.number("constraint_tolerance", settings.constraint_tolerance);
    out.number("step_tolerance", settings.step_tolerance);
    out.line(&format!("max_iterations = {}", settings.max_iterations));
    out.line(&format!("max_values = {}", settings.max_values));
}

fn write_pareto(pareto: &ParetoSettings, out: &mut TomlText) {
    out.header("[pareto]");
    if let Some(algorithm) = pareto.algorithm {
        let name = match algorithm {
            Algorithm::NsgaIII => "nsga3",
            _ => "nsga2",
        };
        out.text("algorithm", name);
    }
    out.line(&format!("population = {}", pareto.population));
    out.line(&format!("generations = {}", pareto.generations));
    if let Some(divisions) = pareto.divisions {
        out.line(&format!("divisions = {divisions}"));
    }
    out.flag("keep_unpolished", !pareto.polish);
}
