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
    /// A reading of the paper's problem, or the slip to run at.
    #[error(transparent)]
    Design(#[from] grouser_design::Error),
    /// The run on sand.
    #[error(transparent)]
    Rover(#[from] grouser_rover::Error),
    /// A wheel on a soil, for the figures of its stress.
    #[error(transparent)]
    Terra(#[from] grouser_terra::Error),
    /// The robot of the run on sand has no powered wheel.
    #[error("the robot has no powered wheel")]
    NoPoweredWheel,
    /// The soil of the run on sand does not carry its wheel at the slip to run at.
    #[error("the soil of the scenario carries no wheel of the robot at the slip to run at")]
    NoOperatingPoint,
}
