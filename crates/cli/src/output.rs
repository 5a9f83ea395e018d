//! Output files: written beside their place and renamed when complete.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result, shown};
use crate::files_in_use::{self, Conflict};
use crate::{interrupt, partial_file};

/// Links that are followed, as the system does.
const MAX_LINKS: u32 = 40;

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
        let target = followed(path).map_err(refuse)?;
        let found = match fs::metadata(&target) {
            Ok(found) => Some(found),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(refuse(error)),
        };
        if let Some(found) = &found {
            if is_character_device(found) {
                return Self::to_device(target).map_err(refuse);
            }
            check_replaceable(found, path)?;
            // The system's own reasons: another owner, a file that must not change. Nothing is written.
            OpenOptions::new()
                .write(true)
                .open(&target)
                .map_err(refuse)?;
        } else if target.file_name().is_none() {
            return Err(Error::usage_without_hint(format!(
                "{} names no file",
                shown(path)
            )));
        }
        files_in_use::begins(&target).map_err(|conflict| in_use(conflict, path))?;
        match interrupt::begin(|| partial_file::create(&target, found.as_ref())) {
            Ok((file, beside)) => Ok(Self {
                writer: Some(BufWriter::new(file)),
                beside: Some(beside),
                target,
            }),
            Err(error) => {
                files_in_use::gives_up(&target);
                Err(refuse(error))
            }
        }
    }

    fn to_device(target: PathBuf) -> io::Result<Self> {
        let file = OpenOptions::new().write(true).open(&target)?;
        Ok(Self {
            writer: Some(BufWriter::new(file)),
            beside: None,
            target,
        })
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

    /// The same file for a thread that waits until the disk has what was written; `None` for a device, which cannot be
    /// synced.
    pub(crate) fn try_clone(&self) -> io::Result<Option<File>> {
        let file = self.writer.as_ref().filter(|_| self.beside.is_some());
        file.map(|writer| writer.get_ref().try_clone()).transpose()
    }

    /// Puts the complete file in its place.
    pub(crate) fn finish(mut self) -> Result<()> {
        let written = self.close();
        let Some(beside) = self.beside.take() else {
            return match written {
                Ok(_) => Ok(()),
                Err(error) => Err(Error::file("write", &self.target, &error)),
            };
        };
        interrupt::finish(&beside, || {
            let named = match (written, files_in_use::ends(&self.target)) {
                (Ok(_), Err(conflict)) => Err(in_use(conflict, &self.target)),
                // the file is closed, and unlocked, after it has its name
                (written, _) => written
                    .and_then(|_file| fs::rename(&beside, &self.target))
                    .map_err(|error| Error::file("write", &self.target, &error)),
            };
            if named.is_err() {
                let _ = fs::remove_file(&beside);
            }
            named
        })
    }

    /// Writes what is buffered; the file stays open, and with it its lock.
    fn close(&mut self) -> io::Result<Option<File>> {
        let Some(writer) = self.writer.take() else {
            return Ok(None);
        };
        let file = writer
            .into_inner()
            .map_err(io::IntoInnerError::into_error)?;
        // A disk that is full may say so only here; devices cannot be synced.
        if self.beside.is_some() {
            file.sync_all()?;
        }
        Ok(Some(file))
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

/// Where the links of `path` lead, also where nothing is there yet: a link stays a link.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::symlink_metadata(&target) {
            Ok(found) if found.file_type().is_symlink() => {
                let to = fs::read_link(&target)?;
                target = target.parent().unwrap_or(Path::new("")).join(to);
            }
            _ => return Ok(target),
        }
    }
    Err(io::Error::other("too many links lead from one to another"))
}

/// Refuses what a rename would replace without leave.
fn check_replaceable(found: &fs::Metadata, path: &Path) -> Result<()> {
    let refuse = |reason, hint| Err(Error::refused_file("write", path, reason, hint));
    if found.is_dir() {
        let example = shown(&path.join("out.csv"));
        return refuse(
            "it is a directory",
            Some(format!("give a file name in it, such as {example}")),
        );
    }
    // A pipe nobody reads would hang, and a disk would be overwritten.
    if !found.is_file() {
        return refuse("it is not a regular file", None);
    }
    // The system lets an administrator write it all the same.
    if found.permissions().readonly() {
        let hint = "make it writable, or give the output another name";
        return refuse("it is read-only", Some(hint.to_owned()));
    }
    Ok(())
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
            files_in_use::gives_up(&self.target);
        }
    }
}
