//! Output files: written beside their place and renamed when complete.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use grouser_files::{WholeFile, WriteError};

use crate::error::{Error, Result, shown};
use crate::files_in_use::{self, Conflict};
use crate::interrupt;

/// A file that appears under its name only when [`OutputFile::finish`] is called; dropped before, or
/// interrupted, it leaves what was there.
#[derive(Debug)]
pub(crate) struct OutputFile {
    /// `None` once it is finished.
    writer: Option<BufWriter<WholeFile>>,
    target: PathBuf,
}

impl OutputFile {
    /// Begins the file `path`.
    pub(crate) fn create(path: &Path) -> Result<Self> {
        let whole = interrupt::begin(|| WholeFile::create(path));
        let whole = whole.map_err(|error| refused(path, &error))?;
        let target = whole.target().to_owned();
        if let Some(partial) = whole.partial().map(Path::to_owned)
            && let Err(conflict) = files_in_use::begins(&target)
        {
            interrupt::finish(Some(&partial), || drop(whole));
            return Err(in_use(conflict, path));
        }
        Ok(Self {
            writer: Some(BufWriter::new(whole)),
            target,
        })
    }

    fn whole(&self) -> Option<&WholeFile> {
        self.writer.as_ref().map(BufWriter::get_ref)
    }

    /// Where it is written; `None` for a device.
    fn partial(&self) -> Option<&Path> {
        self.whole().and_then(WholeFile::partial)
    }

    /// Writes all of a file and puts it in its place; gives a line that says so.
    pub(crate) fn write_whole(mut self, content: &[u8]) -> Result<String> {
        self.write_all(content)
            .map_err(|error| Error::file("write", &self.target, &error))?;
        let line = format!("wrote {}\n", shown(&self.target));
        self.finish()?;
        Ok(line)
    }

    /// Writes what is buffered, and says where the file stands until it is finished.
    pub(crate) fn unfinished(&mut self) -> Result<&Path> {
        let flushed = self.flush();
        flushed.map_err(|error| Error::file("write", &self.target, &error))?;
        Ok(self.partial().unwrap_or(&self.target))
    }

    /// The same file for a thread that waits until the disk has what was written; `None` for a device, which cannot be
    /// synced.
    pub(crate) fn try_clone(&self) -> io::Result<Option<File>> {
        self.whole().map_or(Ok(None), WholeFile::try_clone)
    }

    /// Puts the complete file in its place.
    pub(crate) fn finish(mut self) -> Result<()> {
        let flushed = self.flush();
        let Some(writer) = self.writer.take() else {
            return Ok(());
        };
        let (whole, _) = writer.into_parts();
        // before signals are held back: a slow disk takes long
        let synced = flushed.and_then(|()| whole.sync());
        let partial = whole.partial().map(Path::to_owned);
        let failed = |error| Error::file("write", &self.target, &error);
        interrupt::finish(partial.as_deref(), || {
            synced.map_err(failed)?;
            if partial.is_some() {
                files_in_use::ends(&self.target)
                    .map_err(|conflict| in_use(conflict, &self.target))?;
            }
            whole.finish().map_err(failed)
        })
    }

    /// Where the file will stand.
    pub(crate) fn path(&self) -> &Path {
        &self.target
    }

    /// How this file names another one: from where it will stand, if the other lies in its folder or below, else in full.
    pub(crate) fn reaches(&self, other: &Path) -> PathBuf {
        let absolute = std::path::absolute(other).unwrap_or_else(|_| other.to_owned());
        let folder = self.target.parent();
        let folder = folder.and_then(|folder| std::path::absolute(folder).ok());
        let near = folder.and_then(|folder| Some(absolute.strip_prefix(folder).ok()?.to_owned()));
        near.unwrap_or(absolute)
    }
}

/// Why `path` is not written, with what to do about it.
fn refused(path: &Path, error: &WriteError) -> Error {
    match error {
        WriteError::System(error) => Error::file("write", path, error),
        WriteError::NoName => Error::usage_without_hint(format!("{} names no file", shown(path))),
        other => Error::refused_file("write", path, &other.to_string(), other.hint(path)),
    }
}

fn in_use(conflict: Conflict, path: &Path) -> Error {
    let (reason, hint) = match conflict {
        Conflict::Input => (
            "it is read by the same command",
            "give the output another name: the input stays as it is",
        ),
        Conflict::Output => (
            "it is another output of the same command",
            "give each output a different name",
        ),
    };
    Error::refused_file("write", path, reason, Some(hint.to_owned()))
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.writer {
            Some(writer) => writer.write(bytes),
            None => Err(io::ErrorKind::NotConnected.into()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Seek for OutputFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.writer {
            Some(writer) => writer.seek(to),
            None => Err(io::ErrorKind::NotConnected.into()),
        }
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        let Some(writer) = self.writer.take() else {
            return;
        };
        // what was buffered goes nowhere
        let (whole, _) = writer.into_parts();
        let partial = whole.partial().map(Path::to_owned);
        interrupt::finish(partial.as_deref(), || drop(whole));
        if partial.is_some() {
            files_in_use::gives_up(&self.target);
        }
    }
}
