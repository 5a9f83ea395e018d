//! Bad usage and bad input: one error for all of them.

use std::fmt;
use std::path::Path;

use serde_json::Value;

/// The result of an operation of the command that may fail.
pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// A bad usage or input: exit code 2, reported on standard error; under `--json` as an object on standard output too.
///
/// Wording: lower case, no full stop, names in backticks; what, where, the value and the limit.
#[derive(Clone, Debug)]
pub(crate) struct Error {
    kind: Kind,
    message: String,
    hint: Option<String>,
    details: Box<Details>,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A flag, or a combination of flags.
    Usage,
    /// A value that lies outside its limits.
    Value,
    /// The content of a file.
    Content,
    /// A file that cannot be read or written.
    File,
}

/// The parts of a message, for programs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Details {
    pub(crate) field: Option<String>,
    pub(crate) value: Value,
    /// A number, or the minimum and the maximum.
    pub(crate) limit: Value,
    pub(crate) unit: Option<String>,
    pub(crate) file: Option<String>,
    /// From 1.
    pub(crate) line: Option<u64>,
}

impl Kind {
    const fn name(self) -> &'static str {
        match self {
            Self::Usage => "usage",
            Self::Value => "value",
            Self::Content => "content",
            Self::File => "file",
        }
    }
}

impl Error {
    pub(crate) fn new(kind: Kind, message: impl Into<String>, hint: Option<String>) -> Self {
        Self {
            kind,
            message: message.into(),
            hint,
            details: Box::default(),
        }
    }

    /// A wrong flag or value, with a hint.
    pub(crate) fn usage(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::new(Kind::Usage, message, Some(hint.into()))
    }

    /// A wrong flag or value without a hint.
    pub(crate) fn usage_without_hint(message: impl Into<String>) -> Self {
        Self::new(Kind::Usage, message, None)
    }

    /// A flag whose value lies outside its limits, as the message says them; no `unit` for a pure number.
    pub(crate) fn out_of_range(
        flag: &str,
        value: f64,
        (limit, unit): ([f64; 2], Option<&str>),
        limits: impl fmt::Display,
    ) -> Self {
        let text = grouser_report::number::in_message(value);
        let message = format!("`{flag}` is {text}, but must {limits}");
        Self::new(Kind::Value, message, None).with(Details {
            field: Some(flag.to_owned()),
            value: value.into(),
            limit: limit.to_vec().into(),
            unit: unit.map(str::to_owned),
            ..Details::default()
        })
    }

    /// A file whose content is wrong; the message names the line and the column.
    pub(crate) fn content(path: &Path, message: impl fmt::Display, hint: Option<String>) -> Self {
        Self::new(Kind::Content, format!("{}: {message}", shown(path)), hint).at(path)
    }

    /// An operation on a file that the system refused.
    pub(crate) fn file(action: &str, path: &Path, reason: &std::io::Error) -> Self {
        Self::refused_file(action, path, &system_reason(reason), None)
    }

    /// An operation on a file that this program refuses.
    pub(crate) fn refused_file(
        action: &str,
        path: &Path,
        reason: &str,
        hint: Option<String>,
    ) -> Self {
        let message = format!("cannot {action} {}: {reason}", shown(path));
        let of_standard = || {
            (path == Path::new("-")).then(|| "standard input is read by `batch` alone".to_owned())
        };
        Self::new(Kind::File, message, hint.or_else(of_standard)).at(path)
    }

    /// Is it a file that cannot be read or written?
    pub(crate) const fn is_of_file(&self) -> bool {
        matches!(self.kind, Kind::File)
    }

    pub(crate) fn with(mut self, details: Details) -> Self {
        *self.details = details;
        self
    }

    /// The same, with the name of what it is about before the message.
    pub(crate) fn of(mut self, what: &str) -> Self {
        self.message = format!("{what}: {}", self.message);
        self
    }

    /// The same, of a file where no file is named.
    pub(crate) fn in_file(mut self, path: &Path) -> Self {
        if self.details.file.is_none() {
            self.message = format!("{}: {}", path.display(), self.message);
            self.details.file = Some(path.display().to_string());
        }
        self
    }

    fn at(self, path: &Path) -> Self {
        self.with(Details {
            file: Some(path.display().to_string()),
            ..Details::default()
        })
    }

    /// What to do about it, where that is known.
    pub(crate) fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// The error for programs.
    pub(crate) fn object(&self) -> Value {
        let Details {
            field,
            value,
            limit,
            unit,
            file,
            line,
        } = &*self.details;
        serde_json::json!({"error": {
            "kind": self.kind.name(),
            "message": self.message,
            "hint": self.hint,
            "field": field,
            "value": value,
            "limit": limit,
            "unit": unit,
            "file": file,
            "line": line,
        }})
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// A path as messages show it; bytes that are not text become U+FFFD.
pub(crate) fn shown(path: &Path) -> String {
    format!("`{}`", path.display())
}

/// The system's words without Rust's `(os error 2)`, in lower case.
fn system_reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    let text = text
        .split_once(" (os error")
        .map_or(text.as_str(), |(words, _)| words);
    let mut letters = text.chars();
    match letters.next() {
        Some(first) => first.to_lowercase().chain(letters).collect(),
        None => "the system gave no reason".to_owned(),
    }
}
