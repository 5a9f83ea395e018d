//! A recorded log through the estimator, as `grouser estimate` runs it.

use std::io::Cursor;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use grouser_files::{Document, columns, robot};
use grouser_log::Log;
use grouser_page::run::LogRecorder;
use grouser_replay::{Options, run_into};
use serde_json::Value;

use crate::request::{Problem, Request};

/// Runs the log in `log_base64`, named `log_name`, with the robot file in `robot` and the column map in `columns`.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let bytes = STANDARD
        .decode(request.text("log_base64")?)
        .map_err(|error| Problem::new("log_base64", error.to_string()))?;
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
        Log::over(name.as_ref(), Cursor::new(bytes), map, &robot.topics).map_err(Problem::of)?;
    let mut seen = LogRecorder::new(robot.robot.wheels().len());
    let summary = run_into(&log, &robot, &Options::default(), &mut seen).map_err(Problem::of)?;
    Ok(seen.object(name, &summary))
}
