//! `grouser-view`: the page from a local server, or as one HTML file.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use grouser_view::pack;

/// Opens the page of Grouser: wheels on soil, and recorded runs.
#[derive(Parser, Debug)]
#[command(name = "grouser-view", version)]
struct Arguments {
    /// Write the page as one HTML file instead of serving it; it opens without a server
    #[arg(long, value_name = "F.html")]
    export: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> grouser_view::Result<()> {
    if let Some(path) = &arguments.export {
        let html = pack::page(None)?;
        std::fs::write(path, html).map_err(|source| grouser_view::Error::File {
            path: path.clone(),
            source,
        })?;
    }
    Ok(())
}
