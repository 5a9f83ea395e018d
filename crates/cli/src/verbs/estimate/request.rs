//! What a log is read with.

use std::path::PathBuf;

use grouser_files::columns::ColumnMap;
use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_replay::Options;

use crate::error::Result;

/// The robot, the column map, and how the slips are found.
pub(super) struct Request {
    pub(super) robot: RobotFile,
    pub(super) map: Option<ColumnMap>,
    pub(super) options: Options,
}

impl Request {
    /// The log at these paths.
    pub(super) fn log(&self, paths: &[PathBuf]) -> Result<Log> {
        Ok(Log::find_any(paths, self.map.clone(), &self.robot.topics)?)
    }
}
