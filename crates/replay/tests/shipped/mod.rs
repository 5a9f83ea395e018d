//! The examples that ship, and the measured data where it is at hand.
#![allow(dead_code, reason = "each test file uses its own part of this")]

use std::path::{Path, PathBuf};

use grouser_files::robot::RobotFile;
use grouser_files::{columns, robot};
use grouser_log::Log;
use grouser_replay::{Options, Summary, run};

pub(crate) fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// A folder of the measured data; `None` (said on stderr) where it is absent, which in CI is a failure.
pub(crate) fn data(folder: &str) -> Option<PathBuf> {
    let base = std::env::var_os("GROUSER_DATA").map_or_else(|| root().join("data"), PathBuf::from);
    // A relative path counts from the workspace's root, wherever the test runs.
    let path = root().join(base).join(folder);
    if path.is_dir() {
        return Some(path);
    }
    assert!(
        std::env::var_os("CI").is_none(),
        "no measured data at {}, and CI is set",
        path.display()
    );
    eprintln!(
        "skipped: no measured data at {} (GROUSER_DATA)",
        path.display()
    );
    None
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
