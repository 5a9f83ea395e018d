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

/// Robotino's runs from one surface onto another.
pub(crate) const TWO_SURFACES: [&str; 6] = [
    "green_table_exp00",
    "green_table_exp14",
    "green_table_exp27",
    "table_gray_exp02",
    "table_gray_exp17",
    "table_gray_exp25",
];

/// Robotino's runs without their first 60 rows, as its data page has them.
pub(crate) const CUT: Options = Options {
    offline: false,
    reference: None,
    wheel_sensor: None,
    from_s: Some(1.9),
    to_s: None,
    learn_soil: None,
};

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

pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
}
