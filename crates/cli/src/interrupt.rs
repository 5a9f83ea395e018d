//! Ctrl-C and SIGTERM: half-written files are removed, then the program ends.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The files being written.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// What a shell reports of a program ended by Ctrl-C.
const EXIT_INTERRUPTED: i32 = 130;

/// Handles the signals from now on. A second call changes nothing.
pub(crate) fn install() {
    // Without a handler the program still runs; a half-written file may then stay behind under its
    // temporary name.
    let _ = ctrlc::set_handler(|| {
        // The list stays locked until the end, so no file is finished or begun any more.
        let files = unfinished();
        for path in files.iter() {
            let _ = std::fs::remove_file(path);
        }
        std::process::exit(EXIT_INTERRUPTED);
    });
}

/// Runs `create` and has `path` removed should the program be interrupted before [`finish`].
pub(crate) fn begin<T>(
    path: &Path,
    create: impl FnOnce() -> std::io::Result<T>,
) -> std::io::Result<T> {
    let mut files = unfinished();
    let made = create()?;
    files.push(path.to_owned());
    Ok(made)
}

/// Runs `end`, which renames or removes `path`, undisturbed by signals.
pub(crate) fn finish<T>(path: &Path, end: impl FnOnce() -> T) -> T {
    let mut files = unfinished();
    files.retain(|other| other != path);
    end()
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}
