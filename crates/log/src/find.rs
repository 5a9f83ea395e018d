//! The files of a run, by the paths of a command line.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::Result;

/// The files of a run: a file; or the files in a folder; or those whose names begin alike.
///
/// # Errors
/// What the system refuses.
pub fn run_files(path: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    expand(path, &mut found)?;
    Ok(found)
}

/// The files that a path of the command line means, by name.
pub(crate) fn expand(path: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    let file = || path.display().to_string();
    let unreadable = |source| grouser_files::Error::Unreadable {
        file: file(),
        source,
    };
    let mut inside = Vec::new();
    match fs::metadata(path) {
        Ok(kind) if kind.is_dir() => {
            for entry in fs::read_dir(path).map_err(unreadable)? {
                let entry = entry.map_err(unreadable)?.path();
                if entry.is_file() {
                    inside.push(entry);
                }
            }
        }
        Ok(_) => inside.push(path.to_path_buf()),
        Err(error) => {
            // Not there: perhaps the beginning of several names.
            let folder = match path.parent() {
                Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
                Some(parent) => parent,
                None => return Err(unreadable(error).into()),
            };
            let start = path.file_name().unwrap_or_default().to_string_lossy();
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                let name = entry.file_name();
                let own = name.to_string_lossy();
                if !start.is_empty() && own.starts_with(&*start) && entry.path().is_file() {
                    inside.push(entry.path());
                }
            }
            if inside.is_empty() {
                return Err(unreadable(error).into());
            }
        }
    }
    inside.sort();
    found.extend(inside);
    Ok(())
}
