//! `identify`: a soil from plate, shear and wheel tests.

mod errors;
mod figure;
pub(crate) mod object;
mod text;

use std::path::{Path, PathBuf};

use grouser_files::{Document, soil};
use grouser_identify::{Identification, Job, compare_laws, identify};

use crate::error::{Error, Result, shown};
use crate::exit::Outcome;
use crate::figure_file::{Target, ending};
use crate::law_error::Names;
use crate::output::OutputFile;
use crate::progress::Progress;
use crate::session::Session;
use crate::verb_report::Report;

#[derive(clap::Args, Debug)]
#[command(
    about = "Find a soil's numbers from plate, shear and wheel tests",
    long_about = "Find a soil's numbers from plate, shear and wheel tests, with their 95 % intervals, and write a \
        soil file that every other verb reads.\n\nThe file names the tests (tables with units in their column names, \
        or a bag with the force and a text file with the depth), what else is known, and which numbers the wheel \
        tests determine. Numbers that the data do not determine are reported by name. docs/bevameter.md goes through one.",
    after_help = "Example:\n  grouser identify examples/bevameter/tests.toml -o sand.toml --figure residuals.svg\n  \
        grouser wheel --soil sand.toml --radius-m 0.1 --width-m 0.06 --load-n 60 --slip 0.2"
)]
pub(crate) struct Arguments {
    /// The file that names the tests
    #[arg(value_name = "TESTS.toml")]
    tests: PathBuf,
    /// Write the soil file (.toml)
    #[arg(short, long, value_name = "SOIL.toml")]
    output: Option<PathBuf>,
    /// Draw tests and residuals (.svg, .png); may be given again
    #[arg(long, value_name = "FILE")]
    figure: Vec<PathBuf>,
    /// Fit each set of laws without one slip angle (or one test) after the other, and compare it with what was left out
    #[arg(long)]
    compare_laws: bool,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let document = Document::read(&arguments.tests)?;
    session.used_document(&document);
    let job = Job::read(&document)?;
    let figures = Target::begin(&arguments.figure)?;
    let output = arguments.output.as_deref().map(soil_output).transpose()?;
    for file in job.files() {
        session.used_file(file)?;
    }
    if let Some(wheel) = &job.wheel {
        session.used_seed(wheel.starts.seed);
    }
    let progress = Progress::of_work("fitting the soil's numbers");
    let mut found = identify(&job)?;
    if arguments.compare_laws {
        found.comparison = compare_laws(&job)?;
    }
    drop(progress);
    let mut text = text::text(&found);
    if let Some(output) = output {
        text.push_str(&output.write_whole(soil_text(&job, &found)?.as_bytes())?);
    }
    for target in figures {
        text.push_str(&target.write(&figure::draw(&found))?);
    }
    let failure = found
        .wheel
        .as_ref()
        .filter(|stage| !stage.status.is_solved())
        .map(|stage| {
            format!(
                "the search for the wheel's numbers ended with `{}`",
                stage.status.key()
            )
        });
    let outcome = match found.doubts().as_slice() {
        [] => Outcome::Done,
        _ => Outcome::Doubtful,
    };
    let report = Report {
        outcome,
        warnings: text::warnings(&found),
        ..Report::done(object::fields().object(&found), text)
    };
    Ok(report.failing(failure))
}

fn soil_output(path: &Path) -> Result<OutputFile> {
    if ending(path).as_deref() != Some("toml") {
        return Err(Error::usage(
            format!("{} does not end in `.toml`", shown(path)),
            "a soil is written as TOML; tests and residuals are drawn with `--figure`",
        ));
    }
    OutputFile::create(path)
}

/// The soil file's text; an error names the numbers that are missing.
fn soil_text(job: &Job, found: &Identification) -> Result<String> {
    let missing = found.missing();
    if !missing.is_empty() {
        return Err(Error::usage(
            format!("the tests do not determine {}", missing.join(", ")),
            "state them in [soil], or add tests that determine them",
        ));
    }
    let (file, remarks) = found.soil_file(job);
    let remarks: Vec<&str> = remarks.iter().map(String::as_str).collect();
    soil::to_toml(&file, &remarks).map_err(|error| Names::Flags.error(&error))
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    object::fields().schema()
}
