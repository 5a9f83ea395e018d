//! Figures as files, by the ending of their name.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result, shown};
use crate::output::OutputFile;
use grouser_figure::Figure;

/// Fine enough for print.
const DOTS_PER_INCH: f64 = 300.0;

/// A file that a figure is drawn into. It is begun before the work, so that a path that cannot be written
/// is refused at once.
#[derive(Debug)]
pub(crate) struct Target {
    file: OutputFile,
    format: Format,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Svg,
    Png,
}

/// The ending of a file's name in lower case.
pub(crate) fn ending(path: &Path) -> Option<String> {
    path.extension()?.to_str().map(str::to_ascii_lowercase)
}

impl Target {
    /// Begins all figures.
    pub(crate) fn begin(paths: &[PathBuf]) -> Result<Vec<Self>> {
        paths.iter().map(|path| Self::create(path)).collect()
    }

    /// Begins the figure `path`.
    pub(crate) fn create(path: &Path) -> Result<Self> {
        let format = match ending(path).as_deref() {
            Some("svg") => Format::Svg,
            Some("png") => Format::Png,
            _ => {
                return Err(Error::usage(
                    format!("{} does not end in `.svg` or `.png`", shown(path)),
                    "the ending of a figure's name chooses its format",
                ));
            }
        };
        Ok(Self {
            file: OutputFile::create(path)?,
            format,
        })
    }

    /// Draws the figure and puts the file in its place; gives a line that says so.
    pub(crate) fn write(self, figure: &Figure) -> Result<String> {
        let bytes = match self.format {
            Format::Svg => figure.svg().into_bytes(),
            Format::Png => figure
                .png(DOTS_PER_INCH)
                .map_err(|error| Error::usage_without_hint(error.to_string()))?,
        };
        self.file.write_whole(&bytes)
    }
}
