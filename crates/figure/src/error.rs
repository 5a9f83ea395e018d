//! Why a figure cannot be drawn.

use std::fmt;

/// Why a figure cannot be drawn.
///
/// ```
/// # #[cfg(feature = "png")] {
/// use grouser_figure::{Error, Figure};
///
/// let refused = Figure::new("too fine").png(1e9);
/// assert!(matches!(refused, Err(Error::PictureSize { .. })));
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A picture without pixels, or with too many.
    PictureSize {
        /// Columns.
        width: f64,
        /// Rows.
        height: f64,
        /// The greatest number of columns and of rows.
        limit: f64,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PictureSize {
                width,
                height,
                limit,
            } => write!(
                f,
                "the picture is {width} by {height} pixels, but each side must lie in [1, {limit}] pixels"
            ),
        }
    }
}

impl std::error::Error for Error {}
