//! Soil files: a soil of one's own, with the keys of the catalogue.
//!
//! ```toml
//! format = 1
//! name = "Sand of our test bed"
//! source = "plate tests of 2026-03-02"
//! n = 1.1                      # sinkage exponent
//! k_c_kn_per_m_n1 = 0.9        # kN/m^(n+1)
//! k_phi_kn_per_m_n2 = 1528.4   # kN/m^(n+2)
//! cohesion_kpa = 1.0
//! phi_deg = 30.0
//! k_shear_m = 0.025            # this, c_1 and c_2 may come from the command line instead
//! c_1 = 0.18
//! c_2 = 0.32
//! # optional: key, note, n_1, n_2, unit_weight_n_per_m3, rebound,
//! # k_shear_1_m_per_rad, k_shear_side_m, k_shear_side_1_m_per_rad,
//! # rear_driving, transport_layer_m, and the laws that these numbers were identified with:
//! # laws = "drift" (or "classical", the default); single laws in place of the preset's:
//! # rear_drift, sideways_support,
//! # slip_sinkage = "in-plane", "whole", "saturating" or "ploughing", slip_norm = "greater" or "root",
//! # stress_position = "in-plane", "magnitude", "whole", "sliding" or "saturating",
//! # shear = "coupled", "slip-velocity", "independent",
//! # "slip-velocity-regular", "towed-restart" or "towed-wong-reece",
//! # bulldozing = "scaled", "full", "chord", "disc" or "off"
//! # [fitted]                   # the tests behind the numbers: outside them a result carries a caution
//! # slip_min = -0.7            # slip_max, slip_angle_min_deg, slip_angle_max_deg, width_min_m, width_max_m,
//! #                            # load_min_n, load_max_n
//! ```
//!
//! [`to_toml`] writes such a file.

mod number;
mod write;

use std::ffi::OsStr;
use std::path::Path;

use grouser_terra::catalogue::Completion;
use grouser_terra::{
    Angle, Bekker, Bulldozing, FittedRange, LawChoice, LawPreset, OpenSoil, Pressure, ShearLaw,
    SlipNorm, SlipSinkage, Soil, StressPosition,
};

use crate::document::Document;
use crate::error::{Error, Result};
use crate::section::Section;

pub use number::SoilNumber;
pub use write::to_toml;

/// Is a soil's name that of a file, not a key of the catalogue: is there a slash or a dot in it?
///
/// ```
/// use grouser_files::soil::names_file;
///
/// assert!(names_file("sand.toml".as_ref()) && !names_file("dry-sand".as_ref()));
/// ```
#[must_use]
pub fn names_file(name: &OsStr) -> bool {
    let bytes = name.as_encoded_bytes();
    bytes.iter().any(|byte| matches!(byte, b'/' | b'.'))
}

/// What a soil file says.
///
/// ```
/// use grouser_files::{Document, soil};
/// use grouser_terra::catalogue::Completion;
///
/// let text = "format = 1\nname = \"sand\"\nk_c_kn_per_m_n1 = 0.99\nk_phi_kn_per_m_n2 = 1528.0\nn = 1.1\ncohesion_kpa = 1.04\nphi_deg = 28.0\n";
/// let file = soil::parse(&Document::from_text("sand.toml", text.into())?)?;
/// assert_eq!(file.soil.missing().collect::<Vec<_>>(), ["k_shear", "c_1", "c_2"]);
/// let completion = Completion { k_shear: Some(0.018), c_1: Some(0.4), c_2: Some(0.2), ..Completion::default() };
/// assert_eq!(file.completed(&completion)?.params().cohesion, 1040.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SoilFile {
    /// Its key, if it gives one.
    pub key: Option<String>,
    /// Its name.
    pub name: String,
    /// Where its numbers come from; empty if it does not say.
    pub source: String,
    /// What else it says; empty if nothing.
    pub note: String,
    /// Its numbers; K, c_1 and c_2 may be open.
    pub soil: OpenSoil,
}

/// Reads a soil file.
///
/// # Errors
/// What the file lacks or says wrong, with its place.
pub fn read(path: &Path) -> Result<SoilFile> {
    parse(&Document::read(path)?)
}

/// Reads a soil out of a document.
///
/// # Errors
/// As [`read`].
pub fn parse(document: &Document) -> Result<SoilFile> {
    document.parse(|root| {
        let text = |key| Ok(root.optional_text(key)?.unwrap_or_default().to_owned());
        let file = SoilFile {
            key: root.optional_text("key")?.map(Into::into),
            name: root.text("name")?.to_owned(),
            source: text("source")?,
            note: text("note")?,
            // the soil checks them, below
            soil: read_numbers(root, false, |key| root.optional_unchecked_number(key))?,
        };
        // Everything given is checked here, where its place is known; what may still come from elsewhere
        // is checked with harmless numbers in its place.
        let harmless = |given: Option<f64>| given.or(Some(0.1));
        let rest = Completion {
            k_shear: harmless(file.soil.k_shear),
            c_1: harmless(file.soil.c_1),
            c_2: harmless(file.soil.c_2),
            unit_weight: None,
        };
        match file.completed(&rest) {
            Ok(_) => Ok(file),
            Err(source) => Err(root.refused_by_law(source)),
        }
    })
}

