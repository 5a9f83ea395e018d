//! `soils`: the catalogue.

use std::ffi::OsString;

use grouser_terra::catalogue::{self, Entry};

use crate::error::Result;
use crate::session::Session;
use crate::soil_choice::find;
use crate::verb_report::Report;
use grouser_report::{Fields, fields};

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
    let named: Vec<&'static Entry> = arguments
        .keys
        .iter()
        .map(|key| find(key))
        .collect::<Result<_>>()?;
    let all = named.is_empty();
    let entries: Vec<&'static Entry> = if all {
        catalogue::entries().iter().collect()
    } else {
        named
    };
    let text = if all {
        overview(&entries)
    } else {
        entries.iter().map(|entry| details(entry)).collect()
    };
    Ok(Report::done(fields().object(&entries), text))
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    fields().schema()
}

fn fields<'a>() -> Fields<'a, &'a [&'static Entry]> {
    fields! { |entries: &'a [&'static Entry]|
        "soils" "the soils of the catalogue" named(soil()) = entries.iter().map(|entry| (entry.key, *entry));
    }
}

fn soil<'a>() -> Fields<'a, &'static Entry> {
    fields! { |soil: &'static Entry|
        "name" "name" .shown("") = soil.name;
        "n" "n" .shown("") = soil.n;
        "k_c_kn_per_m_n1" "k_c" .shown("kN/m^(n+1)") = soil.k_c_kn;
        "k_phi_kn_per_m_n2" "k_phi" .shown("kN/m^(n+2)") = soil.k_phi_kn;
        "cohesion_kpa" "cohesion" .shown("kPa") = soil.cohesion_kpa;
        "phi_deg" "phi" .shown("deg") = soil.phi_deg;
        "k_shear_m" "K" .shown("m") = soil.k_shear;
        "n_1" "n_1" .shown("") = soil.n_1;
        "c_1" "c_1" .shown("") = soil.c_1;
        "c_2" "c_2" .shown("") = soil.c_2;
        "missing" "numbers that the source does not give" = soil.missing().collect::<Vec<_>>();
        remark "missing" = missing(soil);
        "source" "source" .shown("") = soil.source;
        "note" "note" .shown("").missing("") = Some(soil.note).filter(|note| !note.is_empty());
    }
}

fn missing(soil: &Entry) -> String {
    let missing: Vec<&str> = soil.missing().collect();
    if missing.is_empty() {
        "nothing".to_owned()
    } else {
        missing.join(", ")
    }
}

fn overview(entries: &[&'static Entry]) -> String {
    let columns = fields! { |soil: &'static Entry|
        remark "soil" = soil.key;
        join(self::soil()) = soil;
    };
    let columns = columns
        .at("k_c_kn_per_m_n1")
        .shown("")
        .at("k_phi_kn_per_m_n2")
        .shown("")
        .at("cohesion_kpa")
        .label("c")
        .at("phi_deg")
        .label("φ");
    let keys =
        "soil,n,k_c_kn_per_m_n1,k_phi_kn_per_m_n2,cohesion_kpa,phi_deg,k_shear_m,c_1,c_2,source";
    let keys: Vec<&str> = keys.split(',').collect();
    format!(
        "{} soils; k_c in kN/m^(n+1), k_phi in kN/m^(n+2)\nA number marked - is not in the source: give it with --k-shear-m, --c-1 or --c-2.\n\n{}",
        entries.len(),
        columns.pick(&keys).table(entries.iter().copied())
    )
}

fn details(soil: &'static Entry) -> String {
    let numbers = [
        "n",
        "k_c_kn_per_m_n1",
        "k_phi_kn_per_m_n2",
        "cohesion_kpa",
        "phi_deg",
        "k_shear_m",
        "n_1",
        "c_1",
        "c_2",
    ];
    let note = if soil.note.is_empty() { "-" } else { soil.note };
    format!(
        "{}: {}\n{}missing: {}\nsource: {}\nnote: {note}\n",
        soil.key,
        soil.name,
        self::soil().pick(&numbers).lines(soil),
        missing(soil),
        soil.source
    )
}
