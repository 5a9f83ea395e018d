//! The files that this run reads and writes, so that no result is written over its own input or over another result.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A file whatever its names: links, relative paths and hard links lead to the same.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Identity {
    /// Device and number on it.
    #[cfg(unix)]
    Node(u64, u64),
    #[cfg(not(unix))]
    Path(PathBuf),
}

#[derive(Debug, Default)]
struct Files {
    inputs: Vec<Identity>,
    outputs: Vec<PathBuf>,
}

static FILES: Mutex<Files> = Mutex::new(Files {
    inputs: Vec::new(),
    outputs: Vec::new(),
});

/// Why a file must not be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Conflict {
    /// It is read by this run.
    Input,
    /// It is another output of this run.
    Output,
}

/// A run begins: nothing is in use.
pub(crate) fn clear() {
    *files() = Files::default();
}

/// `path` is read.
pub(crate) fn reads(path: &Path) {
    if let Some(identity) = identity(path) {
        files().inputs.push(identity);
    }
}

/// `target` is going to be written, unless this run uses it otherwise.
pub(crate) fn begins(target: &Path) -> Result<(), Conflict> {
    let place = place(target);
    let mut files = files();
    if files.outputs.contains(&place) {
        return Err(Conflict::Output);
    }
    conflict(&files, target)?;
    files.outputs.push(place);
    Ok(())
}

/// `target` is complete and about to get its name: has this run read it since it began?
pub(crate) fn ends(target: &Path) -> Result<(), Conflict> {
    conflict(&files(), target)
}

/// `target` is not written after all.
pub(crate) fn gives_up(target: &Path) {
    let place = place(target);
    files().outputs.retain(|output| *output != place);
}

fn conflict(files: &Files, target: &Path) -> Result<(), Conflict> {
    match identity(target) {
        Some(identity) if files.inputs.contains(&identity) => Err(Conflict::Input),
        _ => Ok(()),
    }
}

/// The same for every relative name and folder link of a file that may not exist yet.
fn place(target: &Path) -> PathBuf {
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let whole = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    target
        .file_name()
        .map_or(whole.clone(), |name| whole.join(name))
}

#[cfg(unix)]
fn identity(path: &Path) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt as _;
    let found = fs::metadata(path).ok()?;
    found
        .is_file()
        .then(|| Identity::Node(found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> Option<Identity> {
    fs::canonicalize(path).ok().map(Identity::Path)
}

fn files() -> MutexGuard<'static, Files> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}
