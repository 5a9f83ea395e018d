//! Settings that are declared as tables of fields.

use grouser_slip::settings::{Field, FileUnit};

use crate::error::Result;
use crate::section::Section;
use crate::toml_text::TomlText;

/// Sets every field that the section has a key for.
///
/// # Errors
/// A value that is no number, or lies outside the field's limits, which are given in the key's unit.
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
            && let Some(value) = section.optional_number(key, field.limits_in_file())?
        {
            field.set_from_file(settings, value);
        }
    }
    Ok(())
}

/// Writes every field that has a key and another value than in `usual`; [`read_fields`] reads them back to the same bits.
///
/// ```
/// use grouser_files::{TomlText, write_fields};
/// use grouser_slip::filter::FilterSettings;
///
/// let usual = FilterSettings::default();
/// let mut text = TomlText::new(&[]);
/// write_fields(&mut text, &usual, &usual, FilterSettings::FIELDS);
/// assert_eq!(text.finish(), "format = 1\n");
/// ```
pub fn write_fields<S: Copy>(out: &mut TomlText, settings: &S, usual: &S, fields: &[Field<S>]) {
    for field in fields {
        let value = field.get(settings);
        if let Some(key) = field.key
            && value != field.get(usual)
        {
            match field.file_unit {
                FileUnit::Degrees => out.degrees(key, value),
                _ => out.number(key, value),
            }
        }
    }
}
