//! What can go wrong, and the exit codes.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The result of whatever may fail in the command.
pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// A bad usage or input: exit code 2, told on standard error, nothing on standard output.
///
/// Wording: lower case, no full stop, names in backticks; what, where, the value and the limit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum Error {
    /// A flag, a combination of flags, or a value that no law accepts.
    #[error("{message}")]
    Usage {
        /// What is wrong, with the flag, the value and the limit.
        message: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// A file whose content is wrong.
    #[error("{}: {message}", shown(.path))]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, with the line and the column.
        message: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// A file that cannot be read or written.
    #[error("cannot {action} {}: {reason}", shown(.path))]
    File {
        /// `read`, `write`, …
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: String,
        /// What to do about it.
        hint: Option<String>,
    },
    /// One of our own files says something wrong; its message begins with the place.
    #[error("{0}")]
    Described(#[source] grouser_files::Error),
}

impl From<grouser_files::Error> for Error {
    fn from(error: grouser_files::Error) -> Self {
        use grouser_files::Error as FileError;
        match error {
            FileError::Unreadable { file, source } => Self::file("read", Path::new(&file), &source),
            FileError::NotAFile { file, what } => Self::File {
                action: "read",
                path: PathBuf::from(file),
                reason: format!("it is {what}"),
                hint: (what == "a pipe")
                    .then(|| "`-` reads standard input where a verb takes it".to_owned()),
            },
            error => Self::Described(error),
        }
    }
}

impl Error {
    /// A wrong flag or value, with a hint.
    pub(crate) fn usage(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Usage {
            message: message.into(),
            hint: Some(hint.into()),
        }
    }

    /// A wrong flag or value about which there is nothing more to say.
    pub(crate) fn usage_without_hint(message: impl Into<String>) -> Self {
        Self::Usage {
            message: message.into(),
            hint: None,
        }
    }

    /// An operation on a file that the system refused.
    pub(crate) fn file(action: &'static str, path: &Path, reason: &std::io::Error) -> Self {
        Self::File {
            action,
            path: path.to_owned(),
            reason: system_reason(reason),
            hint: None,
        }
    }

    /// What to do about it, where there is something to say.
    pub(crate) fn hint(&self) -> Option<String> {
        match self {
            Self::Described(error) => error.hint(),
            Self::Usage { hint, .. } | Self::Content { hint, .. } | Self::File { hint, .. } => {
                hint.clone()
            }
        }
    }
}

/// How a job ended that was not refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub(crate) enum Outcome {
    /// With its result.
    Done,
    /// Without its result: no solution, not converged, infeasible.
    NoResult,
    /// With a part of its result.
    Partial,
}

impl Outcome {
    /// 0, 1 or 3.
    pub(crate) fn exit_code(self) -> ExitCode {
        ExitCode::from(match self {
            Self::Done => 0,
            Self::NoResult => 1,
            Self::Partial => 3,
        })
    }
}

/// The exit code of every [`Error`].
pub(crate) const BAD_INPUT: u8 = 2;

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
