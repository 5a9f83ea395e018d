//! Output files: written beside their place and renamed when complete.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result, shown};
use crate::interrupt;

/// A file that appears under its name only when [`OutputFile::finish`] is called; dropped before, or
/// interrupted, it leaves nothing.
#[derive(Debug)]
pub(crate) struct OutputFile {
    writer: Option<BufWriter<File>>,
    /// Where it is written; `None` for what cannot be renamed over (a terminal, `/dev/null`).
    beside: Option<PathBuf>,
    target: PathBuf,
}

impl OutputFile {
    /// Begins the file `path`.
    pub(crate) fn create(path: &Path) -> Result<Self> {
        let refuse = |error: io::Error| Error::file("write", path, &error);
        // A link stays a link: the file it points to is replaced.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        match fs::metadata(&target) {
            Ok(found) if found.is_dir() => Err(Error::refused_file(
                "write",
                path,
                "it is a directory",
                Some(format!(
                    "give a file name in it, such as {}",
                    shown(&path.join("out.csv"))
                )),
            )),
            Ok(found) if is_character_device(&found) => {
                let file = OpenOptions::new()
                    .write(true)
                    .open(&target)
                    .map_err(refuse)?;
                Ok(Self {
                    writer: Some(BufWriter::new(file)),
                    beside: None,
                    target,
                })
            }
            // A pipe nobody reads would hang, and a disk would be overwritten.
            Ok(found) if !found.is_file() => Err(Error::refused_file(
                "write",
                path,
                "it is not a regular file",
                None,
            )),
            _ => {
                let Some(name) = target.file_name() else {
                    return Err(Error::usage_without_hint(format!(
                        "{} names no file",
                        shown(path)
                    )));
                };
                let mut hidden = std::ffi::OsString::from(".");
                hidden.push(name);
                hidden.push(format!(".{}.partial", std::process::id()));
                let beside = target.with_file_name(hidden);
                let file = interrupt::begin(&beside, || {
                    OpenOptions::new()
                        .write(true)
                        .create_new(true)
                        .open(&beside)
                })
                .map_err(refuse)?;
                Ok(Self {
                    writer: Some(BufWriter::new(file)),
                    beside: Some(beside),
                    target,
                })
            }
        }
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
        Ok(self.beside.as_deref().unwrap_or(&self.target))
    }

    /// Puts the complete file in its place.
    pub(crate) fn finish(mut self) -> Result<()> {
        let written = self.close();
        let Some(beside) = self.beside.take() else {
            return written.map_err(|error| Error::file("write", &self.target, &error));
        };
        interrupt::finish(&beside, || {
            written
                .and_then(|()| fs::rename(&beside, &self.target))
                .map_err(|error| {
                    let _ = fs::remove_file(&beside);
                    Error::file("write", &self.target, &error)
                })
        })
    }

    fn close(&mut self) -> io::Result<()> {
        match self.writer.take() {
            Some(writer) => {
                let file = writer
                    .into_inner()
                    .map_err(io::IntoInnerError::into_error)?;
                // A disk that is full may say so only here; devices cannot be synced.
                if self.beside.is_some() {
                    file.sync_all()
                } else {
                    Ok(())
                }
            }
            None => Ok(()),
        }
    }

    /// Where the file will stand.
    pub(crate) fn path(&self) -> &Path {
        &self.target
    }
}

/// `/dev/null` or a terminal.
#[cfg(unix)]
fn is_character_device(found: &fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    found.file_type().is_char_device()
}

#[cfg(not(unix))]
fn is_character_device(_: &fs::Metadata) -> bool {
    false
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
        if let Some(beside) = self.beside.take() {
            // Dropped unfinished: what was buffered goes nowhere.
            interrupt::finish(&beside, || {
                if let Some(writer) = self.writer.take() {
                    drop(writer.into_parts());
                }
                let _ = fs::remove_file(&beside);
            });
        }
    }
}
