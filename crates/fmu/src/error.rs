//! What may go wrong.

/// Why a unit cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number that the laws refuse.
    #[error(transparent)]
    Law(#[from] grouser_terra::Error),
    /// A resource that cannot be read.
    #[error(transparent)]
    File(#[from] grouser_files::Error),
    /// The name of a model must be an identifier of C.
    #[error("`{name}` is not a name of a model: letters, digits and `_`, the first no digit")]
    Name {
        /// The name.
        name: String,
    },
    /// A zip archive without extensions has 32-bit lengths.
    #[error("{name} has {bytes} bytes, but an entry of a unit has at most 2^32 - 1")]
    TooLong {
        /// The entry.
        name: String,
        /// Its length.
        bytes: usize,
    },
}

/// A result of this crate.
pub type Result<T> = std::result::Result<T, Error>;
