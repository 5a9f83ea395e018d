//! The description of a unit, `modelDescription.xml`.
//!
//! Source: Functional Mock-up Interface Specification 3.0, section 2.4 (schema of the FMI description).

use std::fmt::Write as _; // writing to a String cannot fail

use grouser_terra::SolveStatus;

use crate::model::Model;
use crate::variables::{STATUS, TIME, VARIABLES, cautions};

/// Units of the variables: their names, and exponents and factor in base units.
const UNITS: &str = r#"<UnitDefinitions>
<Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit>
<Unit name="N.m"><BaseUnit kg="1" m="2" s="-2"/></Unit>
<Unit name="deg"><BaseUnit rad="1" factor="0.017453292519943295"/></Unit>
<Unit name="m"><BaseUnit m="1"/></Unit>
<Unit name="s"><BaseUnit s="1"/></Unit>
</UnitDefinitions>
<TypeDefinitions>
<EnumerationType name="Status">
"#;

/// From the end of the types to the first variables.
const AFTER_TYPES: &str = r#"</EnumerationType>
</TypeDefinitions>
<LogCategories>
<Category name="logStatusWarning" description="no solution"/>
<Category name="logStatusError" description="calls that the unit refuses"/>
</LogCategories>
<ModelVariables>
"#;

/// What every output but the continuous ones has.
const DISCRETE: &str = r#"causality="output" variability="discrete" initial="calculated""#;

/// The text of the description of `model` by its name, what it is, and its token.
pub(crate) fn description(model: &Model, name: &str, what: &str, token: &str) -> String {
    let (what, version) = (escaped(what), env!("CARGO_PKG_VERSION"));
    let mut xml = format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="{name}" instantiationToken="{token}" description="{what}" generationTool="grouser {version}">
<CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true" canGetAndSetFMUState="true" providesDirectionalDerivatives="true"/>
{UNITS}"#
    );
    for status in SolveStatus::ALL {
        let (key, code) = (status.key(), status.code());
        let _ = writeln!(xml, r#"<Item name="{key}" value="{code}"/>"#);
    }
    xml += AFTER_TYPES;
    let _ = writeln!(
        xml,
        r#"<Float64 name="time" valueReference="{TIME}" causality="independent" variability="continuous" unit="s"/>"#
    );
    let mut outputs = vec![];
    for (reference, (place, variable)) in (1..).zip(VARIABLES.iter().enumerate()) {
        let kind = if let Some((low, high)) = variable.limits {
            let start = model.start[place];
            format!(r#"causality="input" start="{start:?}" min="{low:?}" max="{high:?}""#)
        } else {
            outputs.push(reference);
            r#"causality="output" initial="calculated""#.to_owned()
        };
        let (name, unit, meaning) = (variable.name, variable.unit, variable.meaning);
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(r#" unit="{unit}""#)
        };
        let _ = writeln!(
            xml,
            r#"<Float64 name="{name}" valueReference="{reference}" {kind} variability="continuous"{unit} description="{meaning}"/>"#
        );
    }
    outputs.push(STATUS);
    let _ = writeln!(
        xml,
        r#"<Enumeration name="status" valueReference="{STATUS}" declaredType="Status" {DISCRETE} description="how the solve ended; numbers are NaN unless it is ok"/>"#
    );
    for (reference, caution) in cautions() {
        let (key, words) = (
            caution.key().replace('-', "_"),
            escaped(&caution.to_string()),
        );
        outputs.push(reference);
        let _ = writeln!(
            xml,
            r#"<Boolean name="caution_{key}" valueReference="{reference}" {DISCRETE} description="{words}"/>"#
        );
    }
    xml += "</ModelVariables>\n<ModelStructure>\n";
    for element in ["Output", "InitialUnknown"] {
        for output in &outputs {
            // each depends on all inputs
            let _ = writeln!(
                xml,
                r#"<{element} valueReference="{output}" dependencies="1 2 3"/>"#
            );
        }
    }
    xml + "</ModelStructure>\n</fmiModelDescription>\n"
}

/// Text in an attribute, or between tags.
pub(crate) fn escaped(text: &str) -> String {
    let text = text
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;");
    text.replace('"', "&quot;").replace(char::is_control, " ")
}
