//! What can go wrong.

use std::path::PathBuf;

/// The result of what may fail here.
pub type Result<T> = std::result::Result<T, Error>;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A script of the page uses a form of import or export that the packer does not know.
    #[error("{file}: `{line}` is no import or export that the page's packer reads")]
    Script {
        /// The script.
        file: String,
        /// Its line.
        line: String,
    },
    /// Two scripts import each other.
    #[error("{file} imports itself by way of others")]
    Circle {
        /// One of the scripts.
        file: String,
    },
    /// A part of the page is not in the program.
    #[error("the page's `{name}` is missing")]
    Missing {
        /// The part.
        name: String,
    },
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
