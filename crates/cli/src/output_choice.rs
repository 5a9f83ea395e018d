//! What `-o` names, by the ending: a table or a figure.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result, shown};
use crate::figure_file::{Target, ending};
use crate::output::OutputFile;
use grouser_figure::Figure;

/// A file that has been begun.
pub(crate) enum Output {
    /// `.csv`
    Table(OutputFile),
    /// `.svg` or `.png`
    Figure(Target),
}

impl Output {
    /// Begins all files, so that a path that cannot be written is refused before the work.
    pub(crate) fn begin(paths: &[PathBuf]) -> Result<Vec<Self>> {
        paths.iter().map(|path| Self::create(path)).collect()
    }

    /// Writes all files; gives the lines that say so.
    pub(crate) fn write_all(
        outputs: Vec<Self>,
        table: impl Fn() -> String,
        figure: impl Fn() -> Result<Figure>,
    ) -> Result<String> {
        let written = outputs.into_iter().map(|output| match output {
            Self::Table(file) => file.write_whole(table().as_bytes()),
            Self::Figure(target) => target.write(&figure()?),
        });
        written.collect()
    }

    fn create(path: &Path) -> Result<Self> {
        match ending(path).as_deref() {
            Some("csv") => OutputFile::create(path).map(Self::Table),
            Some("svg" | "png") => Target::create(path).map(Self::Figure),
            _ => Err(Error::usage(
                format!("{} does not end in `.csv`, `.svg` or `.png`", shown(path)),
                "the ending of the output's name chooses its format",
            )),
        }
    }
}
