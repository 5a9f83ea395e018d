//! How long a thread computes, which a loaded machine does not stretch.

use std::time::{Duration, Instant};

/// A moment of this thread; of the wall's clock where the system does not count a thread's time.
#[derive(Clone, Copy)]
pub(crate) struct ThreadTime {
    begun: Instant,
    computed: Option<Duration>,
}

impl ThreadTime {
    pub(crate) fn now() -> Self {
        Self {
            begun: Instant::now(),
            computed: computed(),
        }
    }

    /// What the thread computed since then.
    pub(crate) fn elapsed(self) -> Duration {
        match (self.computed, computed()) {
            (Some(before), Some(now)) => now.saturating_sub(before),
            _ => self.begun.elapsed(),
        }
    }
}

fn computed() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split(' ').next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}
