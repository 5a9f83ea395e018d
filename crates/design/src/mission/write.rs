//! A mission as the text of its file.

use grouser_files::{TomlText, gravity};

use super::file::{CHOICES, MissionFile};
use super::front::Choice;
use super::wheel::SHIFT;
use super::{SoilMeasure, WheelDesign};

/// The text of a mission file that reads back to the same mission.
///
/// Soil files are written as the mission has them: relative ones lie beside the file that is written. `remarks` stand above
/// it as comments.
///
/// ```
/// use grouser_design::mission::{MissionFile, parse, to_toml};
/// use grouser_files::Document;
///
/// let mut mission = MissionFile::default();
/// mission.soils = vec![("dry-sand".to_owned(), None)];
/// mission.slopes = vec![(0.0, Some(0.8)), (5.0, Some(0.2))];
/// mission.wheel[0] = Some((0.1, 0.2)); // radius, m
/// let text = to_toml(&mission, &["a field"]);
/// assert_eq!(parse(&Document::from_text("field.toml", text.into())?)?, mission);
/// # Ok::<(), grouser_design::Error>(())
/// ```
#[must_use]
pub fn to_toml(mission: &MissionFile, remarks: &[&str]) -> String {
    let mut out = TomlText::new(remarks);
    out.optional_text("title", mission.title.as_deref());
    out.optional_number(gravity::KEY, mission.gravity);
    let measure = mission.measure.and_then(|measure| {
        let mut all = SoilMeasure::ALL.iter();
        all.find(|(_, known)| *known == measure)
    });
    out.optional_text("soil_measure", measure.map(|(name, _)| *name));
    out.optional_number("min_reserve", mission.min_reserve);
    out.optional_number("max_slip", mission.max_slip);
    out.optional_whole("points", mission.points);
    out.optional_whole("seed", mission.seed);
    if let Some(Choice::MaxMass(limit)) = mission.choice {
        out.number("max_wheel_mass_kg", limit);
    }
    let choice = CHOICES
        .iter()
        .find(|(_, known)| mission.choice == Some(*known));
    out.optional_text("choice", choice.map(|(name, _)| *name));
    out.optional_text("wheel_mass_kg", mission.wheel_mass.as_deref());
    for (name, share) in &mission.soils {
        out.header("[[soil]]");
        out.text("soil", name);
        out.optional_number("share", *share);
    }
    for (degrees, share) in &mission.slopes {
        out.header("[[slope]]");
        out.number("slope_deg", *degrees);
        out.optional_number("share", *share);
    }
    if mission.wheel.iter().any(Option::is_some) {
        out.header("[wheel]");
    }
    for (name, bounds) in WheelDesign::NAMES.iter().zip(mission.wheel) {
        write_bounds(&mut out, name, bounds);
    }
    if mission.mass_shift.is_some() {
        out.header("[chassis]");
        write_bounds(&mut out, WheelDesign::NAMES[SHIFT], mission.mass_shift);
    }
    out.finish()
}

fn write_bounds(out: &mut TomlText, name: &str, bounds: Option<(f64, f64)>) {
    match bounds {
        Some((low, high)) if low == high => out.number(name, low),
        Some((low, high)) => out.line(&format!("{name} = [{low:?}, {high:?}]")),
        None => {}
    }
}
