//! `init`: files to begin with.

use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::output::OutputFile;
use crate::verb_report::Report;
use grouser_report::{Fields, fields};

#[derive(clap::Args, Debug)]
#[command(
    about = "Write a file to begin with: a robot, a scenario, a problem, a mission, a soil",
    long_about = "Write a file to begin with: a robot, a scenario, a problem, a mission, a soil. Each works as it stands; the \
        scenario drives the robot of `robot.toml` beside it. A file that exists is not replaced.",
    after_help = "Examples:\n  grouser init robot -o robot.toml\n  grouser init scenario -o scenario.toml\n  \
        grouser drive scenario.toml"
)]
pub(crate) struct Arguments {
    /// What to begin
    #[arg(value_name = "KIND")]
    kind: Kind,
    /// The new file; without it the text is printed
    #[arg(short, long, value_name = "FILE.toml")]
    output: Option<PathBuf>,
}

/// A kind of file.
#[derive(clap::ValueEnum, Clone, Copy, Debug)]
enum Kind {
    /// A robot: wheels, masses, motors, sensors
    Robot,
    /// A drive over soft ground
    Scenario,
    /// A wheel to be optimised
    Problem,
    /// Slopes and soils for which a wheel is designed
    Mission,
    /// A soil
    Soil,
}

impl Kind {
    const fn text(self) -> &'static str {
        match self {
            Self::Robot => include_str!("../../templates/robot.toml"),
            Self::Scenario => include_str!("../../templates/scenario.toml"),
            Self::Problem => include_str!("../../templates/problem.toml"),
            Self::Mission => include_str!("../../templates/mission.toml"),
            Self::Soil => include_str!("../../templates/soil.toml"),
        }
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Report> {
    let text = arguments.kind.text();
    let mut said = text.to_owned();
    if let Some(path) = &arguments.output {
        if path.exists() {
            let hint = Some("give another name".to_owned());
            return Err(Error::refused_file("write", path, "it exists", hint));
        }
        said = OutputFile::create(path)?.write_whole(text.as_bytes())?;
    }
    Ok(Report::done(fields().object((text, arguments)), said))
}

fn fields<'a>() -> Fields<'a, (&'a str, &'a Arguments)> {
    fields! { |made: (&'a str, &'a Arguments)|
        "text" "text of the file" = made.0;
        "output" "the file that was written" = made.1.output.as_ref().map(|path| path.display().to_string());
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    fields().schema()
}
