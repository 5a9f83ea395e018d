//! The text of a TOML file, and places in it.

use std::path::{Path, PathBuf};

use crate::error::{Error, Place, Result};
use crate::regular;

/// The newest format of our files.
pub const FORMAT: i64 = 1;
/// The maximum size of a TOML file, bytes.
pub const SIZE_LIMIT: u64 = 1 << 20;
/// The maximum nesting of a TOML file.
pub const DEPTH_LIMIT: usize = 64;

/// The text of a file.
///
/// ```
/// use grouser_files::Document;
///
/// let document = Document::from_text("wheel.toml", "format = 1\nradius_m = 0.1\n".into())?;
/// let radius = document.parse(|root| root.number("radius_m", (0.001, 100.0)))?;
/// assert_eq!(radius, 0.1);
/// # Ok::<(), grouser_files::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Document {
    name: String,
    text: String,
}

impl Document {
    /// Reads a file of at most [`SIZE_LIMIT`] bytes.
    ///
    /// # Errors
    /// As [`regular::read_text`].
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self {
            name: path.display().to_string(),
            text: regular::read_text(path, SIZE_LIMIT)?,
        })
    }

    /// A document out of a text in memory; `name` stands for it in messages.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub fn from_text(name: &str, text: String) -> Result<Self> {
        if text.len() as u64 > SIZE_LIMIT {
            return Err(Error::TooLarge {
                file: name.into(),
                limit: SIZE_LIMIT,
            });
        }
        Ok(Self {
            name: name.into(),
            text,
        })
    }

    /// What stands for it in messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text as it stands.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// A file that it names, which lies beside it unless its path is absolute.
    ///
    /// ```
    /// use grouser_files::Document;
    ///
    /// let document = Document::from_text("field/job.toml", "format = 1\n".into())?;
    /// assert_eq!(document.beside("sand.toml"), std::path::Path::new("field/sand.toml"));
    /// # Ok::<(), grouser_files::Error>(())
    /// ```
    #[must_use]
    pub fn beside(&self, file: impl AsRef<Path>) -> PathBuf {
        let folder = Path::new(&self.name).parent();
        folder.unwrap_or_else(|| Path::new("")).join(file)
    }

    pub(crate) fn place(&self, offset: usize) -> Place {
        regular::place(&self.name, &self.text, offset)
    }
}
