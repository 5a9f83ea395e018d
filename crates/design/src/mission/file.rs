//! Mission files.

use grouser_files::gravity::read_gravity;
use grouser_files::soil::names_file;
use grouser_files::{Document, Section};
use grouser_terra::slope::MAX_SLIP_LIMITS;

use super::front::Choice;
use super::profile::MAX_SLOPE_DEG;
use super::wheel::SHIFT;
use super::{SoilMeasure, WheelDesign};
use crate::error::{Error, Result};

/// What a mission file holds; everything may be left out.
///
/// ```
/// use grouser_files::Document;
///
/// let text = "format = 1\nmin_reserve = 0.1\n[[slope]]\nslope_deg = 5.0\n[[soil]]\nsoil = \"dry-sand\"\n[wheel]\nradius_m = [0.1, 0.2]\n";
/// let file = grouser_design::mission::parse(&Document::from_text("a.toml", text.into())?)?;
/// assert_eq!((file.min_reserve, file.wheel[0]), (Some(0.1), Some((0.1, 0.2))));
/// # Ok::<(), grouser_design::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MissionFile {
    /// A title.
    pub title: Option<String>,
    /// Gravity, m/s².
    pub gravity: Option<f64>,
    /// Keys of the catalogue, or soil files ([`names_file`]), each with its share of the way.
    pub soils: Vec<(String, Option<f64>)>,
    /// Slopes in degrees, each with its share of the way.
    pub slopes: Vec<(f64, Option<f64>)>,
    /// Bounds of the sizes, in the order of [`WheelDesign::NAMES`](super::WheelDesign::NAMES), whose last is no size.
    pub wheel: [Option<(f64, f64)>; 5],
    /// Bounds of the shift of the chassis' mass forwards, m.
    pub mass_shift: Option<(f64, f64)>,
    /// The formula of the mass of one wheel, kg.
    pub wheel_mass: Option<String>,
    /// How the soils are joined.
    pub measure: Option<SoilMeasure>,
    /// Least reserve of pull, share of the weight.
    pub min_reserve: Option<f64>,
    /// No slip above this counts.
    pub max_slip: Option<f64>,
    /// Points of the front.
    pub points: Option<usize>,
    /// Seed of the starts.
    pub seed: Option<u64>,
    /// Which wheel of the front is chosen.
    pub choice: Option<Choice>,
}

/// Choices of a wheel with their names in files and flags; a limit of the mass has its own key.
pub(super) const CHOICES: [(&str, Choice); 3] = [
    ("knee", Choice::Knee),
    ("lightest", Choice::Lightest),
    ("least-energy", Choice::LeastEnergy),
];

impl MissionFile {
    /// This mission, and `behind` where it is silent. A mission's soils are those of one file, and so are its slopes.
    #[must_use]
    pub fn or(self, behind: Self) -> Self {
        let mut wheel = self.wheel;
        for (own, other) in wheel.iter_mut().zip(behind.wheel) {
            *own = own.or(other);
        }
        Self {
            title: self.title.or(behind.title),
            gravity: self.gravity.or(behind.gravity),
            soils: if self.soils.is_empty() {
                behind.soils
            } else {
                self.soils
            },
            slopes: if self.slopes.is_empty() {
                behind.slopes
            } else {
                self.slopes
            },
            wheel,
            mass_shift: self.mass_shift.or(behind.mass_shift),
            wheel_mass: self.wheel_mass.or(behind.wheel_mass),
            measure: self.measure.or(behind.measure),
            min_reserve: self.min_reserve.or(behind.min_reserve),
            max_slip: self.max_slip.or(behind.max_slip),
            points: self.points.or(behind.points),
            seed: self.seed.or(behind.seed),
            choice: self.choice.or(behind.choice),
        }
    }
}

/// A mission out of a document. Soil files that it names lie beside it.
///
/// # Errors
/// What cannot be read, an unknown key, a number outside its limits.
pub fn parse(document: &Document) -> Result<MissionFile> {
    let mut file: MissionFile = document.parse_or_format(1, of_section)?;
    for (name, _) in &mut file.soils {
        if names_file(name.as_ref()) {
            *name = document.beside(&*name).display().to_string();
        }
    }
    Ok(file)
}

const SHARES: (f64, f64) = (0.0, 1.0);

fn of_section(root: &Section<'_>) -> Result<MissionFile> {
    let mut file = MissionFile {
        title: root.optional_text("title")?.map(str::to_owned),
        gravity: read_gravity(root)?,
        wheel_mass: root.optional_text("wheel_mass_kg")?.map(str::to_owned),
        measure: root.optional_choice("soil_measure", &SoilMeasure::ALL)?,
        min_reserve: root.optional_number("min_reserve", (0.0, 1.0))?,
        max_slip: root.optional_number("max_slip", MAX_SLIP_LIMITS)?,
        points: root.optional_whole("points", (2, 200))?,
        seed: root.optional_whole("seed", (0, i64::MAX))?,
        choice: root.optional_choice("choice", &CHOICES)?,
        ..MissionFile::default()
    };
    if let Some(limit) = root.optional_number("max_wheel_mass_kg", (1e-9, 1e9))? {
        file.choice = Some(Choice::MaxMass(limit));
    }
    file.soils = root.sections("soil", |soil| {
        let key = soil.text("soil")?.to_owned();
        Ok((key, soil.optional_number("share", SHARES)?))
    })?;
    file.slopes = root.sections("slope", |slope| {
        let degrees = slope.number("slope_deg", (0.0, MAX_SLOPE_DEG))?;
        Ok((degrees, slope.optional_number("share", SHARES)?))
    })?;
    root.section("wheel", |wheel| -> Result<()> {
        for (bounds, name) in file.wheel.iter_mut().zip(WheelDesign::NAMES) {
            *bounds = wheel.optional_bounds(name)?;
        }
        Ok(())
    })?;
    root.section("chassis", |chassis| -> Result<()> {
        file.mass_shift = chassis.optional_bounds(WheelDesign::NAMES[SHIFT])?;
        Ok(())
    })?;
    Ok(file)
}

/// Shares as they are written; equal ones where none is.
///
/// # Errors
/// [`Error::Mission`] where some have a share and others none.
pub fn shares<T>(of: &str, list: Vec<(T, Option<f64>)>) -> Result<Vec<(T, f64)>> {
    let given = list.iter().filter(|(_, share)| share.is_some()).count();
    if given != 0 && given != list.len() {
        return Err(Error::Mission(format!(
            "{given} of {} {of} have a share of the distance, but all or none must",
            list.len()
        )));
    }
    let equal = 1.0 / list.len() as f64;
    Ok(list
        .into_iter()
        .map(|(item, share)| (item, share.unwrap_or(equal)))
        .collect())
}
