//! A recorded log through the estimator, as `grouser estimate` runs it.

use std::io::Cursor;

use grouser_files::{Document, columns, robot};
use grouser_log::Log;
use grouser_page::run::{LogParts, overview};
use grouser_replay::{Options, run_into};
use serde_json::Value;

use crate::request::{Problem, Request};

/// Runs the log in `file`, named `log_name`, with the robot file in `robot` and the column map in `columns`. `take`
/// receives the run in parts: the wheels, the whole log's rim speeds, then the rows; the answer has what is known at
/// the end.
pub(crate) fn solve(
    request: &Request<'_>,
    file: Vec<u8>,
    take: &mut dyn FnMut(Vec<u8>),
) -> Result<Value, Problem> {
    let document =
        |name: &str, text: &str| Document::from_text(name, text.to_owned()).map_err(Problem::of);
    let robot =
        robot::parse(&document("robot.toml", request.text("robot")?)?).map_err(Problem::of)?;
    let map = request
        .optional_text("columns")?
        .map(|text| columns::parse(&document("columns.toml", text)?).map_err(Problem::of))
        .transpose()?
        .or_else(|| robot.columns.clone());
    let name = request.optional_text("log_name")?.unwrap_or("log");
    let log =
        Log::over(name.as_ref(), Cursor::new(file), map, &robot.topics).map_err(Problem::of)?;
    let glance = overview(&log, &robot).map_err(Problem::of)?;
    let mut run = LogParts::new(name, &robot, &mut *take);
    run.add(glance);
    let summary = run_into(&log, &robot, &Options::default(), &mut run).map_err(Problem::of)?;
    Ok(run.end(&summary))
}
