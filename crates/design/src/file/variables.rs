//! `[variables]`.

use grouser_files::Section;
use grouser_opt::Variable;

use crate::error::{Error, Result};
use crate::formula::is_free_name;
use crate::quantity::{Parameter, Quantity};

const FINITE: (f64, f64) = (f64::MIN, f64::MAX);
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// `name = { start, lower, upper, unit }`, in the order of the file.
pub(super) fn read_variables(section: &Section<'_>) -> Result<(Vec<Variable>, Vec<String>)> {
    let mut list = (Vec::new(), Vec::new());
    for entry in section.entries() {
        let name = entry.name();
        let refuse = |reason| Error::Name {
            at: entry.place().clone(),
            name: name.chars().take(64).collect(),
            what: "variable",
            reason,
        };
        if !is_free_name(name) {
            return Err(refuse(
                "names have small letters, digits and `_`, begin with no digit and are no function",
            ));
        }
        let is_parameter = Parameter::named(name).is_some();
        if Quantity::named(name).is_some() && !is_parameter {
            return Err(refuse("it is a quantity that is computed"));
        }
        let (variable, unit) = entry.section("a table with `start`", |table| {
            let start = table.number("start", FINITE)?;
            let lower = table.optional_number("lower", ANY)?;
            let upper = table.optional_number("upper", ANY)?;
            let unit = table.optional_text("unit")?.unwrap_or_default();
            let variable = Variable::bounded(
                name,
                start,
                lower.unwrap_or(f64::NEG_INFINITY),
                upper.unwrap_or(f64::INFINITY),
            );
            if variable.lower > variable.upper {
                return Err(Error::Contradiction {
                    at: table.place_of("upper"),
                    message: format!(
                        "the bounds of `{name}` are inconsistent: lower {} is greater than upper {}",
                        variable.lower, variable.upper
                    ),
                });
            }
            Ok::<_, Error>((variable, unit.to_owned()))
        })?;
        list.0.push(variable);
        list.1.push(unit);
    }
    Ok(list)
}
