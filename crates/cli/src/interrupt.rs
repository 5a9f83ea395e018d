//! Ctrl-C and SIGTERM: half-written files are removed, then the program ends; a search that keeps its best result so far
//! is ended by the first and the program by the second.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use grouser_files::{WholeFile, WriteError};

/// The files being written.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Does a search run that ends by itself when it is interrupted?
static SEARCHES: AtomicBool = AtomicBool::new(false);
/// Was it interrupted?
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// A search that watches [`Search::is_interrupted`] and then ends with what it has found.
#[derive(Debug)]
pub(crate) struct Search(());

impl Search {
    /// From now on the first signal is left to the search.
    pub(crate) fn begin() -> Self {
        INTERRUPTED.store(false, Ordering::SeqCst);
        SEARCHES.store(true, Ordering::SeqCst);
        Self(())
    }

    /// Has a signal come since it began?
    #[allow(
        clippy::unused_self,
        reason = "the question is about a search that runs"
    )]
    pub(crate) fn is_interrupted(&self) -> bool {
        INTERRUPTED.load(Ordering::SeqCst)
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        SEARCHES.store(false, Ordering::SeqCst);
    }
}

/// Handles the signals from now on. A second call changes nothing.
pub(crate) fn install() {
    #[cfg(unix)]
    meet_limits();
    // Without a handler the program still runs; a half-written file may then stay behind under its
    // temporary name.
    let _ = ctrlc::set_handler(|| {
        if SEARCHES.load(Ordering::SeqCst) && !INTERRUPTED.swap(true, Ordering::SeqCst) {
            return;
        }
        // The list stays locked until the end, so no file is finished or begun any more.
        let files = unfinished();
        for path in files.iter() {
            let _ = std::fs::remove_file(path);
        }
        std::process::exit(i32::from(crate::exit::INTERRUPTED));
    });
}

/// Limits of the system end the job as an error, not as a crash.
#[cfg(unix)]
fn meet_limits() {
    use std::sync::Arc;

    use signal_hook::consts::{SIGABRT, SIGXFSZ};
    use signal_hook::flag;

    // a write beyond the limit of a file's size (`ulimit -f`) then fails as one on a full disk does
    let _ = flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
    // without memory (`ulimit -v`) nothing is left to do but to end; the standard library has said why on standard error
    let always = Arc::new(AtomicBool::new(true));
    let _ = flag::register_conditional_shutdown(SIGABRT, i32::from(crate::exit::BAD_INPUT), always);
}

/// Runs `create`, and has the file that it began removed should the program be interrupted before [`finish`].
pub(crate) fn begin(
    create: impl FnOnce() -> Result<WholeFile, WriteError>,
) -> Result<WholeFile, WriteError> {
    let mut files = unfinished();
    let whole = create()?;
    files.extend(whole.partial().map(Path::to_owned));
    Ok(whole)
}

/// Runs `end`, which renames or removes the partial file, undisturbed by signals.
pub(crate) fn finish<T>(partial: Option<&Path>, end: impl FnOnce() -> T) -> T {
    let mut files = unfinished();
    files.retain(|other| Some(other.as_path()) != partial);
    end()
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}
