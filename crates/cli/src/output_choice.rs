//! What `-o` names, by the ending: a table or a figure.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result, shown};
use crate::figure_file::{Target, ending};
use crate::output::OutputFile;

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
        paths.iter().map(|path| Self::of(path)).collect()
    }

    fn of(path: &Path) -> Result<Self> {
        match ending(path).as_deref() {
            Some("csv") => OutputFile::create(path).map(Self::Table),
            Some("svg" | "png") => Target::of(path).map(Self::Figure),
            _ => Err(Error::usage(
                format!("{} does not end in `.csv`, `.svg` or `.png`", shown(path)),
                "the ending of the output's name chooses its format",
            )),
        }
    }
}
