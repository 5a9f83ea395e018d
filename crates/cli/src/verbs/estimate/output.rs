//! The files of `estimate`: slip against time as a table, as a figure, or as messages.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use grouser_files::robot::RobotFile;
use grouser_log::csv::quoted;
use grouser_replay::{Row, Sink, Step, Summary};
use grouser_slip::Wheel;

use super::figure::{Trace, draw};
use super::mcap::Recording;
use crate::error::{Error, Result, shown};
use crate::figure_file::{self, Target};
use crate::output::OutputFile;
use grouser_report::number::exact;

/// The output files, written while the log is read.
pub(super) struct Outputs {
    tables: Vec<OutputFile>,
    figures: Vec<Target>,
    recordings: Vec<Recording>,
    traces: Vec<Trace>,
    /// The table or recording that could not be written.
    broken: Option<PathBuf>,
}

impl Outputs {
    /// Begins the files, so that a path that cannot be written is refused before the work.
    pub(super) fn begin(paths: &[PathBuf], wheels: &[Wheel]) -> Result<Self> {
        let mut outputs = Self {
            tables: Vec::new(),
            figures: Vec::new(),
            recordings: Vec::new(),
            traces: wheels.iter().map(|_| Trace::default()).collect(),
            broken: None,
        };
        for path in paths {
            if figure_file::ending(path).as_deref() == Some("csv") {
                let mut table = OutputFile::create(path)?;
                writeln!(
                    table,
                    "time_s,wheel,slip,slip_sigma,motion,health,side_slip_angle_deg"
                )
                .map_err(|error| Error::file("write", path, &error))?;
                outputs.tables.push(table);
            } else if is_figure(path) {
                outputs.figures.push(Target::create(path)?);
            } else if figure_file::ending(path).as_deref() == Some("mcap") {
                outputs.recordings.push(Recording::begin(path, wheels)?);
            } else {
                return Err(Error::usage(
                    format!(
                        "{} does not end in `.csv`, `.svg`, `.png` or `.mcap`",
                        shown(path)
                    ),
                    "the ending of an output's name chooses its format",
                ));
            }
        }
        Ok(outputs)
    }

    /// Why a replay ended that fed these files.
    pub(super) fn error(&self, error: grouser_replay::Error) -> Error {
        match (&self.broken, error) {
            (Some(path), grouser_replay::Error::Sink(error)) => Error::file("write", path, &error),
            (_, error) => error.into(),
        }
    }

    /// Puts the complete files in their places; gives lines that say so.
    pub(super) fn finish(
        self,
        robot: &RobotFile,
        summary: &Summary,
        truths: &[(String, Vec<[f64; 2]>)],
    ) -> Result<String> {
        let mut said = String::new();
        for table in self.tables {
            let path = table.path().to_owned();
            table.finish()?;
            let _ = writeln!(said, "wrote {}", shown(&path));
        }
        for recording in self.recordings {
            said.push_str(&recording.finish()?);
        }
        if !self.figures.is_empty() {
            let figure = draw(robot, summary, &self.traces, truths);
            for target in self.figures {
                said.push_str(&target.write(&figure)?);
            }
        }
        Ok(if said.is_empty() {
            said
        } else {
            format!("\n{said}")
        })
    }
}

impl Sink for Outputs {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        if !self.figures.is_empty() {
            self.traces[row.wheel].add(row);
        }
        for table in &mut self.tables {
            if let Err(error) = write_row(table, row) {
                self.broken = Some(table.path().to_owned());
                return Err(error);
            }
        }
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        for recording in &mut self.recordings {
            if let Err(error) = recording.step(step) {
                self.broken = Some(recording.path().to_owned());
                return Err(error);
            }
        }
        Ok(())
    }
}

fn is_figure(path: &Path) -> bool {
    matches!(figure_file::ending(path).as_deref(), Some("svg" | "png"))
}

fn write_row(table: &mut OutputFile, row: &Row<'_>) -> io::Result<()> {
    let or_empty = |value: Option<f64>| value.map_or_else(String::new, exact);
    writeln!(
        table,
        "{},{},{},{},{},{},{}",
        exact(row.time_s),
        quoted(row.name),
        or_empty(row.slip),
        or_empty(row.slip_sigma),
        row.motion.map_or("", grouser_slip::Motion::name),
        quoted(&row.health.to_string()),
        or_empty(row.side_slip_angle.map(f64::to_degrees)),
    )
}
