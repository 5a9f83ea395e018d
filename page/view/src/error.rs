//! What can go wrong.

use std::path::PathBuf;

/// The result of what may fail here.
pub type Result<T> = std::result::Result<T, Error>;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The page is not complete.
    #[error(transparent)]
    Page(#[from] grouser_page::Error),
    /// The server cannot listen.
    #[error("the server cannot listen: {source}")]
    Server {
        /// Why.
        source: std::io::Error,
    },
    /// The file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The page would open without what it is exported for.
    #[error(
        "{}: is neither a table of `grouser estimate -o` nor a report with a run: a log needs the server (--robot R.toml)",
        path.display()
    )]
    NoRun {
        /// The file.
        path: PathBuf,
    },
    /// A log, or a file that describes it, is refused.
    #[error("{message}")]
    Refused {
        /// What is wrong with which file.
        message: String,
    },
    /// The file is larger than the page takes.
    #[error("{} has {bytes} bytes, but at most {limit} bytes are taken", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its length, bytes.
        bytes: u64,
        /// The most, bytes.
        limit: u64,
    },
}
