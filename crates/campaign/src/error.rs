//! Why a campaign cannot be run.

/// The result of a campaign.
pub type Result<T> = std::result::Result<T, Error>;

/// What a campaign refuses.
///
/// ```
/// let missing = grouser_rover::drive::read_scenario("none.toml".as_ref()).unwrap_err();
/// assert!(matches!(grouser_campaign::Error::from(missing), grouser_campaign::Error::Rover(_)));
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
    /// A wheel of the robot on the soil of the run.
    #[error(transparent)]
    Law(#[from] grouser_terra::Error),
    /// The run on sand.
    #[error(transparent)]
    Rover(#[from] grouser_rover::Error),
}
