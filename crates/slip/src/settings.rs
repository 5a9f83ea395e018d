//! Settings declared once: a table of fields that checks, readers and writers share.

use crate::error::{Result, check_range};

/// The unit of a field in a file, beside the SI unit in the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileUnit {
    /// The same unit as in the settings.
    Same,
    /// Degrees, where the settings hold radians.
    Degrees,
}

/// One number of a settings struct `S`: its name, unit, limits and key in a robot file.
///
/// ```
/// use grouser_slip::filter::FilterSettings;
///
/// let mut settings = FilterSettings::default();
/// let field = FilterSettings::FIELDS.iter().find(|field| field.name == "reference_latency").unwrap();
/// assert_eq!(field.key, Some("reference_latency_s"));
/// field.set_from_file(&mut settings, 0.2);
/// assert_eq!(settings.reference_latency, 0.2);
/// field.check("filter", &settings)?;
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Debug)]
pub struct Field<S> {
    /// The field's name in the struct.
    pub name: &'static str,
    /// The unit of the value in the struct; `1` for a pure number.
    pub unit: &'static str,
    /// The smallest and the largest value allowed, in `unit`.
    pub limits: (f64, f64),
    /// The key in a robot file; `None` where a file cannot set it.
    pub key: Option<&'static str>,
    /// The unit of the value in a file.
    pub file_unit: FileUnit,
    slot: fn(&mut S) -> &mut f64,
}

impl<S: Copy> Field<S> {
    /// A field that a file cannot set.
    #[must_use]
    pub const fn new(
        name: &'static str,
        unit: &'static str,
        limits: (f64, f64),
        slot: fn(&mut S) -> &mut f64,
    ) -> Self {
        Self {
            name,
            unit,
            limits,
            key: None,
            file_unit: FileUnit::Same,
            slot,
        }
    }

    /// The same field with its key in a robot file.
    #[must_use]
    pub const fn key(self, key: &'static str) -> Self {
        Self {
            key: Some(key),
            ..self
        }
    }

    /// The same field with its key in a robot file, where it is in degrees.
    #[must_use]
    pub const fn key_in_degrees(self, key: &'static str) -> Self {
        Self {
            key: Some(key),
            file_unit: FileUnit::Degrees,
            ..self
        }
    }

    /// The value, in the unit of the struct.
    #[must_use]
    pub fn get(&self, settings: &S) -> f64 {
        let mut copy = *settings;
        *(self.slot)(&mut copy)
    }

    /// Sets the value, in the unit of the struct.
    pub fn set(&self, settings: &mut S, value: f64) {
        *(self.slot)(settings) = value;
    }

    /// Sets the value from a file, in the unit of the file.
    pub fn set_from_file(&self, settings: &mut S, value: f64) {
        self.set(
            settings,
            match self.file_unit {
                FileUnit::Same => value,
                FileUnit::Degrees => value.to_radians(),
            },
        );
    }

    /// The smallest and the largest value allowed, in the unit of a file.
    #[must_use]
    pub fn limits_in_file(&self) -> (f64, f64) {
        let (low, high) = self.limits;
        match self.file_unit {
            FileUnit::Same => (low, high),
            FileUnit::Degrees => (low.to_degrees(), high.to_degrees()),
        }
    }

    /// Checks the value against its limits.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) with the group `of` settings, field, value, limits and unit.
    pub fn check(&self, of: &str, settings: &S) -> Result<()> {
        check_range(of, self.name, self.get(settings), self.limits, self.unit)
    }
}

/// Checks every field of a table.
///
/// # Errors
/// [`Error::OutOfRange`](crate::Error::OutOfRange) for the first field outside its limits.
///
/// ```
/// use grouser_slip::filter::FilterSettings;
/// use grouser_slip::settings::check_fields;
///
/// let settings = FilterSettings { speed_sigma: f64::NAN, ..FilterSettings::default() };
/// let error = check_fields("filter", &settings, FilterSettings::FIELDS).unwrap_err();
/// assert!(error.to_string().starts_with("filter: speed_sigma is NaN m/s, but must lie in"));
/// ```
pub fn check_fields<S: Copy>(of: &str, settings: &S, fields: &[Field<S>]) -> Result<()> {
    fields
        .iter()
        .try_for_each(|field| field.check(of, settings))
}
