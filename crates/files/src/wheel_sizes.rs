//! The keys of a rigid wheel's lugs, the same in every file.

use grouser_terra::{GrouserRule, Grousers, RigidWheel};

use crate::error::{Error, Result};
use crate::section::Section;

/// Any number; the wheel itself checks more closely.
const FINITE: (f64, f64) = (f64::MIN, f64::MAX);

/// The lugs of a section: `grouser_height_m`, `grouser_count` and `grouser_thickness_m` (0 where it is absent);
/// `None` where the section has none of them.
///
/// # Errors
/// A height without a count, a count without a height, or a value that is no number.
pub fn read_grousers(section: &Section<'_>) -> Result<Option<Grousers>> {
    let height = section.optional_number("grouser_height_m", FINITE)?;
    let count = section.optional_integer("grouser_count")?;
    let thickness = section.optional_number("grouser_thickness_m", FINITE)?;
    match (height, count) {
        (Some(height), Some(count)) => Ok(Some(Grousers {
            height,
            rule: GrouserRule::Lugs {
                // no robot has 2^53 lugs, and the wheel checks their number
                count: count as f64,
                thickness: thickness.unwrap_or(0.0),
            },
        })),
        (None, None) if thickness.is_none() => Ok(None),
        _ => Err(Error::Contradiction {
            at: section.place(),
            message: "lugs need both `grouser_height_m` and `grouser_count`".to_owned(),
        }),
    }
}

/// `wheel` with the lugs of its section, if there are some.
///
/// # Errors
/// As [`read_grousers`], and what [`RigidWheel::with_grousers`] refuses, with its place.
pub fn with_grousers(section: &Section<'_>, wheel: RigidWheel) -> Result<RigidWheel> {
    let Some(grousers) = read_grousers(section)? else {
        return Ok(wheel);
    };
    wheel
        .with_grousers(grousers)
        .map_err(|source| section.refused_by_law(source))
}
