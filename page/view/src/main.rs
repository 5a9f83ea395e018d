//! `grouser-view`: the page from a local server, or as one HTML file.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use grouser_view::assets;
use grouser_view::run::RecordedRun;
use grouser_view::server::{Running, Server, Shown};
use grouser_view::{Error, Result};

/// Largest file that is put into a page or shown, bytes.
const MAX_FILE_BYTES: u64 = 64 << 20;

/// Opens the page of Grouser: a wheel on soil to explore, a run to look at.
#[derive(Parser, Debug)]
#[command(name = "grouser-view", version)]
struct Arguments {
    /// A run to open: the table of `grouser estimate -o`; or, with `--robot`, a log or the folder of a split recording
    file: Option<PathBuf>,
    /// The robot of the log: the server estimates, so that a log of any size opens
    #[arg(
        long,
        value_name = "R.toml",
        requires = "file",
        conflicts_with = "export"
    )]
    robot: Option<PathBuf>,
    /// The column map of a CSV log [default: the robot file's, or `columns.toml` beside it]
    #[arg(long, value_name = "C.toml", requires = "robot")]
    map: Option<PathBuf>,
    /// The log (a table, MCAP or a bag) is still written: the page shows its newest moment. Of a recording in numbered
    /// files (`run_0.mcap`, `run_1.mcap`) or of its folder, the files that follow are read too
    #[arg(long, requires = "robot")]
    follow: bool,
    /// Write the page, with the run in it, as one HTML file instead of serving it; it opens without a server
    #[arg(long, value_name = "F.html")]
    export: Option<PathBuf>,
    /// Port to listen on, on this machine only; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<()> {
    let run = match (&arguments.file, &arguments.robot) {
        (Some(log), Some(robot)) => Some(RecordedRun::open(
            log,
            robot,
            arguments.map.as_deref(),
            arguments.follow,
        )?),
        _ => None,
    };
    let file = arguments.file.as_deref().filter(|_| run.is_none());
    let shown = file.map(read).transpose()?;
    if let Some(path) = &arguments.export {
        if let (Some(file), Some(shown)) = (file, &shown)
            && !shown.is_of_page()
        {
            return Err(Error::NoRun {
                path: file.to_owned(),
            });
        }
        let file = shown
            .as_ref()
            .map(|shown| (shown.name.as_str(), shown.bytes.as_slice()));
        return grouser_files::write_whole(path, assets::page(file).html()?.as_bytes())
            .map_err(|error| file_error(path, error.into()));
    }
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let served = runtime.and_then(|runtime| {
        runtime.block_on(async {
            let mut server = Server::listen(arguments.port, shown).await?;
            if let Some(run) = run {
                let is_live = run.is_live();
                let feed = run.start();
                server = server.with_run(Running { feed, is_live });
            }
            let mut out = std::io::stdout();
            writeln!(
                out,
                "open {} (it works once; end with Ctrl-C)",
                server.address()
            )?;
            out.flush()?;
            tokio::select! {
                ended = server.serve() => ended,
                _ = tokio::signal::ctrl_c() => Ok(()),
            }
        })
    });
    served.map_err(|source| Error::Server { source })
}

/// A file of at most [`MAX_FILE_BYTES`], by its own length and by what is read.
fn read(path: &Path) -> Result<Shown> {
    let mut bytes = Vec::new();
    // before it is opened: a pipe would wait for its writer
    let about = std::fs::metadata(path).map_err(|source| file_error(path, source))?;
    let file = File::open(path).map_err(|source| file_error(path, source))?;
    if !about.is_file() {
        let what = if about.is_dir() {
            "it is a folder: the log in it needs --robot R.toml"
        } else {
            "it is no file"
        };
        return Err(file_error(path, std::io::Error::other(what)));
    }
    file.take(MAX_FILE_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|source| file_error(path, source))?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(Error::TooLarge {
            path: path.to_owned(),
            bytes: about.len(),
            limit: MAX_FILE_BYTES,
        });
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok(Shown {
        name: name.into_owned(),
        bytes,
    })
}

fn file_error(path: &Path, source: std::io::Error) -> Error {
    Error::File {
        path: path.to_owned(),
        source,
    }
}
