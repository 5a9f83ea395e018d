//! Settings that are declared as tables of fields.

use grouser_slip::settings::Field;

use crate::error::Result;
use crate::section::Section;

/// Any number of a settings file; the settings themselves check their limits.
const ANY: (f64, f64) = (-1e12, 1e12);

/// Sets every field that the section has a key for; the settings themselves check the limits.
///
/// # Errors
/// A value that is no number.
///
/// ```
/// use grouser_files::{Document, read_fields};
/// use grouser_slip::filter::FilterSettings;
///
/// let document = Document::from_text("filter.toml", "format = 1\n".into())?;
/// let mut settings = FilterSettings::default();
/// document.parse(|root| read_fields(root, &mut settings, FilterSettings::FIELDS))?;
/// assert_eq!(settings, FilterSettings::default()); // no key, no change
/// # Ok::<(), grouser_files::Error>(())
/// ```
pub fn read_fields<S: Copy>(
    section: &Section<'_>,
    settings: &mut S,
    fields: &[Field<S>],
) -> Result<()> {
    for field in fields {
        if let Some(key) = field.key
            && let Some(value) = section.optional_number(key, ANY)?
        {
            field.set_from_file(settings, value);
        }
    }
    Ok(())
}
