//! Why a campaign cannot be run.

/// The result of a campaign.
pub type Result<T> = std::result::Result<T, Error>;

/// What a campaign refuses.
///
/// ```
/// let error = grouser_campaign::paper::Paper::compute("no scenario", "no robot").err().unwrap();
/// assert!(matches!(error, grouser_campaign::Error::File(_) | grouser_campaign::Error::Rover(_)));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file that cannot be read.
    #[error(transparent)]
    File(#[from] grouser_files::Error),
    /// A reading of the paper's problem, or the slip setpoint.
    #[error(transparent)]
    Design(#[from] grouser_design::Error),
    /// The run on sand.
    #[error(transparent)]
    Rover(#[from] grouser_rover::Error),
}
