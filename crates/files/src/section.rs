//! A table of a TOML file: its keys by type, range and unit; unknown keys are refused.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use grouser_terra::OutOfRange;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::document::Document;
use crate::error::{Error, PLACEHOLDER, Place, Result};
use crate::key_unit::of_key;
use crate::suggestion::{are_siblings, nearest};

/// A table of a document. Every key that is read becomes known; other keys
/// are refused when the section ends.
///
/// ```
/// use grouser_files::Document;
///
/// let text = "format = 1\n[wheel]\nradius_m = 500.0\n";
/// let document = Document::from_text("wheel.toml", text.into())?;
/// let error = document
///     .parse(|root| root.section("wheel", |wheel| wheel.number("radius_m", (0.001, 100.0))))
///     .unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "wheel.toml:3:12: `radius_m` is 500, but must lie in [0.001, 100]"
/// );
/// # Ok::<(), grouser_files::Error>(())
/// ```
#[derive(Debug)]
pub struct Section<'a> {
    document: &'a Document,
    name: String,
    table: &'a DeTable<'a>,
    span: Range<usize>,
    known: RefCell<Vec<&'static str>>,
    /// Are all keys allowed, because users invent them?
    open: Cell<bool>,
}

impl<'a> Section<'a> {
    pub(crate) fn new(
        document: &'a Document,
        name: String,
        table: &'a DeTable<'a>,
        span: Range<usize>,
    ) -> Self {
        Self {
            document,
            name,
            table,
            span,
            known: RefCell::default(),
            open: Cell::new(false),
        }
    }

    pub(crate) fn table(&self) -> &'a DeTable<'a> {
        self.table
    }

    pub(crate) fn allow_any_key(&self) {
        self.open.set(true);
    }

    pub(crate) fn place_at(&self, offset: usize) -> Place {
        self.document.place(offset)
    }

    /// The table `name` below this one.
    pub(crate) fn below(&self, name: &str, table: &'a DeTable<'a>, span: Range<usize>) -> Self {
        Self::new(self.document, format!("`{name}`"), table, span)
    }

    fn find(&self, key: &'static str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.known.borrow_mut().push(key);
        self.table.get(key)
    }

    /// Where the section begins.
    #[must_use]
    pub fn place(&self) -> Place {
        self.document.place(self.span.start)
    }

    /// Where the value of `key` stands; the section's own place when it is absent.
    #[must_use]
    pub fn place_of(&self, key: &str) -> Place {
        self.table.get(key).map_or_else(
            || self.place(),
            |value| self.document.place(value.span().start),
        )
    }

    /// The error of a number outside its limits; `key` carries the unit.
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let document = Document::from_text("count.toml", "format = 1\ncount = 3\n".into())?;
    /// let error = document
    ///     .parse(|root| match root.integer("count")? {
    ///         odd if odd % 2 == 1 => Err(root.out_of_range("count", odd as f64, (0.0, 2.0))),
    ///         even => Ok(even),
    ///     })
    ///     .unwrap_err();
    /// assert_eq!(error.to_string(), "count.toml:2:9: `count` is 3, but must lie in [0, 2]");
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    #[must_use]
    pub fn out_of_range(&self, key: &str, value: f64, (low, high): (f64, f64)) -> Error {
        Error::OutOfRange {
            at: self.place_of(key),
            range: OutOfRange {
                field: key.to_owned(),
                value,
                low,
                high,
                unit: "",
            },
        }
    }

    /// The error of a number that a law or a description refuses in SI units: at the key that gave it, and in the key's unit.
    /// `None` where this section has no such key.
    #[must_use]
    pub fn refused(&self, range: &OutOfRange) -> Option<Error> {
        let mut range = of_key(range)?;
        let value = self.table.get(range.field.as_str())?;
        let written = self.number_of(&range.field, value, (f64::MIN, f64::MAX));
        // the digits that were written, unless the number was made of several
        range.value = written
            .ok()
            .filter(|written| (written - range.value).abs() <= 1e-9 * written.abs())
            .unwrap_or(range.value);
        let at = self.place_of(&range.field);
        Some(Error::OutOfRange { at, range })
    }

    /// The error of numbers that a law refuses, at the key that gave the number where there is one.
    #[must_use]
    pub fn refused_by_law(&self, source: grouser_terra::Error) -> Error {
        let known = match &source {
            grouser_terra::Error::OutOfRange(range) => self.refused(range),
            _ => None,
        };
        known.unwrap_or_else(|| Error::Soil {
            at: self.place(),
            source,
        })
    }

