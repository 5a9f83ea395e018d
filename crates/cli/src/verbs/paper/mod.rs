//! `paper`: its slip model; a folder with what can be reproduced of the source paper; its robot end to end.

mod end_to_end;
mod run;
mod slip_model;
mod steps;

use std::fs;
use std::path::{Path, PathBuf};

use grouser_campaign::paper::{Content, Paper, PaperFile, SEED};

use self::run::{sand_run, scenario};
use self::steps::Steps;
use crate::error::{Error, Result, shown as shown_path};
use crate::figure_file;
use crate::files_in_use;
use crate::output::OutputFile;
use crate::progress::Progress;
use crate::report_file::ReportFlag;
use crate::session::Session;
use crate::verb_report::Report;
use grouser_report::{Fields, fields};

#[derive(clap::Args, Debug)]
#[command(
    about = "Write what can be reproduced of Ani et al. (2012), and what cannot",
    long_about = "Write a folder with the figures of Ani et al. (2012) as SVG and PNG and their numbers as CSV: 1 to 3 \
        from the robot file, 5 from the stress model, 8 to 10 from the slip model, 11 from the controller, 13 from the log of a simulated run on sand; the \
        paper's optimisation problem under several readings, and a page that says \
        of each equation, table and figure whether it is reproduced, reproduced in part, or not possible and why. The \
        printed optimum slip of 0.1146 is not claimed.\n\n--end-to-end instead takes the paper's robot from the analytical \
        model over a certified slip setpoint, a drive on sand, the estimate of its log and the soil learnt to the \
        controller's decisions: one page, its tables, and the commands that it runs. docs/paper.md has a row for each \
        statement of the paper.",
    after_help = "Examples:\n  grouser paper -o paper\n  grouser paper --end-to-end -o paper --report paper.html\n  grouser paper slip-model --theta-deg 32 --sinkage-m 0.03 --radius-m 0.1",
    args_conflicts_with_subcommands = true
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    part: Option<Part>,
    /// The folder; it is made if it does not exist
    #[arg(short, long, value_name = "DIR", default_value = "paper")]
    output: PathBuf,
    /// Take the paper's robot from the analytical model to its decisions
    #[arg(long)]
    end_to_end: bool,
    #[command(flatten)]
    report: ReportFlag,
}

/// One part of the paper by itself.
#[derive(clap::Subcommand, Debug)]
enum Part {
    SlipModel(slip_model::Arguments),
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    if let Some(Part::SlipModel(arguments)) = &arguments.part {
        return slip_model::run(arguments, session);
    }
    let folder = &arguments.output;
    fs::create_dir_all(folder).map_err(|error| Error::file("make", folder, &error))?;
    if arguments.end_to_end {
        return end_to_end::run(folder, arguments.report.begin()?, session);
    }
    if arguments.report.is_given() {
        return Err(Error::usage(
            "`--report` needs `--end-to-end`",
            "without it the pages paper.html and paper.md are in the folder",
        ));
    }
    session.used_seed(SEED);
    let mut steps = Steps::new(folder, 2);
    let scenario = scenario(&steps, None)?;
    let run = sand_run(&mut steps, &scenario, session)?;
    files_in_use::clear();
    let progress = Progress::of_work("optima and figures");
    let paper = Paper::compute(&scenario, run)?;
    drop(progress);
    for file in paper.files() {
        write(folder, file)?;
    }
    let text = format!(
        "{}wrote {} files into {}; begin with paper.html\n",
        paper.text(),
        paper
            .files()
            .iter()
            .map(|file| file.names().len())
            .sum::<usize>(),
        shown_path(folder)
    );
    Ok(Report {
        outcome: steps.outcome(),
        warnings: steps.warnings(),
        ..Report::done(fields().object((folder, &paper)), text)
    })
}

fn write(folder: &Path, file: &PaperFile) -> Result<()> {
    match &file.content {
        Content::Figure(figure) => {
            for name in file.names() {
                figure_file::Target::create(&folder.join(name))?.write(figure)?;
            }
        }
        Content::Text(text) => {
            OutputFile::create(&folder.join(&file.name))?.write_whole(text.as_bytes())?;
        }
        _ => {}
    }
    Ok(())
}

fn fields<'a>() -> Fields<'a, (&'a PathBuf, &'a Paper)> {
    fields! { |written: (&'a PathBuf, &'a Paper)|
        "folder" "the folder" = written.0.display().to_string();
        join(Paper::fields()) = written.1;
    }
}

/// The JSON schemas.
pub(crate) fn schemas() -> [(&'static str, serde_json::Value); 2] {
    [
        (
            "paper",
            serde_json::json!({ "anyOf": [fields().schema(), end_to_end::schema()] }),
        ),
        ("paper slip-model", slip_model::schema()),
    ]
}
