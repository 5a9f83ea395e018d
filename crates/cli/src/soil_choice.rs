//! `--soil` and the flags that complete or override it.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use grouser_files::Document;
use grouser_files::soil::names_file;
use grouser_terra::catalogue::{self, Completion, Entry};
use grouser_terra::{Error as LawError, Soil};

use crate::error::{Error, Result};
use crate::law_error::Names;
use crate::session::Session;
use grouser_report::number::parse_finite;

/// Above the flags of [`Overrides`] in the help.
const HEADING: &str = "Soil (completes or overrides what --soil gives)";

/// The numbers that complete or override a soil.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub(crate) struct Overrides {
    /// Shear deformation modulus K in m
    #[arg(long, help_heading = HEADING, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true)]
    pub(crate) k_shear_m: Option<f64>,
    /// Place of the peak stress without slip, θ_m = (c_1 + c_2 s) θ_1
    #[arg(long = "c-1",
        help_heading = HEADING, value_name = "X", value_parser = parse_finite, allow_hyphen_values = true)]
    pub(crate) c_1: Option<f64>,
    /// Growth of that place with slip
    #[arg(long = "c-2",
        help_heading = HEADING, value_name = "X", value_parser = parse_finite, allow_hyphen_values = true)]
    pub(crate) c_2: Option<f64>,
    /// Unit weight γ = ρ g in N/m³; only the side force needs it
    #[arg(long = "unit-weight-n-per-m3",
        help_heading = HEADING, value_name = "N", value_parser = parse_finite, allow_hyphen_values = true)]
    pub(crate) unit_weight: Option<f64>,
}

impl Overrides {
    /// What was given, by column.
    pub(crate) fn given(&self) -> impl Iterator<Item = (&'static str, f64)> {
        [
            ("k_shear_m", self.k_shear_m),
            ("c_1", self.c_1),
            ("c_2", self.c_2),
            ("unit_weight_n_per_m3", self.unit_weight),
        ]
        .into_iter()
        .filter_map(|(column, value)| Some((column, value?)))
    }

    fn completion(&self) -> Completion {
        Completion {
            k_shear: self.k_shear_m,
            c_1: self.c_1,
            c_2: self.c_2,
            unit_weight: self.unit_weight,
        }
    }
}

/// `--soil` with its overrides.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct SoilArguments {
    /// A key of the catalogue (see `grouser soils`), or a file when it contains `/` or `.`
    #[arg(long, value_name = "KEY|FILE")]
    pub(crate) soil: OsString,
    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

/// A soil and where it comes from.
#[derive(Clone, Debug)]
pub(crate) struct Chosen {
    /// The catalogue's key, or the file.
    pub(crate) name: String,
    /// Where its numbers come from.
    pub(crate) source: String,
    pub(crate) soil: Soil,
    /// The file that was read.
    pub(crate) document: Option<Document>,
}

impl SoilArguments {
    /// The soil, its source noted in the session.
    pub(crate) fn choose(&self, session: &mut Session) -> Result<Chosen> {
        let chosen = choose(&self.soil, &self.overrides)?;
        chosen.note(&self.overrides, session);
        Ok(chosen)
    }
}

impl Chosen {
    /// Notes in the session that the soil entered the result.
    pub(crate) fn note(&self, overrides: &Overrides, session: &mut Session) {
        let given = overrides
            .given()
            .map(|(column, value)| (column.to_owned(), value.into()));
        session.used_soil(&self.name, Some(&self.source), Some(given.collect()));
        if let Some(document) = &self.document {
            session.used_document(document);
        }
    }
}

/// The soil of a key or a file, completed.
pub(crate) fn choose(name: &OsStr, overrides: &Overrides) -> Result<Chosen> {
    let completion = overrides.completion();
    if names_file(name) {
        let document = Document::read(Path::new(name))?;
        let file = grouser_files::soil::parse(&document)?;
        let name = document.name().to_owned();
        let soil = file
            .completed(&completion)
            .map_err(|error| refused(&error, &name, file.soil.missing(), &completion))?;
        let document = Some(document);
        return Ok(Chosen {
            name,
            source: file.source,
            soil,
            document,
        });
    }
    let entry = find(name)?;
    let soil = entry
        .completed(&completion)
        .map_err(|error| refused(&error, entry.key, entry.missing(), &completion))?;
    let (name, source) = (entry.key.to_owned(), entry.source.to_owned());
    Ok(Chosen {
        name,
        source,
        soil,
        document: None,
    })
}

/// The entry of a key, or the nearest one as a hint.
pub(crate) fn find(name: &OsStr) -> Result<&'static Entry> {
    let shown = name.to_string_lossy();
    name.to_str().and_then(catalogue::find).ok_or_else(|| {
        let keys = catalogue::entries().iter().map(|entry| entry.key);
        let hint = match grouser_files::nearest(&shown, keys) {
            Some(key) => format!("did you mean `{key}`? `grouser soils` lists the catalogue"),
            None => {
                "`grouser soils` lists the catalogue; a file's name contains `/` or `.`".to_owned()
            }
        };
        Error::usage(format!("soil `{shown}` is not in the catalogue"), hint)
    })
}

/// All that is missing in one message, by the flags that give it; what is wrong otherwise.
fn refused(
    error: &LawError,
    name: &str,
    missing: impl Iterator<Item = &'static str>,
    given: &Completion,
) -> Error {
    if !matches!(error, LawError::Missing { .. }) {
        return Names::Flags.error(error);
    }
    let is_open = |field: &&str| match *field {
        "k_shear" => given.k_shear.is_none(),
        "c_1" => given.c_1.is_none(),
        "c_2" => given.c_2.is_none(),
        _ => true,
    };
    let flags: Vec<String> = missing
        .filter(is_open)
        .map(|field| Names::Flags.of(field))
        .collect();
    Error::usage(
        format!(
            "missing {} for soil `{name}`, whose source does not give it",
            flags.join(", ")
        ),
        "give the numbers yourself; there is no default that would hold for every soil",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_named_by_its_flags() {
        let none = Overrides::default();
        let message = choose(OsStr::new("hit-lss1"), &none)
            .unwrap_err()
            .to_string();
        assert!(
            message.starts_with("missing `--c-1`, `--c-2` for soil `hit-lss1`"),
            "{message}"
        );
        let some = Overrides {
            c_1: Some(0.4),
            c_2: Some(0.2),
            ..none
        };
        assert_eq!(
            choose(OsStr::new("hit-lss1"), &some)
                .unwrap()
                .soil
                .params()
                .c_1,
            0.4
        );
    }

    #[test]
    fn a_misspelt_key_gets_a_suggestion() {
        let error = choose(OsStr::new("dry_sand"), &Overrides::default()).unwrap_err();
        assert!(error.hint().unwrap().contains("`dry-sand`"));
    }
}
