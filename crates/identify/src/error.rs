//! What is wrong with a job of identification.

use std::path::PathBuf;

/// The result of a job.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a job cannot be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A search that begins outside its bounds.
    #[error("parameter {index} starts at {start}, but must lie in [{lower}, {upper}]")]
    Start {
        /// Which parameter.
        index: usize,
        /// Its start.
        start: f64,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// Fewer measurements than numbers to be found.
    #[error("{residuals} measurements cannot determine {parameters} parameters")]
    TooFew {
        /// Measurements.
        residuals: usize,
        /// Parameters.
        parameters: usize,
    },
    /// Tests with fewer readings than a law needs.
    #[error("{message}")]
    TooFewReadings {
        /// How many there are, of which tests, how many were left out and why.
        message: String,
    },
    /// More parameters than starts can be drawn for.
    #[error("{parameters} parameters are too many, the limit is 64")]
    TooMany {
        /// Parameters.
        parameters: usize,
    },
    /// A log or a table that cannot be read.
    #[error(transparent)]
    Log(#[from] grouser_log::Error),
    /// A file that cannot be read.
    #[error(transparent)]
    File(#[from] grouser_files::Error),
    /// A wheel or a soil that the laws refuse.
    #[error("{what}: {source}")]
    Law {
        /// What was being done.
        what: String,
        /// What is wrong.
        source: grouser_terra::Error,
    },
    /// A file whose content does not fit.
    #[error("{}: {message}", .path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, with the place.
        message: String,
    },
    /// A number that must be given for this job.
    #[error("{what} is missing: {needed_by}")]
    Missing {
        /// What.
        what: &'static str,
        /// What needs it.
        needed_by: String,
    },
}
