//! The pool of threads that loops share, with as many threads as the system grants.

use std::io;
use std::num::NonZero;
use std::sync::mpsc::{Sender, channel};
use std::thread;

use rayon::{ThreadBuilder, ThreadPoolBuilder};

/// Starts the pool. Where the system grants fewer threads than there are processors (`ulimit -u`, `ulimit -v`), the
/// calling thread is one of the pool, if need be the only one: the loops take longer and their results are the same.
///
/// Left to itself, the pool panics at its first use if one of its threads cannot be started.
pub(crate) fn start() {
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    let chosen = std::env::var("RAYON_NUM_THREADS").ok();
    let requested = match chosen.and_then(|text| text.parse().ok()) {
        None | Some(0) => processors,
        Some(count) => count,
    };
    let threads = waiting_threads(requested);
    let builder = if threads.len() < requested {
        ThreadPoolBuilder::new()
            .num_threads(threads.len() + 1)
            .use_current_thread()
    } else {
        ThreadPoolBuilder::new().num_threads(requested)
    };
    let mut threads = threads.into_iter();
    let hand_over = move |work: ThreadBuilder| {
        let thread = threads.next().ok_or(io::ErrorKind::WouldBlock)?;
        thread
            .send(work)
            .map_err(|_| io::ErrorKind::BrokenPipe.into())
    };
    // a launcher that runs the command twice has the pool already
    let _ = builder.spawn_handler(hand_over).build_global();
}

/// Threads that wait for their work, `requested` of them or as many as the system starts.
fn waiting_threads(requested: usize) -> Vec<Sender<ThreadBuilder>> {
    let start_one = |_| {
        let (send, receive) = channel::<ThreadBuilder>();
        let wait = move || {
            if let Ok(work) = receive.recv() {
                work.run();
            }
        };
        thread::Builder::new().spawn(wait).ok().map(|_| send)
    };
    (0..requested).map_while(start_one).collect()
}
