//! `validate`: every measured data set against the model.

mod object;

use std::path::PathBuf;

use grouser_campaign::validate::{PLATES, cmu, validate};

use grouser_files::soil;

use crate::error::Result;
use crate::figure_file::Target;
use crate::law_error::Names;
use crate::output::OutputFile;
use crate::output_choice::Output;
use crate::progress::Progress;
use crate::session::Session;
use crate::verb_report::Report;

#[derive(clap::Args, Debug)]
#[command(
    about = "Compare the model with measured data",
    long_about = "Compare the model with measured data: one table of errors by data set and quantity, for this model, \
        for plain Wong-Reece, for published laws with as many fitted numbers as this model, and the error of \
        the model published with the data.\n\nThe soil's moduli are \
        identified from plate tests, the wheel's numbers from the smooth wheel at slip angle 0; all else is \
        predicted. docs/validate.md says which numbers are fitted and where the data come from.",
    after_help = "Examples:\n  grouser validate --data ../data\n  \
        grouser validate --data ../data --figure measured.svg -o rows.csv --json"
)]
pub(crate) struct Arguments {
    /// The folder of measured data, with `cmu-wheel/` in it
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Draw measured against predicted (.svg, .png); may be given again
    #[arg(long, value_name = "FILE")]
    figure: Vec<PathBuf>,
    /// Write the rows (.csv); may be given again
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Write the soil of the main fit, with every number and law
    #[arg(long, value_name = "FILE.toml")]
    write_soil: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let figures = Target::begin(&arguments.figure)?;
    let tables = Output::begin(&arguments.output)?;
    note_inputs(arguments, session)?;
    let progress = Progress::of_work("fitting the models to measured wheels");
    let validation = validate(&arguments.data)?;
    drop(progress);
    let mut text = validation.text();
    text.push_str(&Output::write_all(
        tables,
        || object::row().csv(&validation.rows),
        || Ok(validation.draw()),
    )?);
    for target in figures {
        text.push_str(&target.write(&validation.draw())?);
    }
    if let Some(path) = &arguments.write_soil
        && let Some((file, remarks)) = validation.soil_file()
    {
        let remarks: Vec<&str> = remarks.iter().map(String::as_str).collect();
        let toml = soil::to_toml(&file, &remarks).map_err(|error| Names::Flags.error(&error))?;
        text.push_str(&OutputFile::create(path)?.write_whole(toml.as_bytes())?);
    }
    Ok(Report::done(object::fields().object(&validation), text))
}

/// Every file that the table rests on, with its digest.
fn note_inputs(arguments: &Arguments, session: &mut Session) -> Result<()> {
    let mut files = vec![arguments.data.join(cmu::TRIALS)];
    for (name, ..) in PLATES {
        for ending in ["bag", "txt"] {
            files.push(arguments.data.join(format!("{name}.{ending}")));
        }
    }
    for file in files {
        session.used_file(&file)?;
    }
    Ok(())
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    object::fields().schema()
}
