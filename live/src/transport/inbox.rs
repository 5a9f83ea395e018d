//! Where messages wait for the estimator.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Messages that wait at most: half a second of ten sensors at 1 kHz.
const MAX_WAITING: usize = 5_000;

/// Which publisher sent a message.
pub type PublisherId = [u8; 16];

/// A message that arrived.
#[derive(Clone, Debug)]
pub struct Arrival {
    /// The subscription.
    pub subscription: usize,
    /// Who sent it.
    pub publisher: PublisherId,
    /// When it arrived.
    pub received: Instant,
    /// The same by the system's clock, ns.
    pub received_ns: u64,
    /// The message.
    pub bytes: Vec<u8>,
}

/// The senders' end of the queue.
#[derive(Clone, Debug)]
pub struct Inbox {
    queue: SyncSender<Arrival>,
    dropped: Arc<AtomicU64>,
}

impl Inbox {
    /// Puts a message into the queue; a full queue drops it, and counts it.
    pub fn put(&self, subscription: usize, publisher: PublisherId, bytes: Vec<u8>) {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let arrival = Arrival {
            subscription,
            publisher,
            received: Instant::now(),
            received_ns: since.map_or(0, |since| {
                u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
            }),
            bytes,
        };
        if self.queue.try_send(arrival).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Messages that a full queue dropped.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }
}

/// A queue of messages.
#[must_use]
pub fn inbox() -> (Inbox, Receiver<Arrival>) {
    let (queue, receiver) = sync_channel(MAX_WAITING);
    let inbox = Inbox {
        queue,
        dropped: Arc::default(),
    };
    (inbox, receiver)
}
