//! Slip of a log: `cargo run -p grouser-replay --example estimate -- ROBOT.toml COLUMNS.toml LOG...`
#![allow(clippy::print_stdout, reason = "it prints what it finds")]

use std::path::{Path, PathBuf};

use grouser_replay::{Options, run};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(Into::into).collect();
    let paths = arguments.split_off(2.min(arguments.len()));
    let [robot, columns] = arguments.as_slice() else {
        return Err("give a robot, a column map and a log".into());
    };
    let file = grouser_files::robot::read(Path::new(robot))?;
    let map = grouser_files::columns::read(Path::new(columns))?;
    let log = grouser_log::Log::find(&paths, map)?;
    let from_s = std::env::var("FROM_S").ok().and_then(|s| s.parse().ok());
    let options = Options {
        from_s,
        ..Options::default()
    };
    let summary = run(&log, &file, &options, |_| Ok(()))?;
    println!("{summary:#?}");
    Ok(())
}