/// The numbers and laws of a section that may leave any of them open (zero where zero switches a law off).
/// Nothing is checked but that they are numbers.
///
/// # Errors
/// A value that is no number, or a law that does not exist, with its place.
pub fn read_open(section: &Section<'_>) -> Result<OpenSoil> {
    let finite = (f64::MIN, f64::MAX);
    read_numbers(section, true, |key| section.optional_number(key, finite))
}

/// Reads a soil, each number by `optional`; strength and moduli may be absent where `is_open`.
fn read_numbers(
    root: &Section<'_>,
    is_open: bool,
    optional: impl Fn(&'static str) -> Result<Option<f64>>,
) -> Result<OpenSoil> {
    let number = |key| match optional(key)? {
        None if !is_open => Err(root.missing(key)),
        found => Ok(found),
    };
    let zero = |key| Ok::<_, Error>(optional(key)?.unwrap_or(0.0));
    let kilo = |value: Option<f64>| value.map(|kilo| 1e3 * kilo);
    let n = number("n")?;
    let preset = root
        .optional_choice("laws", &LawPreset::ALL.map(|preset| (preset.key, preset)))?
        .unwrap_or(LawPreset::CLASSICAL);
    Ok(OpenSoil {
        n,
        n_1: zero("n_1")?,
        n_2: zero("n_2")?,
        cohesion: kilo(number("cohesion_kpa")?),
        phi: number("phi_deg")?.map(Angle::from_deg),
        k_shear: optional("k_shear_m")?,
        k_shear_1: zero("k_shear_1_m_per_rad")?,
        k_shear_side: optional("k_shear_side_m")?,
        k_shear_side_1: zero("k_shear_side_1_m_per_rad")?,
        c_1: optional("c_1")?,
        c_2: optional("c_2")?,
        rebound: zero("rebound")?,
        unit_weight: optional("unit_weight_n_per_m3")?,
        rear_driving: zero("rear_driving")?,
        rear_drift: optional("rear_drift")?.unwrap_or(preset.rear_drift),
        transport_layer: zero("transport_layer_m")?,
        sideways_support: optional("sideways_support")?.unwrap_or(preset.sideways_support),
        laws: read_laws(root, preset.laws)?,
        fitted: root.section("fitted", read_fitted)?,
        pressure: Pressure::Bekker(Bekker {
            k_c: kilo(number("k_c_kn_per_m_n1")?),
            k_phi: kilo(number("k_phi_kn_per_m_n2")?),
        }),
    })
}

fn read_fitted(section: &Section<'_>) -> Result<FittedRange> {
    let range = |low_key, high_key, (least, most)| {
        let low = section.number(low_key, (least, most))?;
        Ok::<_, Error>((low, section.number(high_key, (low, most))?))
    };
    let degrees = range("slip_angle_min_deg", "slip_angle_max_deg", (0.0, 90.0))?;
    Ok(FittedRange {
        slip: range("slip_min", "slip_max", (-1.0, 1.0))?,
        slip_angle: (
            Angle::from_deg(degrees.0).rad(),
            Angle::from_deg(degrees.1).rad(),
        ),
        width: range("width_min_m", "width_max_m", (0.0, 100.0))?,
        load: range("load_min_n", "load_max_n", (0.0, 1e12))?,
    })
}

/// The laws of a section; those that it does not name are `own`.
fn read_laws(root: &Section<'_>, own: LawChoice) -> Result<LawChoice> {
    Ok(LawChoice {
        slip_norm: root
            .optional_choice("slip_norm", &SlipNorm::ALL.map(|law| (law.key(), law)))?
            .unwrap_or(own.slip_norm),
        slip_sinkage: root
            .optional_choice(
                "slip_sinkage",
                &SlipSinkage::ALL.map(|law| (law.key(), law)),
            )?
            .unwrap_or(own.slip_sinkage),
        stress_position: root
            .optional_choice(
                "stress_position",
                &StressPosition::ALL.map(|law| (law.key(), law)),
            )?
            .unwrap_or(own.stress_position),
        shear: root
            .optional_choice("shear", &ShearLaw::ALL.map(|law| (law.key(), law)))?
            .or(own.shear),
        bulldozing: root
            .optional_choice("bulldozing", &Bulldozing::ALL.map(|law| (law.key(), law)))?
            .or(own.bulldozing),
    })
}

impl SoilFile {
    /// A soil with its name and source, ready to be written.
    #[must_use]
    pub fn new(name: &str, source: &str, soil: impl Into<OpenSoil>) -> Self {
        Self {
            key: None,
            name: name.to_owned(),
            source: source.to_owned(),
            note: String::new(),
            soil: soil.into(),
        }
    }

    /// The soil, with what `completion` gives in place of the file's own or missing numbers.
    ///
    /// # Errors
    /// [`grouser_terra::Error::Missing`] with the first number that neither gives;
    /// [`grouser_terra::Error::OutOfRange`] for a bad one.
    pub fn completed(
        &self,
        completion: &Completion,
    ) -> std::result::Result<Soil, grouser_terra::Error> {
        completion.complete(&self.soil)
    }
}
