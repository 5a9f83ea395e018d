//! A log through the estimator in parts: rows as they are found, so that the page shows a run while it grows.

use std::io;

use grouser_files::robot::RobotFile;
use grouser_replay::{Row, Sink, Step, Summary};
use grouser_slip::WheelRole;
use serde_json::{Value, json};

use super::moments::{BODY_COLUMNS, Moments};
use super::part;

/// The largest number of rows in a part.
const MAX_ROWS: usize = 4096;

/// The last part of a run that cannot go on, with the reason.
///
/// ```
/// let part = grouser_page::run::failed("log.csv: line 3: …");
/// assert_eq!(part.len() % 8, 0);
/// ```
#[must_use]
pub fn failed(message: &str) -> Vec<u8> {
    part::bytes(json!({ "failed": message }), &[])
}

/// The rows of a log through the estimator, in parts of bytes; `take` receives each part.
///
/// ```
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_page::run::LogParts;
/// use grouser_replay::{Options, run_into};
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?;
/// let mut parts = 0;
/// let mut run = LogParts::new("log.csv", &robot, |_part| parts += 1);
/// let summary = run_into(&log, &robot, &Options::default(), &mut run)?;
/// let end = run.end(&summary);
/// assert_eq!(end["wheels"].as_array().map(Vec::len), Some(5));
/// assert_eq!(parts, 2); // the names of the wheels, then 2001 rows
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct LogParts<F> {
    take: F,
    names: Vec<String>,
    moments: Moments,
}

impl<F: FnMut(Vec<u8>)> LogParts<F> {
    /// Begins a run of `robot`; `title` names the log. The first part has the wheels' names.
    pub fn new(title: &str, robot: &RobotFile, mut take: F) -> Self {
        let wheels = robot.robot.wheels();
        let begin = json!({ "begin": {
            "kind": "estimate",
            "title": title,
            "wheels": wheels.iter().map(|wheel| json!({
                "name": wheel.name,
                "is_reference": wheel.role == WheelRole::Free,
            })).collect::<Vec<_>>(),
        } });
        take(part::bytes(begin, &[]));
        let body = BODY_COLUMNS.iter().map(|name| (*name).to_owned());
        let of_wheels =
            (0..wheels.len()).flat_map(|i| [format!("slip {i}"), format!("slip_sigma {i}")]);
        let names: Vec<String> = body.chain(of_wheels).collect();
        Self {
            take,
            names,
            moments: Moments::new(wheels.len()),
        }
    }

    /// Sends a part of this run that was made elsewhere: its [`overview`](super::overview()).
    pub fn add(&mut self, part: Vec<u8>) {
        (self.take)(part);
    }

    /// Sends what is there, however little: a live run shows its newest row at once.
    pub fn flush(&mut self) {
        let moments = &mut self.moments;
        if moments.len() == 0 && moments.changes.is_empty() {
            return;
        }
        let changes = moments.changes.drain(..);
        let changes: Vec<Value> = changes
            .map(|change| json!([change.kind, change.wheel, change.time_s, change.name]))
            .collect();
        let head = json!({ "changes": changes, "distance_m": moments.distance });
        let columns = moments.columns.iter().map(Vec::as_slice);
        let columns: Vec<(String, &[f64])> = self.names.iter().cloned().zip(columns).collect();
        (self.take)(part::bytes(head, &columns));
        moments.columns.iter_mut().for_each(Vec::clear);
    }

    /// Ends the run: what is known once the whole log was read.
    pub fn end(&mut self, summary: &Summary) -> Value {
        self.flush();
        let doubts = [summary.doubts_in_words(), summary.reservations()].concat();
        let wheels: Vec<Value> = summary
            .wheels
            .iter()
            .map(|wheel| json!({ "median_slip": wheel.slip.median, "is_reference": wheel.is_reference }))
            .collect();
        json!({ "doubts": doubts, "distance_m": self.moments.distance, "wheels": wheels })
    }

    /// As [`LogParts::end`], as the last part, with further `doubts` of how the log was read.
    pub fn finish(&mut self, summary: &Summary, doubts: Vec<String>) {
        let mut end = self.end(summary);
        if let Some(all) = end["doubts"].as_array_mut() {
            all.extend(doubts.into_iter().map(Value::from));
        }
        (self.take)(part::bytes(json!({ "end": end }), &[]));
    }
}

impl<F: FnMut(Vec<u8>)> Sink for LogParts<F> {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        self.moments.row(row)
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        self.moments.step(step)?;
        if self.moments.len() >= MAX_ROWS {
            self.flush();
        }
        Ok(())
    }
}
