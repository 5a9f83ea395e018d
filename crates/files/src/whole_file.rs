//! Writing files as a whole: a file has its name once it is complete, or keeps what it had.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::partial_file;

/// Links that are followed, as the system does.
const MAX_LINKS: u32 = 40;

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// What the system refuses.
    #[error(transparent)]
    System(#[from] io::Error),
    /// The path ends in no file name.
    #[error("it names no file")]
    NoName,
    /// A folder has the name.
    #[error("it is a directory")]
    Directory,
    /// A pipe that nobody reads would hang, and a disk would be overwritten.
    #[error("it is not a regular file")]
    NotRegular,
    /// The system would let an administrator replace it.
    #[error("it is read-only")]
    ReadOnly,
}

impl WriteError {
    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self, path: &Path) -> Option<String> {
        match self {
            Self::Directory => Some(format!(
                "give a file name in it, such as {}",
                path.join("out.csv").display()
            )),
            Self::ReadOnly => Some("make it writable, or give the output another name".to_owned()),
            _ => None,
        }
    }
}

impl From<WriteError> for io::Error {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::System(source) => source,
            WriteError::Directory => Self::new(io::ErrorKind::IsADirectory, error),
            WriteError::ReadOnly => Self::new(io::ErrorKind::PermissionDenied, error),
            WriteError::NoName | WriteError::NotRegular => {
                Self::new(io::ErrorKind::InvalidInput, error)
            }
        }
    }
}

/// A file that is being written. It is built in its folder under another name, synced to the disk and renamed by
/// [`WholeFile::finish`]; dropped before, it leaves what was there. Links are followed, and owner and mode are kept. A
/// terminal or `/dev/null` is written directly.
///
/// ```
/// use std::io::Write as _;
/// use grouser_files::WholeFile;
///
/// let path = std::env::temp_dir().join(format!("grouser-whole-{}.txt", std::process::id()));
/// let mut file = WholeFile::create(&path)?;
/// file.write_all(b"all of it")?;
/// assert!(!path.exists());
/// file.finish()?;
/// assert_eq!(std::fs::read(&path)?, b"all of it");
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct WholeFile {
    file: File,
    /// `None` for what cannot be renamed over (a terminal, `/dev/null`), and once it is finished.
    partial: Option<PathBuf>,
    target: PathBuf,
}

impl WholeFile {
    /// Begins the file `path`.
    ///
    /// # Errors
    /// [`WriteError`]; nothing is changed then.
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let target = followed(path)?;
        let found = match fs::metadata(&target) {
            Ok(found) => Some(found),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error.into()),
        };
        if let Some(found) = &found {
            if is_character_device(found) {
                return Ok(Self {
                    file: OpenOptions::new().write(true).open(&target)?,
                    partial: None,
                    target,
                });
            }
            check_replaceable(found)?;
            // the system's own reasons: another owner, a file that must not change
            OpenOptions::new().write(true).open(&target)?;
        } else if target.file_name().is_none() {
            return Err(WriteError::NoName);
        }
        let (file, partial) = partial_file::create(&target, found.as_ref())?;
        Ok(Self {
            file,
            partial: Some(partial),
            target,
        })
    }

    /// A second handle of the same file, for a thread that syncs it meanwhile; `None` for a device.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn try_clone(&self) -> io::Result<Option<File>> {
        let partial = self.partial.as_ref();
        partial.map(|_| self.file.try_clone()).transpose()
    }

    /// Where the file is written until it is finished; `None` for a device.
    #[must_use]
    pub fn partial(&self) -> Option<&Path> {
        self.partial.as_deref()
    }

    /// The file that it becomes, links followed.
    #[must_use]
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Writes what the system still holds to the disk: a full one may report it only here. Devices cannot be synced.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn sync(&self) -> io::Result<()> {
        self.partial
            .as_ref()
            .map_or(Ok(()), |_| self.file.sync_all())
    }

    /// Puts the complete file in its place.
    ///
    /// # Errors
    /// What the system refuses; what was there stays.
    pub fn finish(mut self) -> io::Result<()> {
        self.sync()?;
        let Some(partial) = &self.partial else {
            return Ok(());
        };
        // the file is closed, and unlocked, after it has its name
        fs::rename(partial, &self.target)?;
        self.partial = None;
        Ok(())
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for WholeFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if let Some(partial) = &self.partial {
            let _ = fs::remove_file(partial);
        }
    }
}

/// Writes all of a file: it has the content, or what was there stays.
///
/// # Errors
/// [`WriteError`].
pub fn write_whole(path: &Path, content: &[u8]) -> Result<(), WriteError> {
    let mut whole = WholeFile::create(path)?;
    whole.write_all(content)?;
    Ok(whole.finish()?)
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

/// Refuses what a rename would replace although it must stay.
fn check_replaceable(found: &fs::Metadata) -> Result<(), WriteError> {
    if found.is_dir() {
        return Err(WriteError::Directory);
    }
    if !found.is_file() {
        return Err(WriteError::NotRegular);
    }
    if found.permissions().readonly() {
        return Err(WriteError::ReadOnly);
    }
    Ok(())
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
