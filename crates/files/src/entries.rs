//! Tables whose keys a user invents: variables, objectives, constraints of a problem file.

use toml::Spanned;
use toml::de::DeValue;

use crate::error::{Error, Place, Result};
use crate::section::Section;

/// One entry of such a table.
#[derive(Debug)]
pub struct Entry<'s, 'a> {
    section: &'s Section<'a>,
    name: &'a str,
    place: Place,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Section<'a> {
    /// Every entry, in the order of the file; none of them is unknown any more.
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let text = "format = 1\n[variables]\nradius = \"free\"\nwidth = \"fixed\"\n";
    /// let document = Document::from_text("a.toml", text.into())?;
    /// let names = document.parse(|root| {
    ///     root.section("variables", |table| {
    ///         Ok(table.entries().iter().map(|entry| entry.name().to_owned()).collect::<Vec<_>>())
    ///     })
    /// })?;
    /// assert_eq!(names.unwrap(), ["radius", "width"]);
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    #[must_use]
    pub fn entries(&self) -> Vec<Entry<'_, 'a>> {
        self.allow_any_key();
        let mut list: Vec<(usize, Entry<'_, 'a>)> = self
            .table()
            .iter()
            .map(|(key, value)| {
                let start = key.span().start;
                let entry = Entry {
                    section: self,
                    name: key.get_ref().as_ref(),
                    place: self.place_at(start),
                    value,
                };
                (start, entry)
            })
            .collect();
        list.sort_by_key(|(start, _)| *start);
        list.into_iter().map(|(_, entry)| entry).collect()
    }
}

impl<'a> Entry<'_, 'a> {
    /// The key.
    #[must_use]
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// Where the key stands.
    #[must_use]
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// The value as a text; `None` if it is something else.
    #[must_use]
    pub fn as_text(&self) -> Option<&'a str> {
        match self.value.get_ref() {
            DeValue::String(text) => Some(text),
            _ => None,
        }
    }

    /// The value as a number in [low, high]; whole numbers count as well.
    ///
    /// # Errors
    /// [`Error::WrongType`], [`Error::OutOfRange`].
    pub fn number(&self, limits: (f64, f64)) -> Result<f64> {
        self.section.number_of(self.name, self.value, limits)
    }

    /// The value as a text.
    ///
    /// # Errors
    /// [`Error::WrongType`].
    pub fn text(&self) -> Result<&'a str> {
        self.as_text()
            .ok_or_else(|| self.section.wrong_type(self.name, self.value, "a text"))
    }

    /// The value as a list of two numbers in rising order.
    ///
    /// # Errors
    /// [`Error::WrongType`], [`Error::OutOfRange`].
    pub fn range(&self) -> Result<(f64, f64)> {
        self.section.range_of(self.name, self.value)
    }

    /// The value as a table, given to `read`; `expected` says what may stand here.
    ///
    /// # Errors
    /// [`Error::WrongType`], [`Error::UnknownKey`], and what `read` finds.
    pub fn section<T, E: From<Error>>(
        &self,
        expected: &'static str,
        read: impl FnOnce(&Section<'a>) -> std::result::Result<T, E>,
    ) -> std::result::Result<T, E> {
        let DeValue::Table(table) = self.value.get_ref() else {
            return Err(self
                .section
                .wrong_type(self.name, self.value, expected)
                .into());
        };
        let section = self.section.below(self.name, table, self.value.span());
        let out = read(&section)?;
        section.finish()?;
        Ok(out)
    }
}
