//! `soils`: the catalogue.

use std::ffi::OsString;

use grouser_terra::catalogue::{self, Entry};
use serde_json::Value;

use crate::error::Result;
use crate::report::{Object, Report};
use crate::session::Session;
use crate::soil_choice::find;
use grouser_report::Table;
use grouser_report::number::shown;

#[derive(clap::Args, Debug)]
#[command(
    about = "List the soils of the catalogue with their sources",
    after_help = "Examples:\n  grouser soils\n  grouser soils ishigami-simulant"
)]
pub(crate) struct Arguments {
    /// Only these soils, with their notes
    #[arg(value_name = "KEY")]
    keys: Vec<OsString>,
}

pub(crate) fn run(arguments: &Arguments, _session: &mut Session) -> Result<Report> {
    let named: Vec<&Entry> = arguments
        .keys
        .iter()
        .map(|key| find(key))
        .collect::<Result<_>>()?;
    let all = named.is_empty();
    let entries = if all {
        catalogue::entries().iter().collect()
    } else {
        named
    };
    let soils: Object = entries
        .iter()
        .map(|entry| (entry.key.to_owned(), object(entry)))
        .collect();
    let text = if all {
        overview(&entries)
    } else {
        details(&entries)
    };
    let object = Object::from_iter([("soils".to_owned(), Value::Object(soils))]);
    Ok(Report::done(object, text))
}

fn object(entry: &Entry) -> Value {
    let missing: Vec<&str> = entry.missing().collect();
    Object::from_iter(
        [
            ("name", Value::from(entry.name)),
            ("n", Value::from(entry.n)),
            ("k_c_kn_per_m_n1", Value::from(entry.k_c_kn)),
            ("k_phi_kn_per_m_n2", Value::from(entry.k_phi_kn)),
            ("cohesion_kpa", Value::from(entry.cohesion_kpa)),
            ("phi_deg", Value::from(entry.phi_deg)),
            ("k_shear_m", Value::from(entry.k_shear)),
            ("n_1", Value::from(entry.n_1)),
            ("c_1", Value::from(entry.c_1)),
            ("c_2", Value::from(entry.c_2)),
            ("missing", Value::from(missing)),
            ("source", Value::from(entry.source)),
            (
                "note",
                Value::from(Some(entry.note).filter(|note| !note.is_empty())),
            ),
        ]
        .map(|(key, value)| (key.to_owned(), value)),
    )
    .into()
}

fn or_missing(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), shown)
}

fn overview(entries: &[&Entry]) -> String {
    let mut table = Table::new()
        .text("soil")
        .number("n")
        .number("k_c")
        .number("k_phi")
        .number("c kPa")
        .number("φ deg")
        .number("K m")
        .number("c_1")
        .number("c_2")
        .text("source");
    for entry in entries {
        table.row([
            entry.key.to_owned(),
            shown(entry.n),
            shown(entry.k_c_kn),
            shown(entry.k_phi_kn),
            shown(entry.cohesion_kpa),
            shown(entry.phi_deg),
            or_missing(entry.k_shear),
            or_missing(entry.c_1),
            or_missing(entry.c_2),
            entry.source.to_owned(),
        ]);
    }
    table.render()
        + "\nk_c in kN/m^(n+1), k_phi in kN/m^(n+2). A number marked – is not in the source: give it with \
           --k-shear-m, --c-1 or --c-2.\n"
}

fn details(entries: &[&Entry]) -> String {
    let mut table = Table::new().text("").text("");
    for entry in entries {
        let missing: Vec<&str> = entry.missing().collect();
        let missing = if missing.is_empty() {
            "nothing".to_owned()
        } else {
            missing.join(", ")
        };
        let modulus = |value: f64, unit: &str| format!("{} {unit}", shown(value));
        for (name, value) in [
            (entry.key, entry.name.to_owned()),
            ("  n", shown(entry.n)),
            ("  n_1", shown(entry.n_1)),
            ("  k_c", modulus(entry.k_c_kn, "kN/m^(n+1)")),
            ("  k_phi", modulus(entry.k_phi_kn, "kN/m^(n+2)")),
            ("  cohesion", modulus(entry.cohesion_kpa, "kPa")),
            ("  phi", modulus(entry.phi_deg, "deg")),
            ("  K", or_missing(entry.k_shear) + " m"),
            (
                "  c_1, c_2",
                format!("{}, {}", or_missing(entry.c_1), or_missing(entry.c_2)),
            ),
            ("  missing", missing),
            ("  source", entry.source.to_owned()),
            ("  note", entry.note.to_owned()),
        ] {
            table.row([name, &value]);
        }
    }
    table.render_body()
}
