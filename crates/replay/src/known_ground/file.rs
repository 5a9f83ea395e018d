//! Known grounds in a file.
//!
//! ```toml
//! format = 1
//! robot = "Festo Robotino"
//! coverage = 0.956              # of the 95 % intervals in runs left out
//! half_width = 0.248            # their median half-width
//! [[ground]]
//! run = "table_surface_exp01"
//! from_s = 2.0
//! to_s = 16.5
//! effort_a = 0.82               # or effort_nm
//! speed_m_per_s = 0.094
//! across = 0.87                 # with omni wheels
//! ripple_hz = 1.64
//! slip = 0.12
//! slip_scatter = 0.02
//! ```

use std::path::Path;

use grouser_files::{Document, Section, TomlText};

use super::stretch::{KnownGround, KnownGrounds, Roller, Stretch};
use crate::effort::EffortUnit;
use crate::error::Result;

type Files<T> = std::result::Result<T, grouser_files::Error>;

/// Reads the file that [`to_toml`] writes.
///
/// # Errors
/// What the file lacks or says wrong, with its place.
pub fn read_known_grounds(path: &Path) -> Result<KnownGrounds> {
    Ok(parse(&Document::read(path)?)?)
}

/// The units with their keys.
const UNITS: [(EffortUnit, &str); 2] = [
    (EffortUnit::Ampere, "effort_a"),
    (EffortUnit::NewtonMetre, "effort_nm"),
];

fn parse(document: &Document) -> Files<KnownGrounds> {
    document.parse(|root| {
        let robot = root.text("robot")?.to_owned();
        let coverage = root.optional_number("coverage", (0.0, 1.0))?;
        let half_width = root.optional_number("half_width", (0.0, 1.0))?;
        let mut unit = None;
        let grounds = root.sections("ground", |section| {
            // The first ground chooses the unit; another unit's key is unknown then.
            let (own, key) = UNITS
                .into_iter()
                .find(|(own, key)| unit.map_or(section.has(key), |unit| unit == *own))
                .unwrap_or(UNITS[0]);
            unit = Some(own);
            ground(section, key)
        })?;
        Ok(KnownGrounds {
            robot,
            unit: unit.unwrap_or(EffortUnit::Ampere),
            grounds,
            coverage,
            half_width,
        })
    })
}

fn ground(section: &Section<'_>, effort: &'static str) -> Files<KnownGround> {
    const TIME_S: (f64, f64) = (0.0, 1e9);
    const POSITIVE: (f64, f64) = (1e-9, 1e6);
    let roller = if section.has("ripple_hz") || section.has("across") {
        Some(Roller {
            across: section.number("across", (0.01, 1.0))?,
            ripple: section.number("ripple_hz", POSITIVE)?,
        })
    } else {
        None
    };
    Ok(KnownGround {
        run: section.text("run")?.to_owned(),
        stretch: Stretch {
            from_s: section.number("from_s", TIME_S)?,
            to_s: section.number("to_s", TIME_S)?,
            effort: section.number(effort, POSITIVE)?,
            speed: section.number("speed_m_per_s", POSITIVE)?,
            roller,
        },
        slip: section.number("slip", (-1.0, 0.999_999))?,
        scatter: section.number("slip_scatter", (0.0, 10.0))?,
    })
}

/// The text of a file of known grounds.
#[must_use]
pub fn to_toml(known: &KnownGrounds) -> String {
    let mut text = TomlText::new(&[
        "Grounds that the robot has met: what its motors drew, and the slip that a reference measured.",
    ]);
    text.text("robot", &known.robot);
    text.optional_number("coverage", known.coverage);
    text.optional_number("half_width", known.half_width);
    let effort = match known.unit {
        EffortUnit::Ampere => UNITS[0].1,
        EffortUnit::NewtonMetre => UNITS[1].1,
    };
    for ground in &known.grounds {
        let stretch = &ground.stretch;
        text.header("[[ground]]");
        text.text("run", &ground.run);
        text.number("from_s", stretch.from_s);
        text.number("to_s", stretch.to_s);
        text.number(effort, stretch.effort);
        text.number("speed_m_per_s", stretch.speed);
        text.optional_number("across", stretch.roller.map(|roller| roller.across));
        text.optional_number("ripple_hz", stretch.roller.map(|roller| roller.ripple));
        text.number("slip", ground.slip);
        text.number("slip_scatter", ground.scatter);
    }
    text.finish()
}
