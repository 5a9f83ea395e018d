//! What can go wrong.

use std::path::PathBuf;

/// The result of what may fail here.
pub type Result<T> = std::result::Result<T, Error>;

/// Why the node does not run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The robot file or the state file.
    #[error(transparent)]
    Files(#[from] grouser_files::Error),
    /// A state file of another robot.
    #[error("{}: the state is of the robot `{found}`, not of `{robot}`", path.display())]
    OtherRobot {
        /// The file.
        path: PathBuf,
        /// The robot that it names.
        found: String,
        /// The robot of the robot file.
        robot: String,
    },
    /// The state was written by another version of the program.
    #[error("{}: the state is of version {found}, but this program reads version {expected}", path.display())]
    OtherState {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: i64,
        /// The version that this program reads.
        expected: i64,
    },
    /// The topics do not fit the robot file.
    #[error(transparent)]
    Log(#[from] grouser_log::Error),
    /// The estimator does not run with these topics.
    #[error(transparent)]
    Replay(#[from] grouser_replay::Error),
    /// An environment variable.
    #[error("the environment variable `{name}` is `{value}`, but must be {wanted}")]
    Environment {
        /// The variable.
        name: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        wanted: String,
    },
    /// An option.
    #[error("`{name}` is {value}, but must be {wanted}")]
    Option {
        /// The option.
        name: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        wanted: String,
    },
    /// Limits of commands that the controller does not take.
    #[error(transparent)]
    Slip(#[from] grouser_slip::Error),
    /// A transport that this program was built without.
    #[error("this program was built without the transport `{name}`")]
    NoTransport {
        /// The transport.
        name: &'static str,
    },
    /// The transport fails.
    #[error("{name}: {what}")]
    Transport {
        /// The transport.
        name: &'static str,
        /// What it says.
        what: String,
    },
    /// A message type whose definition is not known.
    #[error("the definition of `{type_name}` is not known")]
    UnknownType {
        /// The type.
        type_name: String,
    },
    /// A fault of the node itself, which ends in order.
    #[error("the node has a fault: {what}")]
    Panic {
        /// What the fault reports.
        what: String,
    },
    /// A message that cannot be written.
    #[error(transparent)]
    Message(#[from] grouser_log::message::MessageError),
}

impl From<Error> for std::io::Error {
    fn from(error: Error) -> Self {
        Self::other(error)
    }
}
