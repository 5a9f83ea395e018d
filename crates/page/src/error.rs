//! Why there is no page.

/// The result of putting a page together.
pub type Result<T> = std::result::Result<T, Error>;

/// Why there is no page: never for what a user put into it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A script of the page uses a form of import or export that the bundler does not know.
    #[error("{file}: `{line}` is no import or export that the page's bundler reads")]
    Script {
        /// The script.
        file: String,
        /// Its line.
        line: String,
    },
    /// Two scripts import each other.
    #[error("{file} imports itself through others")]
    Circle {
        /// One of the scripts.
        file: String,
    },
    /// A part of the page does not exist.
    #[error("the page's `{name}` is missing")]
    Missing {
        /// The part.
        name: String,
    },
}
