//! A cart of one wheel, its recordings and their readings.

use grouser_files::Document;
use grouser_files::robot::{self, RobotFile};
use grouser_log::Log;
use grouser_log::message::Value;
use grouser_slip::Sample;

use crate::recordings::write;
use crate::scratch::Folder;

/// Topic, type, time of the recorder (ns), value.
pub(crate) type Message = (&'static str, &'static str, i64, Value);

pub(crate) const WHEELS: &str =
    "[[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n";

pub(crate) fn robot(topics: &str) -> RobotFile {
    let text = format!("format = 1\nname = \"cart\"\n{topics}\n{WHEELS}");
    robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap()
}

pub(crate) fn log(folder: &Folder, topics: &str, messages: &[Message]) -> Log {
    let path = write(&folder.0.join("log.mcap"), messages);
    Log::find_any(&[path], None, &robot(topics).topics).unwrap()
}

pub(crate) fn readings(log: &Log) -> Vec<Sample> {
    log.samples(&[]).unwrap().map(Result::unwrap).collect()
}
