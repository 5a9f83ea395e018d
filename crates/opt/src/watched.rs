//! Many solves on all cores, whose caller hears of them on its own thread and may stop them.

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, TryRecvError, channel};
use std::sync::{Mutex, PoisonError};

use crate::callback::{Callback, Progress, Stage};

/// An iteration of one of the solves.
struct News {
    iteration: usize,
    x: Vec<f64>,
    utility: f64,
    violation: f64,
    stationarity: Option<f64>,
}

/// What `job` makes of each of `items`, in their order, and whether the caller stopped it; then what had not begun is
/// `None`. `stage` names the stage by how many items are done.
///
/// The callback runs on the calling thread, wherever that is: a thread of the pool goes on with the pool's work while it
/// waits, since it may be the only one.
pub(crate) fn watched<T: Sync, R: Send>(
    items: &[T],
    stage: impl Fn(usize) -> Stage,
    callback: &mut Callback<'_>,
    job: impl Fn(&T, &mut Callback<'_>) -> R + Sync,
) -> (Vec<Option<R>>, bool) {
    let results: Vec<Mutex<Option<R>>> = items.iter().map(|_| Mutex::new(None)).collect();
    let (stop, done) = (AtomicBool::new(false), AtomicUsize::new(0));
    let (send, receive) = channel();
    let run = |item: &T, slot: &Mutex<Option<R>>, send: &Sender<News>| {
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let mut own = |progress: &Progress<'_>| {
            // the caller's end is open until every job is done
            let _ = send.send(News {
                iteration: progress.iteration,
                x: progress.x.to_vec(),
                utility: progress.utility,
                violation: progress.violation,
                stationarity: progress.stationarity,
            });
            if stop.load(Ordering::Relaxed) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let result = job(item, &mut own);
        *slot.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        done.fetch_add(1, Ordering::Relaxed);
    };
    // the pool begins with its first use; where no thread can be started (WebAssembly), this one becomes its only one
    let _ = rayon::current_num_threads();
    let in_pool = rayon::current_thread_index().is_some();
    rayon::in_place_scope(|scope| {
        for (item, slot) in items.iter().zip(&results) {
            let (send, run) = (send.clone(), &run);
            scope.spawn(move |_| run(item, slot, &send));
        }
        drop(send);
        loop {
            let news = if in_pool {
                receive.try_recv()
            } else {
                receive.recv().map_err(|_| TryRecvError::Disconnected)
            };
            match news {
                Ok(news) => {
                    let progress = Progress {
                        stage: stage(done.load(Ordering::Relaxed)),
                        iteration: news.iteration,
                        x: &news.x,
                        utility: news.utility,
                        violation: news.violation,
                        stationarity: news.stationarity,
                    };
                    if !stop.load(Ordering::Relaxed) && callback(&progress).is_break() {
                        stop.store(true, Ordering::Relaxed);
                    }
                }
                Err(TryRecvError::Disconnected) => break,
                Err(TryRecvError::Empty) => {
                    if rayon::yield_now() != Some(rayon::Yield::Executed) {
                        std::thread::yield_now();
                    }
                }
            }
        }
    });
    let results = results
        .into_iter()
        .map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner));
    (results.collect(), stop.into_inner())
}
