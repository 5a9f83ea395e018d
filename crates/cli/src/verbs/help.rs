//! `help`: what a verb does, as text, as a man page, or the schema of its JSON object; the completions of a shell.

use clap_complete::Shell;
use serde_json::Value;

use crate::error::{Error, Result};
use crate::terminal;
use crate::verb_report::Report;
use grouser_report::Object;

#[derive(clap::Args, Debug)]
#[command(
    about = "Explain a verb: text, man page, or the JSON schema of its result; completions of a shell",
    after_help = "Examples:\n  grouser help wheel\n  grouser help log info --schema\n  grouser help estimate --man | man -l -\n  \
        grouser help --completions bash > ~/.local/share/bash-completion/completions/grouser"
)]
pub(crate) struct Arguments {
    /// The verb, such as `wheel` or `log info`; all of them when none is given
    #[arg(value_name = "VERB")]
    verb: Vec<String>,
    /// Print the JSON schema of what the verb prints under `--json`
    #[arg(long, conflicts_with = "man")]
    schema: bool,
    /// Print a man page
    #[arg(long)]
    man: bool,
    /// Print the completions of a shell
    #[arg(long, value_name = "SHELL", conflicts_with_all = ["verb", "schema", "man"])]
    completions: Option<Shell>,
}

/// Explains a verb of `command`; `schemas` are those of its verbs.
pub(crate) fn run(
    arguments: &Arguments,
    mut command: clap::Command,
    schemas: &[(&str, Value)],
) -> Result<Report> {
    if let Some(shell) = arguments.completions {
        let mut script = Vec::new();
        clap_complete::generate(shell, &mut command, "grouser", &mut script);
        return Ok(text_of(String::from_utf8_lossy(&script).into_owned()));
    }
    command.build();
    let mut of = &mut command;
    let path = arguments.verb.join(" ");
    for name in &arguments.verb {
        of = of.find_subcommand_mut(name).ok_or_else(|| {
            Error::usage(
                format!("unknown verb `{path}`"),
                "`grouser help` lists the verbs",
            )
        })?;
    }
    if arguments.schema {
        let schema = schemas
            .iter()
            .find(|(name, _)| *name == path)
            .ok_or_else(|| {
                let names: Vec<&str> = schemas.iter().map(|(name, _)| *name).collect();
                Error::usage(
                    format!("`{path}` has no JSON schema"),
                    format!("verbs with one are {}", names.join(", ")),
                )
            })?;
        return Ok(text_of(format!("{:#}\n", schema.1)));
    }
    if arguments.man {
        let mut page = Vec::new();
        // writing to memory cannot fail
        let _ = clap_mangen::Man::new(of.clone()).render(&mut page);
        return Ok(text_of(String::from_utf8_lossy(&page).into_owned()));
    }
    Ok(text_of(terminal::help(&of.render_long_help().to_string())))
}

fn text_of(text: String) -> Report {
    let object = Object::from_iter([("text".to_owned(), text.as_str().into())]);
    Report::file(object, text)
}
