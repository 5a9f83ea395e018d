//! Commands that `paper` runs in its own process: the verbs themselves, with the arguments that a shell would pass.

use std::path::Path;

use clap::Parser;
use grouser_replay::Compared;

use super::super::{drive, estimate, optimize, wheel};
use super::slip_model;
use crate::error::{Error, Result};
use crate::exit::Outcome;
use crate::files_in_use;
use crate::session::Session;
use crate::terminal;
use crate::verb_report::Report;

/// The verbs that are run.
#[derive(clap::Parser, Debug)]
#[command(name = "grouser")]
enum Verb {
    Wheel(wheel::Arguments),
    Optimize(optimize::Arguments),
    Drive(drive::Arguments),
    Estimate(estimate::Arguments),
    #[command(subcommand)]
    Paper(Part),
}

#[derive(clap::Subcommand, Debug)]
enum Part {
    SlipModel(slip_model::Arguments),
}

/// A command with its result.
pub(super) struct Step {
    /// The line that a shell would run in the folder.
    pub(super) line: String,
    pub(super) report: Report,
    /// Of `estimate`: every slip next to the true one.
    pub(super) compared: Option<Compared>,
}

/// Runs commands one after the other in a folder.
pub(super) struct Steps<'a> {
    pub(super) folder: &'a Path,
    /// Steps in all, for the progress.
    pub(super) count: usize,
    pub(super) done: Vec<Step>,
}

impl<'a> Steps<'a> {
    pub(super) fn new(folder: &'a Path, count: usize) -> Self {
        Self {
            folder,
            count,
            done: Vec::new(),
        }
    }

    /// Runs `line`, whose words starting with `@` are files of the folder.
    pub(super) fn run(&mut self, line: &str, session: &mut Session) -> Result<&Step> {
        let shown = line.replace('@', "");
        terminal::progress(&format!("{}/{}  {shown}", self.done.len() + 1, self.count));
        let word = |word: &str| match word.strip_prefix('@') {
            Some(file) => self.folder.join(file).into_os_string(),
            None => word.into(),
        };
        let verb = Verb::try_parse_from(line.split_whitespace().map(word))
            .map_err(|error| Error::usage_without_hint(error.to_string()))?;
        // a file that one command writes is an input of the next
        files_in_use::clear();
        let (report, compared) = match verb {
            Verb::Wheel(arguments) => (wheel::run(&arguments, session)?, None),
            Verb::Optimize(arguments) => (optimize::run(&arguments, session)?, None),
            Verb::Drive(arguments) => (drive::run(&arguments, session)?, None),
            Verb::Paper(Part::SlipModel(arguments)) => {
                (slip_model::run(&arguments, session)?, None)
            }
            Verb::Estimate(arguments) => estimate::run_compared(&arguments, session)?,
        };
        self.done.push(Step {
            line: shown,
            report,
            compared,
        });
        Ok(&self.done[self.done.len() - 1])
    }

    /// The worst outcome of all: the exit code of the whole.
    pub(super) fn outcome(&self) -> Outcome {
        let outcomes = || self.done.iter().map(|step| step.report.outcome);
        [Outcome::Interrupted, Outcome::NoResult, Outcome::Doubtful]
            .into_iter()
            .find(|worst| outcomes().any(|outcome| outcome == *worst))
            .unwrap_or(Outcome::Done)
    }

    /// The warnings of all, each with its verb.
    pub(super) fn warnings(&self) -> Vec<String> {
        let of = |step: &Step| {
            let verb = step
                .line
                .split_whitespace()
                .nth(1)
                .unwrap_or_default()
                .to_owned();
            let warnings = step.report.warnings.clone().into_iter();
            warnings.map(move |warning| format!("{verb}: {warning}"))
        };
        self.done.iter().flat_map(of).collect()
    }
}
