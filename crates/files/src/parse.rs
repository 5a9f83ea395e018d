//! One parser for every TOML file: syntax, depth and format.

use grouser_terra::OutOfRange;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::document::{DEPTH_LIMIT, Document, FORMAT};
use crate::error::{Error, Result};
use crate::section::Section;

impl Document {
    /// Parses it and gives its root to `read`; checks the format before and unknown keys after.
    ///
    /// # Errors
    /// [`Error::Syntax`], [`Error::TooDeep`], [`Error::Format`], [`Error::UnknownKey`], and what `read`
    /// finds.
    pub fn parse<T, E: From<Error>>(
        &self,
        read: impl FnOnce(&Section<'_>) -> std::result::Result<T, E>,
    ) -> std::result::Result<T, E> {
        self.parse_format(None, read)
    }

    /// As [`Document::parse`], for a kind of file whose format may be left out and is then `default`.
    ///
    /// # Errors
    /// As [`Document::parse`].
    pub fn parse_or_format<T, E: From<Error>>(
        &self,
        default: i64,
        read: impl FnOnce(&Section<'_>) -> std::result::Result<T, E>,
    ) -> std::result::Result<T, E> {
        self.parse_format(Some(default), read)
    }

    fn parse_format<T, E: From<Error>>(
        &self,
        default: Option<i64>,
        read: impl FnOnce(&Section<'_>) -> std::result::Result<T, E>,
    ) -> std::result::Result<T, E> {
        let root = DeTable::parse(self.text()).map_err(|error| self.syntax(&error))?;
        // The parser itself stops at a depth of 80, so that this recursion is bounded.
        for value in root.get_ref().values() {
            self.check_depth(value, 2)?;
        }
        let section = Section::new(self, String::from("the file"), root.get_ref(), root.span());
        let format = match (section.optional_integer("format")?, default) {
            (Some(given), _) | (None, Some(given)) => given,
            (None, None) => section.integer("format")?,
        };
        if format != FORMAT {
            let at = section.place_of("format");
            if format > FORMAT {
                return Err(Error::Format {
                    at,
                    found: format,
                    newest: FORMAT,
                }
                .into());
            }
            let range = OutOfRange {
                field: "format".into(),
                value: format as f64,
                low: 1.0,
                high: FORMAT as f64,
                unit: "1",
            };
            return Err(Error::OutOfRange { at, range }.into());
        }
        let out = read(&section)?;
        section.finish()?;
        Ok(out)
    }

    fn syntax(&self, error: &toml::de::Error) -> Error {
        let at = self.place(error.span().map_or(0, |span| span.start));
        // The parser's own limit of 80 lies above ours.
        if error.message().contains("recursion") {
            return Error::TooDeep {
                at,
                limit: DEPTH_LIMIT,
            };
        }
        Error::Syntax {
            at,
            message: error.message().replace('\n', ", "),
        }
    }

    fn check_depth(&self, value: &Spanned<DeValue<'_>>, depth: usize) -> Result<()> {
        if depth > DEPTH_LIMIT {
            return Err(Error::TooDeep {
                at: self.place(value.span().start),
                limit: DEPTH_LIMIT,
            });
        }
        match value.get_ref() {
            DeValue::Array(items) => items
                .iter()
                .try_for_each(|item| self.check_depth(item, depth + 1)),
            DeValue::Table(table) => table
                .values()
                .try_for_each(|item| self.check_depth(item, depth + 1)),
            _ => Ok(()),
        }
    }
}
