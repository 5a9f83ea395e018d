//! `init`: files to begin with.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::companion;
use crate::error::{Error, Result, shown};
use crate::output::OutputFile;
use crate::verb_report::Report;
use grouser_report::{Fields, fields};

#[derive(clap::Args, Debug)]
#[command(
    about = "Write a file to begin with: a robot, a scenario, a problem, a mission, a soil; or all examples",
    long_about = "Write a file to begin with: a robot, a scenario, a problem, a mission, a soil. Each works unchanged; the \
        scenario drives the robot of `robot.toml` next to it. `examples` lists the examples of the documentation, or copies \
        them into a new folder. A file that exists is not replaced.",
    after_help = "Examples:\n  grouser init robot -o robot.toml\n  grouser init scenario -o scenario.toml\n  \
        grouser drive scenario.toml\n  grouser init examples -o examples"
)]
pub(crate) struct Arguments {
    /// What to begin
    #[arg(value_name = "KIND")]
    kind: Kind,
    /// The new file, or folder of the examples; without it the text, or list, is printed
    #[arg(short, long, value_name = "FILE")]
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
    /// The examples of the documentation: logs, robots, scenarios, problems, terrain
    Examples,
}

impl Kind {
    /// The text of the file; the examples are files of their own.
    const fn text(self) -> Option<&'static str> {
        Some(match self {
            Self::Robot => include_str!("../../templates/robot.toml"),
            Self::Scenario => include_str!("../../templates/scenario.toml"),
            Self::Problem => include_str!("../../templates/problem.toml"),
            Self::Mission => include_str!("../../templates/mission.toml"),
            Self::Soil => include_str!("../../templates/soil.toml"),
            Self::Examples => return None,
        })
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<Report> {
    if let Some(path) = arguments.output.as_deref().filter(|path| path.exists()) {
        let hint = Some("give another name".to_owned());
        return Err(Error::refused_file("write", path, "it exists", hint));
    }
    let output = arguments.output.as_deref();
    let (text, said) = match (arguments.kind.text(), output) {
        (None, output) => examples(output)?,
        (Some(text), None) => (text.to_owned(), text.to_owned()),
        (Some(text), Some(path)) => {
            let said = OutputFile::create(path)?.write_whole(text.as_bytes())?;
            (text.to_owned(), said)
        }
    };
    Ok(Report::file(fields().object((&*text, arguments)), said))
}

/// The list of the examples, and what is printed; copies them into the new folder `to`.
fn examples(to: Option<&Path>) -> Result<(String, String)> {
    let from = companion::examples()?;
    let mut names = Vec::new();
    list(&from, Path::new(""), &mut names).map_err(|reason| Error::file("read", &from, &reason))?;
    names.sort();
    let lines = names.iter().map(|name| name.display().to_string());
    let list = lines.collect::<Vec<_>>().join("\n") + "\n";
    let Some(to) = to else {
        return Ok((list.clone(), list));
    };
    for name in &names {
        let (source, target) = (from.join(name), to.join(name));
        let content = fs::read(&source).map_err(|reason| Error::file("read", &source, &reason))?;
        if let Some(folder) = target.parent() {
            fs::create_dir_all(folder).map_err(|reason| Error::file("write", folder, &reason))?;
        }
        OutputFile::create(&target)?.write_whole(&content)?;
    }
    Ok((
        list,
        format!("wrote {} files to {}\n", names.len(), shown(to)),
    ))
}

/// Appends the names of all files in `root/folder`, from `root` on.
fn list(root: &Path, folder: &Path, names: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(root.join(folder))? {
        let entry = entry?;
        let name = folder.join(entry.file_name());
        if !entry.file_type()?.is_dir() {
            names.push(name);
        } else if !name.ends_with("__pycache__") {
            // which pip adds
            list(root, &name, names)?;
        }
    }
    Ok(())
}

fn fields<'a>() -> Fields<'a, (&'a str, &'a Arguments)> {
    fields! { |made: (&'a str, &'a Arguments)|
        "text" "text of the file, or the list of the examples" = made.0;
        "output" "the file or folder that was written" = made.1.output.as_ref().map(|path| path.display().to_string());
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    fields().schema()
}
