//! `paper`: a folder with what can be reproduced of the source paper, and what cannot, said plainly.

use std::fs;
use std::path::PathBuf;

use grouser_campaign::paper::{Paper, SEED};

use crate::error::{Error, Result, shown as shown_path};
use crate::output::OutputFile;
use crate::session::Session;
use crate::verb_report::Report;
use grouser_report::{Fields, fields};

const SCENARIO: &str = include_str!("../../templates/scenario.toml");
const ROBOT: &str = include_str!("../../templates/robot.toml");

#[derive(clap::Args, Debug)]
#[command(
    about = "Write what can be reproduced of Ani et al. (2012), and what cannot",
    long_about = "Write a folder with figures 8, 9 and 10 of Ani et al. (2012) and their numbers, its figure \
        13 of a simulated run on sand, the paper's optimisation problem under several readings, and a page that says \
        of each equation, table and figure whether it is reproduced, reproduced in part, or not possible and why. The \
        printed optimum slip of 0.1146 is not claimed.",
    after_help = "Example:\n  grouser paper -o paper"
)]
pub(crate) struct Arguments {
    /// The folder; it is made if it does not exist
    #[arg(short, long, value_name = "DIR", default_value = "paper")]
    output: PathBuf,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let folder = &arguments.output;
    fs::create_dir_all(folder).map_err(|error| Error::file("make", folder, &error))?;
    session.used_seed(SEED);
    let paper = Paper::compute(SCENARIO, ROBOT)?;
    for file in paper.files() {
        OutputFile::create(&folder.join(&file.name))?.write_whole(file.content.as_bytes())?;
    }
    let text = format!(
        "{}wrote {} files into {}; begin with paper.html\n",
        paper.text(),
        paper.files().len(),
        shown_path(folder)
    );
    Ok(Report::done(fields().object((folder, &paper)), text))
}

fn fields<'a>() -> Fields<'a, (&'a PathBuf, &'a Paper)> {
    fields! { |written: (&'a PathBuf, &'a Paper)|
        "folder" "the folder" = written.0.display().to_string();
        join(Paper::fields()) = written.1;
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    fields().schema()
}
