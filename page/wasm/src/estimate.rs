//! A recorded log through the estimator, as `grouser estimate` runs it.

use std::io::Cursor;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use grouser_files::{Document, columns, robot};
use grouser_log::{Log, suggest_robot};
use grouser_page::run::{LogParts, overview};
use grouser_replay::{Options, run_into};
use serde_json::{Value, json};

use crate::request::{Problem, Request};

/// Runs the log in `file`, named `log_name`, with the robot file in `robot` and the column map in `columns`. Where the log
/// has several files, they stand behind each other, and `logs` has the `name` and the `bytes` of each. `take` receives
/// the run in parts: the wheels, the whole log's rim speeds, then the rows; the answer has what is known at the end.
pub(crate) fn solve(
    request: &Request<'_>,
    file: Vec<u8>,
    take: &mut dyn FnMut(Vec<u8>),
) -> Result<Value, Problem> {
    let document = |name: &str, text: &str| {
        Document::from_text(name, text.to_owned()).map_err(Problem::from_error)
    };
    let robot = robot::parse(&document("robot.toml", request.text("robot")?)?)
        .map_err(Problem::from_error)?;
    let map = request
        .optional_text("columns")?
        .map(|text| columns::parse(&document("columns.toml", text)?).map_err(Problem::from_error))
        .transpose()?
        .or_else(|| robot.columns.clone());
    let name = request.optional_text("log_name")?.unwrap_or("log");
    let files = files(request, name, file)?;
    let log = Log::over_all(files, map, &robot.topics).map_err(Problem::from_error)?;
    let glance = overview(&log, &robot).map_err(Problem::from_error)?;
    let mut run = LogParts::new(name, &robot, &mut *take);
    run.add(glance);
    let summary =
        run_into(&log, &robot, &Options::whole_log(), &mut run).map_err(Problem::from_error)?;
    Ok(run.end(&summary))
}

/// A robot file to start from by the log in `file`, as [`solve`] takes it.
pub(crate) fn suggest(request: &Request<'_>, file: Vec<u8>) -> Result<Value, Problem> {
    let name = request.optional_text("log_name")?.unwrap_or("log");
    let robot = suggest_robot(files(request, name, file)?).map_err(Problem::from_error)?;
    Ok(json!({ "robot": robot }))
}

/// A file among others behind each other.
struct File {
    all: Arc<Vec<u8>>,
    range: Range<usize>,
}

impl AsRef<[u8]> for File {
    fn as_ref(&self) -> &[u8] {
        &self.all[self.range.clone()]
    }
}

/// The files of the log by their names: those of `logs`, or the one that is named `name`.
fn files(
    request: &Request<'_>,
    name: &str,
    all: Vec<u8>,
) -> Result<Vec<(PathBuf, Cursor<File>)>, Problem> {
    let all = Arc::new(all);
    let mut files = Vec::new();
    let mut begin = 0_usize;
    for (name, bytes) in request
        .sizes("logs")?
        .unwrap_or_else(|| vec![(name, all.len())])
    {
        let end = begin.saturating_add(bytes);
        if end > all.len() {
            return Err(Problem::new("logs", format!("the log ends before {name}")));
        }
        let file = File {
            all: Arc::clone(&all),
            range: begin..end,
        };
        files.push((name.into(), Cursor::new(file)));
        begin = end;
    }
    Ok(files)
}
