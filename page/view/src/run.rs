//! A log through the estimator in the server, for a page that shows it while it is read.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::sleep;
use std::time::Duration;

use grouser_files::columns::ColumnMap;
use grouser_files::robot::RobotFile;
use grouser_files::{columns, robot};
use grouser_log::Log;
use grouser_page::run::{LogParts, failed, overview};
use grouser_replay::{Options, Row, Sink, Step, run_into};

use crate::error::{Error, Result};
use crate::feed::Feed;

/// How often a file is looked at that has not grown.
const LOOK_INTERVAL: Duration = Duration::from_millis(50);
/// Rows of a growing table that are held back, to be put into the order of time.
const LIVE_LOOK_AHEAD: usize = 4;

/// A log and the files that describe it, read and checked.
#[derive(Debug)]
pub struct RecordedRun {
    log: PathBuf,
    robot: RobotFile,
    map: Option<ColumnMap>,
    is_live: bool,
}

impl RecordedRun {
    /// Reads the robot file and the column map: `map`, the robot file's, or `columns.toml` beside it. With `is_live` the
    /// log is still written.
    ///
    /// # Errors
    /// What is wrong with one of the files.
    pub fn open(log: &Path, robot: &Path, map: Option<&Path>, is_live: bool) -> Result<Self> {
        let refused = |error: &dyn std::fmt::Display| Error::Refused {
            message: error.to_string(),
        };
        let file = robot::read(robot).map_err(|error| refused(&error))?;
        let beside = robot.with_file_name("columns.toml");
        let map = match map {
            Some(map) => Some(columns::read(map).map_err(|error| refused(&error))?),
            None if file.columns.is_some() => file.columns.clone(),
            None if beside.is_file() => {
                Some(columns::read(&beside).map_err(|error| refused(&error))?)
            }
            None => None,
        };
        Ok(Self {
            log: log.to_owned(),
            robot: file,
            map,
            is_live,
        })
    }

    /// Does it still grow?
    #[must_use]
    pub const fn is_live(&self) -> bool {
        self.is_live
    }

    /// Runs the log into `feed`, in a thread that ends with it.
    #[must_use]
    pub fn start(self) -> Feed {
        let feed = Feed::new();
        let into = feed.clone();
        std::thread::spawn(move || {
            if let Err(message) = self.run(&into) {
                into.add(&failed(&message));
            }
        });
        feed
    }

    fn run(self, feed: &Feed) -> std::result::Result<(), String> {
        let name = self
            .log
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let into = feed.clone();
        let parts = Parts(Arc::new(Mutex::new(LogParts::new(
            &name,
            &self.robot,
            move |part: Vec<u8>| into.add(&part),
        ))));
        let log = self.open_log(&parts)?;
        if !self.is_live {
            feed.add(&overview(&log, &self.robot).map_err(|error| error.to_string())?);
        }
        let mut sink = parts.clone();
        // a log that grows is shown as the robot knows it, one that is done by all of it
        let options = if self.is_live {
            Options::default()
        } else {
            Options::whole_log()
        };
        let summary =
            run_into(&log, &self.robot, &options, &mut sink).map_err(|error| error.to_string())?;
        let left_out = log.left_out();
        let unread = left_out.problem.map(|problem| {
            let count = left_out.undecoded;
            format!("{count} messages or rows of tables could not be read: {problem}")
        });
        let doubts: Vec<String> = log.abandoned().into_iter().chain(unread).collect();
        for doubt in &doubts {
            let _ = writeln!(io::stderr(), "warning: {doubt}");
        }
        parts.with(|parts| parts.finish(&summary, doubts));
        Ok(())
    }

    fn open_log<F: FnMut(Vec<u8>) + Send + 'static>(
        &self,
        parts: &Parts<F>,
    ) -> std::result::Result<Log, String> {
        let map = self.map.clone();
        if !self.is_live {
            let paths = std::slice::from_ref(&self.log);
            return Log::find_any(paths, map, &self.robot.topics)
                .map_err(|error| error.to_string());
        }
        let waiting = parts.clone();
        let wait = move || {
            waiting.with(LogParts::flush);
            sleep(LOOK_INTERVAL);
        };
        let log = Log::following(&self.log, wait, map, &self.robot.topics)
            .map_err(|error| error.to_string())?;
        if !log.unaligned_clocks().is_empty() {
            return Err(format!(
                "{}: clocks are aligned over a whole log (`align_clock`), which a log that is still written is not",
                self.log.display()
            ));
        }
        Ok(log.with_look_ahead(LIVE_LOOK_AHEAD))
    }
}

/// The parts of a run, which the reader of a growing table sends on before it waits.
struct Parts<F>(Arc<Mutex<LogParts<F>>>);

impl<F> Clone for Parts<F> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<F> Parts<F> {
    fn with<T>(&self, act: impl FnOnce(&mut LogParts<F>) -> T) -> T {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl<F: FnMut(Vec<u8>)> Sink for Parts<F> {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        self.with(|parts| parts.row(row))
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        self.with(|parts| parts.step(step))
    }
}
