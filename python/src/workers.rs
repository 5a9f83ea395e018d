//! Threads of one call. They end with the call, so that a forked process never waits for threads that it
//! does not have, as it would with a global pool.

use std::num::NonZero;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Fewest points for which another thread is started: 16 384 solves take about 5 ms, a thread 0.05 ms.
const POINTS_PER_THREAD: usize = 16_384;

/// Points of a thread between two looks at signals: 4 ms of work on lanes, and 3 s where all points brake,
/// which take 160 µs each (bench/RESULTS.md).
pub(crate) const POINTS_PER_BLOCK: usize = 1 << 14;

/// The number of threads for `points`: as many as `wanted` (0: as many as the machine runs), at most one
/// for each 16 384 points.
pub(crate) fn count(wanted: usize, points: usize) -> usize {
    at_most(wanted, points.div_ceil(POINTS_PER_THREAD))
}

/// The number of threads for `jobs` long jobs: as many as `wanted` (0: as many as the machine runs).
pub(crate) fn at_most(wanted: usize, jobs: usize) -> usize {
    let most = if wanted == 0 {
        std::thread::available_parallelism().map_or(1, NonZero::get)
    } else {
        wanted
    };
    most.min(jobs).max(1)
}

/// Runs every job of `jobs` on a thread of its own (a single one on this thread), without the interpreter.
pub(crate) fn run<J: FnOnce() -> T + Send, T: Send>(py: Python<'_>, jobs: Vec<J>) -> Vec<T> {
    py.detach(|| {
        if jobs.len() == 1 {
            return jobs.into_iter().map(|job| job()).collect();
        }
        std::thread::scope(|scope| {
            let threads: Vec<_> = jobs.into_iter().map(|job| scope.spawn(job)).collect();
            threads
                .into_iter()
                .map(|thread| match thread.join() {
                    Ok(result) => result,
                    Err(panic) => std::panic::resume_unwind(panic),
                })
                .collect()
        })
    })
}

/// How often a waiting interpreter looks at signals.
const SIGNAL_PERIOD: Duration = Duration::from_millis(50);

/// Runs `job` on a thread with a pool of `threads` (0: as many as the machine runs), while this thread
/// waits without the interpreter and looks at signals. On a signal `stop` is called, the exception is
/// returned at once, and the job ends on its own.
pub(crate) fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    job: impl FnOnce() -> T + Send + 'static,
    stop: impl FnOnce(),
) -> PyResult<T> {
    let (sender, mut receiver) = mpsc::sync_channel(1);
    let failed = |error: &dyn std::fmt::Display| {
        PyRuntimeError::new_err(format!("threads cannot be started: {error}"))
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| failed(&error))?;
    let thread = std::thread::Builder::new()
        .spawn(move || {
            // a receiver that is gone was interrupted
            let _ = sender.send(pool.install(job));
        })
        .map_err(|error| failed(&error))?;
    loop {
        let (same, received) = py.detach(move || {
            let received = receiver.recv_timeout(SIGNAL_PERIOD);
            (receiver, received)
        });
        receiver = same;
        match received {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(error) = py.check_signals() {
                    stop();
                    return Err(error);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                return match thread.join() {
                    Err(panic) => std::panic::resume_unwind(panic),
                    Ok(()) => Err(PyRuntimeError::new_err("a thread ended without a result")),
                };
            }
        }
    }
}
