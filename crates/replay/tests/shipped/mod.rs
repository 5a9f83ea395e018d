//! The examples that ship, and the measured data where it is at hand.

use std::path::{Path, PathBuf};

use grouser_files::robot::RobotFile;
use grouser_files::{columns, robot};
use grouser_log::Log;
use grouser_replay::{Options, Summary, run};

pub(crate) use crate::measured_data::measured_data as data;

pub(crate) fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// Robotino's, by the names of their files.
pub(crate) const ROBOTINO: [&str; 6] = [
    "table_surface_exp01",
    "table_surface_exp26",
    "table_surface_exp53",
    "gray_surface_exp01",
    "gray_surface_exp26",
    "green_surface_exp01",
];

pub(crate) struct Example {
    pub(crate) robot: RobotFile,
    pub(crate) map: Option<columns::ColumnMap>,
}

pub(crate) fn example(name: &str) -> Example {
    let folder = root().join("examples").join(name);
    Example {
        robot: robot::read(&folder.join("robot.toml")).unwrap(),
        map: columns::read(&folder.join("columns.toml")).ok(),
    }
}

impl Example {
    pub(crate) fn log(&self, path: PathBuf) -> Log {
        Log::find_any(&[path], self.map.clone(), &self.robot.topics).unwrap()
    }

    pub(crate) fn summary(&self, path: PathBuf, options: &Options) -> Summary {
        run(&self.log(path), &self.robot, options, |_| Ok(())).unwrap()
    }
}
