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

/// Memory that a thread takes before it can report an error, with its stack: where the system grants less (`ulimit -v`), the
/// standard library ends the process as it starts the thread.
const ROOM_FOR_A_THREAD: usize = 4 << 20;

/// Does the system grant the memory that another thread takes?
pub(crate) fn has_room() -> bool {
    Vec::<u8>::new()
        .try_reserve_exact(ROOM_FOR_A_THREAD)
        .is_ok()
}

/// Threads that wait for their work, `requested` of them or as many as the system starts. One has begun before the next one
/// is started, so that the memory it took counts.
fn waiting_threads(requested: usize) -> Vec<Sender<ThreadBuilder>> {
    let start_one = |_| {
        let (send, receive) = channel::<ThreadBuilder>();
        let (begun, begins) = channel();
        let wait = move || {
            let _ = begun.send(());
            if let Ok(work) = receive.recv() {
                work.run();
            }
        };
        if !has_room() {
            return None;
        }
        thread::Builder::new().spawn(wait).ok()?;
        begins.recv().ok().map(|()| send)
    };
    (0..requested).map_while(start_one).collect()
}