    /// The bytes of the document's text that hold the value of `key`.
    #[must_use]
    pub fn span_of(&self, key: &str) -> Option<Range<usize>> {
        self.table.get(key).map(Spanned::span)
    }

    /// Is there a value for `key`?
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// Is the value of `key` a text? A text that stands for a value to be filled in is none.
    pub(crate) fn holds_text(&self, key: &str) -> bool {
        let value = self.table.get(key).map(Spanned::get_ref);
        matches!(value, Some(DeValue::String(text)) if text != PLACEHOLDER)
    }

    pub(crate) fn missing(&self, key: &'static str) -> Error {
        // A key that nobody knows and that looks like the missing one is the better message; one beside it may be read later.
        let known = self.known.borrow();
        let mistyped = self.table.keys().find(|given| {
            !known.contains(&given.get_ref().as_ref())
                && !are_siblings(given.get_ref(), key)
                && nearest(given.get_ref(), [key]).is_some()
        });
        if let Some(given) = mistyped {
            return Error::UnknownKey {
                at: self.document.place(given.span().start),
                section: self.name.clone(),
                key: given.get_ref().to_string(),
                meant: Some(key),
            };
        }
        Error::MissingKey {
            at: self.place(),
            section: self.name.clone(),
            key,
        }
    }

    pub(crate) fn wrong_type(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        expected: &'static str,
    ) -> Error {
        Error::WrongType {
            at: self.document.place(value.span().start),
            key: key.into(),
            found: match value.get_ref() {
                DeValue::String(_) => "a text",
                DeValue::Integer(_) => "a whole number",
                DeValue::Float(_) => "a number",
                DeValue::Boolean(_) => "true or false",
                DeValue::Datetime(_) => "a date",
                DeValue::Array(_) => "a list",
                DeValue::Table(_) => "a table",
            },
            expected,
        }
    }

    /// A number in [low, high]; whole numbers count as well. `None` when absent.
    ///
    /// # Errors
    /// [`Error::WrongType`], [`Error::OutOfRange`].
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let document = Document::from_text("soil.toml", "format = 1\n".into())?;
    /// let found = document.parse(|root| root.optional_number("rebound", (0.0, 100.0)))?;
    /// assert_eq!(found, None);
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    pub fn optional_number(
        &self,
        key: &'static str,
        (low, high): (f64, f64),
    ) -> Result<Option<f64>> {
        match self.find(key) {
            None => Ok(None),
            Some(value) => self.number_of(key, value, (low, high)).map(Some),
        }
    }

    /// As [`Section::optional_number`], for numbers that the caller checks: NaN and infinities, too.
    pub(crate) fn optional_unchecked_number(&self, key: &'static str) -> Result<Option<f64>> {
        self.find(key)
            .map(|value| self.unchecked_number_of(key, value))
            .transpose()
    }

    /// `value` as a number in [low, high].
    pub(crate) fn number_of(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        (low, high): (f64, f64),
    ) -> Result<f64> {
        let number = self.unchecked_number_of(key, value)?;
        OutOfRange::check(key, number, (low, high), "").map_err(|range| Error::OutOfRange {
            at: self.document.place(value.span().start),
            range,
        })?;
        Ok(number)
    }

    /// `value` as a number.
    fn unchecked_number_of(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Result<f64> {
        let digits: String = match value.get_ref() {
            DeValue::Float(float) => float.as_str().replace('_', ""),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().replace('_', ""),
            DeValue::String(text) if text == PLACEHOLDER => {
                return Err(Error::Placeholder {
                    at: self.document.place(value.span().start),
                    key: key.into(),
                });
            }
            _ => return Err(self.wrong_type(key, value, "a number")),
        };
        digits
            .parse()
            .map_err(|_| self.wrong_type(key, value, "a number"))
    }

    /// `value` as two numbers, the lower one first.
    pub(crate) fn range_of(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Result<(f64, f64)> {
        let wanted = "a list of two numbers";
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.wrong_type(key, value, wanted));
        };
        match items.iter().collect::<Vec<_>>().as_slice() {
            [low, high] => {
                let low = self.number_of(key, low, (f64::MIN, f64::MAX))?;
                let high = self.number_of(key, high, (low, f64::MAX))?;
                Ok((low, high))
            }
            _ => Err(self.wrong_type(key, value, wanted)),
        }
    }

    /// A number in [low, high].
    ///
    /// # Errors
    /// As [`Section::optional_number`]; [`Error::MissingKey`].
    pub fn number(&self, key: &'static str, limits: (f64, f64)) -> Result<f64> {
        self.optional_number(key, limits)?
            .ok_or_else(|| self.missing(key))
    }

