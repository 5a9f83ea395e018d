//! Half-written files: each has a random name in the folder of the file that it becomes, and is locked while its program
//! runs. One that is not locked was left by a program that was killed, and is removed by the next that writes the same
//! file.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher as _, DefaultHasher, Hasher as _, RandomState};
use std::io;
use std::path::{Path, PathBuf};

/// Names that are tried: each is one of 2^64, so that a second try is already unheard of.
const MAX_TRIES: u32 = 16;
const ENDING: &str = ".partial";
/// Elsewhere a locked file cannot be read by another handle, and some verbs read again what they wrote.
const CAN_LOCK: bool = cfg!(unix);

/// Creates the partial file of `target`; `keeps` is the file that is there already, whose owner and mode are kept.
pub(crate) fn create(target: &Path, keeps: Option<&fs::Metadata>) -> io::Result<(File, PathBuf)> {
    let name = target.file_name().unwrap_or_else(|| OsStr::new(""));
    // short, so that a name of any length has a partial file
    let mut digest = DefaultHasher::new();
    digest.write(name.as_encoded_bytes());
    let stem = format!(".grouser-{:016x}-", digest.finish());
    remove_stale(target, &stem);
    for _ in 0..MAX_TRIES {
        // each `RandomState` has other keys, the first of them from the system's random numbers
        let number = RandomState::new().build_hasher().finish();
        let path = target.with_file_name(format!("{stem}{number:016x}{ENDING}"));
        let file = match new_file(&path, keeps.is_some()) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
            created => created?,
        };
        // where files cannot be locked, nobody takes it for stale either
        if CAN_LOCK && file.try_lock().is_ok() && !is_there(&path) {
            continue; // taken for stale between creation and lock
        }
        if let Some(found) = keeps
            && let Err(error) = keep(&file, found)
        {
            let _ = fs::remove_file(&path);
            return Err(error);
        }
        return Ok((file, path));
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// A file that takes the place of another is not readable for all before it has the other's mode.
fn new_file(path: &Path, private: bool) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    if private {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.mode(0o600);
    }
    #[cfg(not(unix))]
    let _ = private;
    options.open(path)
}

fn keep(file: &File, found: &fs::Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt as _, fchown};
        let own = file.metadata()?;
        if (own.uid(), own.gid()) != (found.uid(), found.gid()) {
            // a user may not give files away; then the file is the writer's
            let _ = fchown(file, Some(found.uid()), Some(found.gid()));
        }
    }
    file.set_permissions(found.permissions())
}

fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// Removes what killed programs left of the same file.
fn remove_stale(target: &Path, stem: &str) {
    if !CAN_LOCK {
        return;
    }
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_ours = name
            .to_str()
            .is_some_and(|name| name.starts_with(stem) && name.ends_with(ENDING));
        if is_ours && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            let path = entry.path();
            // the lock goes with its program
            let free = File::open(&path).is_ok_and(|file| file.try_lock().is_ok());
            if free {
                let _ = fs::remove_file(&path);
            }
        }
    }
}
