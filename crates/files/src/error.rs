//! What is wrong with a file, and where.

use grouser_terra::OutOfRange;
use std::fmt;
use std::io;
use std::path::Path;

/// The result of reading a file.
pub type Result<T> = std::result::Result<T, Error>;

/// A place in a file, counted from 1.
///
/// ```
/// use grouser_files::Document;
///
/// let error = Document::from_text("broken.toml", "format = \n".into())
///     .and_then(|document| document.parse(|_| Ok(())))
///     .unwrap_err();
/// assert!(error.to_string().starts_with("broken.toml:1:"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file as it was named.
    pub file: String,
    /// Line.
    pub line: usize,
    /// Column, in characters.
    pub column: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// What a proposed file has in place of a number that no log holds. A file is refused until it is replaced, because a wrong
/// radius or a wrong number of ticks per turn yields a plausible but wrong slip.
pub const PLACEHOLDER: &str = "measure";

/// Why a file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system does not give it.
    #[error("{file}: {source}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// It is no regular file (a directory, a pipe, a device), which might never end.
    #[error("{file}: is {what}, but must be a file")]
    NotAFile {
        /// The path.
        file: String,
        /// What it is.
        what: &'static str,
    },
    /// It is larger than its limit.
    #[error("{file}: holds more than {limit} bytes, the limit for a file of this kind")]
    TooLarge {
        /// The file.
        file: String,
        /// The limit, bytes.
        limit: u64,
    },
    /// It is not UTF-8.
    #[error("{at}: is not UTF-8 text")]
    NotText {
        /// Where.
        at: Place,
    },
    /// It is not TOML.
    #[error("{at}: {message}")]
    Syntax {
        /// Where.
        at: Place,
        /// What the parser says.
        message: String,
    },
    /// Tables nest too deep.
    #[error("{at}: nests deeper than {limit} levels")]
    TooDeep {
        /// Where.
        at: Place,
        /// The limit.
        limit: usize,
    },
    /// It is written for a newer program.
    #[error("{at}: format is {found}, but this program reads up to format {newest}")]
    Format {
        /// Where.
        at: Place,
        /// What the file says.
        found: i64,
        /// The newest format that this program reads.
        newest: i64,
    },
    /// A key is missing.
    #[error("{at}: {section} has no key `{key}`")]
    MissingKey {
        /// Where its section begins.
        at: Place,
        /// The section.
        section: String,
        /// The key.
        key: &'static str,
    },
    /// A key that this file does not have.
    #[error("{at}: {section} has no such key as `{key}`")]
    UnknownKey {
        /// Where.
        at: Place,
        /// The section.
        section: String,
        /// What was given.
        key: String,
        /// The key that was probably meant.
        meant: Option<&'static str>,
    },
    /// A key that files had in the past.
    #[error("{at}: {section} no longer has the key `{key}`: {instead}")]
    RemovedKey {
        /// Where.
        at: Place,
        /// The section.
        section: &'static str,
        /// The key.
        key: &'static str,
        /// What replaced it.
        instead: &'static str,
    },
    /// A value of the wrong type.
    #[error("{at}: `{key}` is {found}, but must be {expected}")]
    WrongType {
        /// Where.
        at: Place,
        /// The key.
        key: String,
        /// What was given.
        found: &'static str,
        /// What it must be.
        expected: &'static str,
    },
    /// A value that a proposed file leaves to be measured.
    #[error("{at}: `{key}` is still the placeholder \"{PLACEHOLDER}\" of a proposed file")]
    Placeholder {
        /// Where.
        at: Place,
        /// The key; it carries the unit.
        key: String,
    },
    /// A number outside its limits (NaN always is).
    #[error("{at}: {range:#}")]
    OutOfRange {
        /// Where.
        at: Place,
        /// The key, which carries the unit, and its limits.
        range: OutOfRange<String>,
    },
    /// A word that is none of those allowed.
    #[error("{at}: `{key}` is \"{value}\", but must be one of {allowed}")]
    BadChoice {
        /// Where.
        at: Place,
        /// The key.
        key: String,
        /// What was given.
        value: String,
        /// The words allowed.
        allowed: String,
        /// The word that was probably meant.
        meant: Option<String>,
    },
    /// A number is beyond what a soil can have.
    #[error("{at}: {source}")]
    Soil {
        /// Where.
        at: Place,
        /// What is wrong.
        source: grouser_terra::Error,
    },
    /// The file is well-formed, but what it describes cannot be.
    #[error("{at}: {source}")]
    Robot {
        /// Where.
        at: Place,
        /// What is wrong.
        source: grouser_slip::Error,
    },
    /// Two entries that exclude each other.
    #[error("{at}: {message}")]
    Contradiction {
        /// Where.
        at: Place,
        /// What is wrong.
        message: String,
    },
}

impl Error {
    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::UnknownKey {
                meant: Some(meant), ..
            } => Some(format!("did you mean `{meant}`?")),
            Self::BadChoice {
                meant: Some(meant), ..
            } => Some(format!("did you mean \"{meant}\"?")),
            Self::Placeholder { .. } => Some("replace it by the measured number".into()),
            Self::RemovedKey { .. } => Some("remove the key".into()),
            Self::Format { .. } => Some("use a newer version of this program".into()),
            // a table or a log in the place of its description
            Self::Syntax { at, .. } | Self::NotText { at } => {
                let extension = Path::new(&at.file).extension();
                let is_toml = extension.is_some_and(|name| name.eq_ignore_ascii_case("toml"));
                (!is_toml).then(|| "a TOML file is expected here (.toml)".into())
            }
            _ => None,
        }
    }
}