    /// Two bounds, the lower one first, or one number that is both. `None` when absent.
    ///
    /// # Errors
    /// As [`Entry::range`](crate::Entry::range).
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let text = "format = 1\nradius_m = [0.1, 0.2]\nwidth_m = 0.1\n";
    /// let document = Document::from_text("a.toml", text.into())?;
    /// let both = document.parse(|root| {
    ///     Ok::<_, grouser_files::Error>((root.optional_bounds("radius_m")?, root.optional_bounds("width_m")?))
    /// })?;
    /// assert_eq!(both, (Some((0.1, 0.2)), Some((0.1, 0.1))));
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    pub fn optional_bounds(&self, key: &'static str) -> Result<Option<(f64, f64)>> {
        let Some(value) = self.find(key) else {
            return Ok(None);
        };
        if let DeValue::Array(_) = value.get_ref() {
            return self.range_of(key, value).map(Some);
        }
        let fixed = self.number_of(key, value, (f64::MIN, f64::MAX))?;
        Ok(Some((fixed, fixed)))
    }

    /// A whole number. `None` when absent.
    ///
    /// # Errors
    /// [`Error::WrongType`], also for what no signed 64-bit number holds.
    pub fn optional_integer(&self, key: &'static str) -> Result<Option<i64>> {
        let Some(value) = self.find(key) else {
            return Ok(None);
        };
        let DeValue::Integer(integer) = value.get_ref() else {
            return Err(self.wrong_type(key, value, "a whole number"));
        };
        i64::from_str_radix(&integer.as_str().replace('_', ""), integer.radix())
            .map(Some)
            .map_err(|_| self.wrong_type(key, value, "a whole number of at most 64 bits"))
    }

    /// A whole number within limits, which `T` holds. `None` when absent.
    ///
    /// # Errors
    /// As [`Section::optional_integer`]; [`Error::OutOfRange`].
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let document = Document::from_text("a.toml", "format = 1\nstarts = -5\n".into())?;
    /// let starts = document.parse(|root| root.optional_whole::<usize>("starts", (1, 1000)));
    /// assert!(starts.is_err_and(|error| error.to_string().contains("-5")));
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    pub fn optional_whole<T: TryFrom<i64>>(
        &self,
        key: &'static str,
        (low, high): (i64, i64),
    ) -> Result<Option<T>> {
        let Some(value) = self.optional_integer(key)? else {
            return Ok(None);
        };
        match T::try_from(value) {
            Ok(whole) if (low..=high).contains(&value) => Ok(Some(whole)),
            _ => Err(self.out_of_range(key, value as f64, (low as f64, high as f64))),
        }
    }

    /// A whole number within limits, which `T` holds.
    ///
    /// # Errors
    /// As [`Section::optional_whole`]; [`Error::MissingKey`].
    pub fn whole<T: TryFrom<i64>>(&self, key: &'static str, limits: (i64, i64)) -> Result<T> {
        self.optional_whole(key, limits)?
            .ok_or_else(|| self.missing(key))
    }

    /// A whole number.
    ///
    /// # Errors
    /// As [`Section::optional_integer`]; [`Error::MissingKey`].
    pub fn integer(&self, key: &'static str) -> Result<i64> {
        self.optional_integer(key)?.ok_or_else(|| self.missing(key))
    }

