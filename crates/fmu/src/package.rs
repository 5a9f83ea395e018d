//! The file of a unit: description, library, resources, documentation.

use std::env::consts::{ARCH, DLL_SUFFIX, OS};

use crate::archive::archive;
use crate::description::{description, escaped};
use crate::error::{Error, Result};
use crate::model::Model;
use crate::resources;

/// Folder of the binaries of this platform, by the names of the standard.
fn platform() -> String {
    let system = if OS == "macos" { "darwin" } else { OS };
    format!("{ARCH}-{system}")
}

/// The bytes of the unit of `model`: `name` is the model's identifier, `soil` the name of the soil and its source, `library` the
/// shared library of this crate for this platform.
///
/// The same arguments yield the same bytes. Example: the crate's front page.
///
/// # Errors
/// [`Error::Name`]; [`grouser_terra::Error::Missing`] for a soil that soil files have no keys for.
pub fn package(model: &Model, name: &str, soil: (&str, &str), library: &[u8]) -> Result<Vec<u8>> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if !name.chars().all(is_word) || name.chars().next().is_none_or(|c| c.is_ascii_digit()) {
        let name = name.to_owned();
        return Err(Error::Name { name });
    }
    let soil_text = resources::soil_text(model, soil)?;
    // whoever opens the unit compares description and resources by it
    let content = format!("{soil_text}{}", resources::wheel_text(model, ""));
    let token = format!(
        "{}-{:08x}",
        env!("CARGO_PKG_VERSION"),
        crc32fast::hash(content.as_bytes())
    );
    let wheel = model.pair().wheel();
    let what = format!(
        "wheel of radius {} m and width {} m on {}",
        wheel.radius(),
        wheel.width(),
        soil.0
    );
    let xml = description(model, name, &what, &token).into_bytes();
    let binary = format!("binaries/{}/{name}{DLL_SUFFIX}", platform());
    let wheel = resources::wheel_text(model, &token).into_bytes();
    let page = documentation(&what, soil.1).into_bytes();
    let licence = include_bytes!("../LICENSE-MIT").to_vec();
    archive(&[
        ("modelDescription.xml", xml),
        (&binary, library.to_vec()),
        ("resources/soil.toml", soil_text.into_bytes()),
        ("resources/wheel.toml", wheel),
        ("documentation/index.html", page),
        ("documentation/licenses/license.txt", licence),
    ])
}

/// The page of documentation.
fn documentation(what: &str, source: &str) -> String {
    let (what, source) = (escaped(what), escaped(source));
    let repository = env!("CARGO_PKG_REPOSITORY");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{what}</title></head><body>\n\
         <p>A {what}. Source of the soil's numbers: {source}.</p>\n\
         <p>The operating point is quasi-static: outputs follow the inputs at once, without motion over time. Where the \
         status is not ok, numbers are NaN. Source: <a href=\"{repository}\">{repository}</a>.</p>\n</body></html>\n"
    )
}
