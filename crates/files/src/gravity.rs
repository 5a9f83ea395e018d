//! The key `gravity_m_per_s2`, the same in robot, scenario and problem files.

use grouser_terra::gravity_of;

use crate::error::{Error, Result};
use crate::section::Section;

/// Limits of a gravity in files and flags, m/s²: below them loads vanish, above them no robot stands.
pub const GRAVITY_LIMITS_M_PER_S2: (f64, f64) = (1e-3, 1e3);

/// The key of gravity in every file.
pub const KEY: &str = "gravity_m_per_s2";

/// The bodies that a file may name in place of a number.
const BODIES: [&str; 3] = ["earth", "moon", "mars"];

/// Gravity in m/s²: `gravity_m_per_s2`, a number or `"earth"`, `"moon"` or `"mars"`; `None` where the key is absent.
///
/// Where several places have one, a flag precedes a scenario or problem file, that precedes the robot file, and without
/// any it is the Earth's. It turns masses into loads; the numbers of a soil do not change with it
/// ([`grouser_terra::gravity_of`]).
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::WrongType`], [`Error::BadChoice`] for another word.
///
/// ```
/// use grouser_files::{Document, gravity::read_gravity};
///
/// let text = "format = 1\ngravity_m_per_s2 = \"moon\"\n";
/// let document = Document::from_text("robot.toml", text.into())?;
/// assert_eq!(document.parse(|root| read_gravity(root))?, Some(1.62));
/// # Ok::<(), grouser_files::Error>(())
/// ```
pub fn read_gravity(section: &Section<'_>) -> Result<Option<f64>> {
    if section.holds_text(KEY) {
        let bodies = BODIES.map(|body| (body, gravity_of(body)));
        return Ok(section.optional_choice(KEY, &bodies)?.flatten());
    }
    section
        .optional_number(KEY, GRAVITY_LIMITS_M_PER_S2)
        .map_err(|error| match error {
            Error::WrongType { at, key, found, .. } => Error::WrongType {
                at,
                key,
                found,
                expected: "a number, \"earth\", \"moon\" or \"mars\"",
            },
            error => error,
        })
}