    /// A text. `None` when absent.
    ///
    /// # Errors
    /// [`Error::WrongType`].
    pub fn optional_text(&self, key: &'static str) -> Result<Option<&'a str>> {
        let Some(value) = self.find(key) else {
            return Ok(None);
        };
        match value.get_ref() {
            DeValue::String(text) => Ok(Some(text)),
            _ => Err(self.wrong_type(key, value, "a text")),
        }
    }

    /// A text.
    ///
    /// # Errors
    /// As [`Section::optional_text`]; [`Error::MissingKey`].
    pub fn text(&self, key: &'static str) -> Result<&'a str> {
        self.optional_text(key)?.ok_or_else(|| self.missing(key))
    }

    /// A list of texts; empty when absent.
    ///
    /// # Errors
    /// [`Error::WrongType`].
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let document = Document::from_text("a.toml", "format = 1\nignore = [\"/tf\"]\n".into())?;
    /// let ignored = document.parse(|root| Ok(root.texts("ignore")?.len()))?;
    /// assert_eq!(ignored, 1);
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    pub fn texts(&self, key: &'static str) -> Result<Vec<&'a str>> {
        let Some(value) = self.find(key) else {
            return Ok(Vec::new());
        };
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.wrong_type(key, value, "a list of texts"));
        };
        items
            .iter()
            .map(|item| match item.get_ref() {
                DeValue::String(text) => Ok(text.as_ref()),
                _ => Err(self.wrong_type(key, item, "a text")),
            })
            .collect()
    }

    /// True or false; false when absent.
    ///
    /// # Errors
    /// [`Error::WrongType`].
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let document = Document::from_text("a.toml", "format = 1\nalign_clock = true\n".into())?;
    /// assert!(document.parse(|root| root.flag("align_clock"))?);
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    pub fn flag(&self, key: &'static str) -> Result<bool> {
        match self.find(key) {
            None => Ok(false),
            Some(value) => match value.get_ref() {
                DeValue::Boolean(flag) => Ok(*flag),
                _ => Err(self.wrong_type(key, value, "true or false")),
            },
        }
    }

    /// One of several words. `None` when absent.
    ///
    /// # Errors
    /// [`Error::WrongType`], [`Error::BadChoice`].
    pub fn optional_choice<T: Copy>(
        &self,
        key: &'static str,
        choices: &[(&str, T)],
    ) -> Result<Option<T>> {
        let Some(word) = self.optional_text(key)? else {
            return Ok(None);
        };
        if let Some((_, choice)) = choices.iter().find(|(name, _)| *name == word) {
            return Ok(Some(*choice));
        }
        let names = || choices.iter().map(|(name, _)| *name);
        let allowed: Vec<String> = names().map(|name| format!("\"{name}\"")).collect();
        Err(Error::BadChoice {
            at: self.place_of(key),
            key: key.into(),
            value: word.chars().take(64).collect(),
            allowed: allowed.join(", "),
            meant: nearest(word, names()).map(Into::into),
        })
    }

    /// One of several words.
    ///
    /// # Errors
    /// As [`Section::optional_choice`]; [`Error::MissingKey`].
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let document = Document::from_text("a.toml", "format = 1\ndrive = \"fre\"\n".into())?;
    /// let error = document
    ///     .parse(|root| root.choice("drive", &[("powered", 0), ("free", 1)]))
    ///     .unwrap_err();
    /// assert_eq!(error.hint().unwrap(), "did you mean \"free\"?");
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    pub fn choice<T: Copy>(&self, key: &'static str, choices: &[(&str, T)]) -> Result<T> {
        self.optional_choice(key, choices)?
            .ok_or_else(|| self.missing(key))
    }

    /// A table below this one, given to `read`. `None` when absent.
    ///
    /// # Errors
    /// [`Error::WrongType`], [`Error::UnknownKey`], and what `read` finds.
    pub fn section<T, E: From<Error>>(
        &self,
        key: &'static str,
        read: impl FnOnce(&Section<'a>) -> std::result::Result<T, E>,
    ) -> std::result::Result<Option<T>, E> {
        let Some(value) = self.find(key) else {
            return Ok(None);
        };
        let DeValue::Table(table) = value.get_ref() else {
            return Err(self.wrong_type(key, value, "a table").into());
        };
        let section = Section::new(self.document, format!("[{key}]"), table, value.span());
        let out = read(&section)?;
        section.finish()?;
        Ok(Some(out))
    }

    /// A list of tables below this one, each given to `read`; empty when absent.
    ///
    /// # Errors
    /// As [`Section::section`].
    pub fn sections<T>(
        &self,
        key: &'static str,
        mut read: impl FnMut(&Section<'a>) -> Result<T>,
    ) -> Result<Vec<T>> {
        let Some(value) = self.find(key) else {
            return Ok(Vec::new());
        };
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.wrong_type(key, value, "a list of tables"));
        };
        let mut out = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let DeValue::Table(table) = item.get_ref() else {
                return Err(self.wrong_type(key, item, "a table"));
            };
            let name = format!("[[{key}]] number {}", index + 1);
            let section = Section::new(self.document, name, table, item.span());
            out.push(read(&section)?);
            section.finish()?;
        }
        Ok(out)
    }

    /// Refuses a key that was never read.
    pub(crate) fn finish(&self) -> Result<()> {
        if self.open.get() {
            return Ok(());
        }
        let known = self.known.borrow();
        let unknown = self
            .table
            .keys()
            .filter(|key| !known.contains(&key.get_ref().as_ref()))
            .min_by_key(|key| key.span().start);
        match unknown {
            None => Ok(()),
            Some(key) => Err(Error::UnknownKey {
                at: self.document.place(key.span().start),
                section: self.name.clone(),
                key: key.get_ref().chars().take(64).collect(),
                meant: nearest(key.get_ref(), known.iter().copied()),
            }),
        }
    }
}
