//! The fields of a result, declared once, where it is computed.

/// A quantity of a result `T`: every interface (JSON, tables, Python, the page) reads it from the one list of its type.
///
/// ```
/// use grouser_real::{ResultField, FieldValue};
///
/// struct Wheel { radius: f64 }
/// const FIELDS: &[ResultField<Wheel>] =
///     &[ResultField::number("radius_m", "radius", |wheel: &Wheel| wheel.radius).shown("mm")];
/// assert_eq!(FIELDS[0].value(&Wheel { radius: 0.125 }), FieldValue::Number(0.125));
/// ```
pub struct ResultField<T> {
    /// Its name with its unit.
    pub key: &'static str,
    /// What it is.
    pub words: &'static str,
    /// Where its value comes from.
    pub read: ReadField<T>,
    /// The unit in which people see it, and what they see where it has no value; `None`: only programs do.
    pub shown: Option<(&'static str, Option<&'static str>)>,
}

/// How a quantity is read, which is its type.
pub enum ReadField<T> {
    /// A number.
    Number(fn(&T) -> f64),
    /// A number that may be missing.
    Optional(fn(&T) -> Option<f64>),
    /// A whole number.
    Whole(fn(&T) -> u32),
    /// A word.
    Text(fn(&T) -> &'static str),
    /// Words, each passed on.
    Texts(fn(&T, &mut dyn FnMut(&'static str))),
}

/// The value of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldValue {
    /// None.
    Missing,
    /// A number.
    Number(f64),
    /// A whole number.
    Whole(u32),
    /// A word.
    Text(&'static str),
    /// Words, which [`ReadField::Texts`] passes on.
    Texts,
}

impl<T> ResultField<T> {
    const fn new(key: &'static str, words: &'static str, read: ReadField<T>) -> Self {
        Self {
            key,
            words,
            read,
            shown: None,
        }
    }

    /// A number.
    #[must_use]
    pub const fn number(key: &'static str, words: &'static str, read: fn(&T) -> f64) -> Self {
        Self::new(key, words, ReadField::Number(read))
    }

    /// A number that may be missing.
    #[must_use]
    pub const fn optional(
        key: &'static str,
        words: &'static str,
        read: fn(&T) -> Option<f64>,
    ) -> Self {
        Self::new(key, words, ReadField::Optional(read))
    }

    /// A whole number.
    #[must_use]
    pub const fn whole(key: &'static str, words: &'static str, read: fn(&T) -> u32) -> Self {
        Self::new(key, words, ReadField::Whole(read))
    }

    /// A word.
    #[must_use]
    pub const fn text(
        key: &'static str,
        words: &'static str,
        read: fn(&T) -> &'static str,
    ) -> Self {
        Self::new(key, words, ReadField::Text(read))
    }

    /// Words.
    #[must_use]
    pub const fn texts(
        key: &'static str,
        words: &'static str,
        read: fn(&T, &mut dyn FnMut(&'static str)),
    ) -> Self {
        Self::new(key, words, ReadField::Texts(read))
    }

    /// People see it too, in this unit.
    #[must_use]
    pub const fn shown(mut self, unit: &'static str) -> Self {
        self.shown = Some((unit, None));
        self
    }

    /// People see it too, in this unit, and these words where it has no value.
    #[must_use]
    pub const fn shown_or(mut self, unit: &'static str, missing: &'static str) -> Self {
        self.shown = Some((unit, Some(missing)));
        self
    }

    /// Its value in a result.
    pub fn value(&self, of: &T) -> FieldValue {
        match &self.read {
            ReadField::Number(read) => FieldValue::Number(read(of)),
            ReadField::Optional(read) => read(of).map_or(FieldValue::Missing, FieldValue::Number),
            ReadField::Whole(read) => FieldValue::Whole(read(of)),
            ReadField::Text(read) => FieldValue::Text(read(of)),
            ReadField::Texts(_) => FieldValue::Texts,
        }
    }
}
