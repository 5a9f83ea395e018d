//! Where messages wait for the estimator.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::task::{Wake, Waker};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

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

impl Arrival {
    fn new(subscription: usize, publisher: PublisherId, received: Instant, bytes: Vec<u8>) -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let received_at = since.unwrap_or_default().saturating_sub(received.elapsed());
        Self {
            subscription,
            publisher,
            received,
            received_ns: u64::try_from(received_at.as_nanos()).unwrap_or(u64::MAX),
            bytes,
        }
    }
}

/// A message that a transport holds until it is fetched.
#[derive(Debug)]
pub struct Fetched {
    /// Who sent it.
    pub publisher: PublisherId,
    /// When it was sent, on the sender's clock in any unit: messages of several subscriptions are used in this order.
    pub sent: u64,
    /// The message.
    pub bytes: Vec<u8>,
}

/// A subscription whose messages the transport holds. They are fetched by the thread that uses them, so that no other thread
/// needs to wake for a message.
pub trait Source: Send {
    /// The next message. Where there is none, `waker` is to be woken once there is one.
    fn fetch(&mut self, waker: &Waker) -> Option<Fetched>;
}

enum Item {
    Arrival(Arrival),
    Begin(usize, Box<dyn Source>, Waker),
    /// A source has messages since then.
    Ready(Instant),
    End(usize),
}

/// The senders' end of the queue.
#[derive(Clone, Debug)]
pub struct Inbox {
    queue: SyncSender<Item>,
    dropped: Arc<AtomicU64>,
}

impl Inbox {
    /// Puts a message into the queue; a full queue drops it, and counts it.
    pub fn put(&self, subscription: usize, publisher: PublisherId, bytes: Vec<u8>) {
        let arrival = Arrival::new(subscription, publisher, Instant::now(), bytes);
        if self.queue.try_send(Item::Arrival(arrival)).is_err() {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Messages of a subscription are fetched from here, and no longer from the source before.
    pub fn begin(&self, subscription: usize, source: impl Source + 'static) {
        let bell = Waker::from(Arc::new(Bell(self.queue.clone())));
        // the queue holds no messages where there are sources: it is not full
        let _ = (self.queue).try_send(Item::Begin(subscription, Box::new(source), bell));
    }

    /// Nothing is fetched for a subscription any more.
    pub fn end(&self, subscription: usize) {
        let _ = self.queue.try_send(Item::End(subscription));
    }

    /// Messages that a full queue dropped.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }
}

/// Reports that a source has messages: once until they are fetched, so that the queue does not fill.
struct Bell(SyncSender<Item>);

impl Wake for Bell {
    fn wake(self: Arc<Self>) {
        let _ = self.0.try_send(Item::Ready(Instant::now()));
    }
}

/// The receiver's end of the queue.
pub struct Arrivals {
    queue: Receiver<Item>,
    sources: BTreeMap<usize, (Box<dyn Source>, Waker)>,
    /// With the time of sending of those that were fetched.
    arrived: VecDeque<(u64, Arrival)>,
}

impl Arrivals {
    /// The next message, waiting for it at most so long.
    ///
    /// # Errors
    /// As of [`Receiver::recv_timeout`].
    pub fn recv_timeout(&mut self, wait: Duration) -> Result<Arrival, RecvTimeoutError> {
        let end = Instant::now() + wait;
        loop {
            if let Some(arrival) = self.try_recv() {
                return Ok(arrival);
            }
            let left = end.saturating_duration_since(Instant::now());
            let item = self.queue.recv_timeout(left)?;
            self.enter(item);
        }
    }

    /// The next message, if there is one.
    pub fn try_recv(&mut self) -> Option<Arrival> {
        loop {
            if let Some((_, arrival)) = self.arrived.pop_front() {
                return Some(arrival);
            }
            let item = self.queue.try_recv().ok()?;
            self.enter(item);
        }
    }

    fn enter(&mut self, item: Item) {
        match item {
            Item::Arrival(arrival) => self.arrived.push_back((0, arrival)),
            Item::Begin(subscription, source, bell) => {
                self.sources.insert(subscription, (source, bell));
                self.fetch(Instant::now());
            }
            Item::Ready(since) => self.fetch(since),
            Item::End(subscription) => {
                self.sources.remove(&subscription);
            }
        }
    }

    /// Fetches from all sources: what was sent meanwhile to several of them is used in the order of sending.
    fn fetch(&mut self, since: Instant) {
        let mut before = usize::MAX;
        // until nothing is new: a source may have got a message before one that another source gave later
        while std::mem::replace(&mut before, self.arrived.len()) != self.arrived.len() {
            for (subscription, (source, bell)) in &mut self.sources {
                while let Some(fetched) = source.fetch(bell) {
                    let arrival =
                        Arrival::new(*subscription, fetched.publisher, since, fetched.bytes);
                    self.arrived.push_back((fetched.sent, arrival));
                }
            }
        }
        self.arrived
            .make_contiguous()
            .sort_by_key(|(sent, _)| *sent);
    }
}

/// A queue of messages.
#[must_use]
pub fn inbox() -> (Inbox, Arrivals) {
    let (queue, receiver) = sync_channel(MAX_WAITING);
    let inbox = Inbox {
        queue,
        dropped: Arc::default(),
    };
    let arrivals = Arrivals {
        queue: receiver,
        sources: BTreeMap::new(),
        arrived: VecDeque::new(),
    };
    (inbox, arrivals)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;
    use std::sync::Mutex;

    /// What waits, and who is to be woken.
    type Held = Arc<Mutex<(VecDeque<u64>, Option<Waker>)>>;

    struct Waiting(Held);

    impl Source for Waiting {
        fn fetch(&mut self, waker: &Waker) -> Option<Fetched> {
            let mut held = self.0.lock().unwrap();
            let sent = held.0.pop_front();
            if sent.is_none() {
                held.1 = Some(waker.clone());
            }
            sent.map(|sent| Fetched {
                publisher: [0; 16],
                sent,
                bytes: Vec::new(),
            })
        }
    }

    fn send(to: &Held, sent: &[u64]) {
        let mut held = to.lock().unwrap();
        held.0.extend(sent);
        if let Some(waker) = held.1.take() {
            waker.wake();
        }
    }

    #[test]
    fn what_several_sources_hold_comes_in_the_order_of_sending() {
        let (inbox, mut arrivals) = inbox();
        let [left, right] = [Held::default(), Held::default()];
        inbox.begin(0, Waiting(Arc::clone(&left)));
        inbox.begin(1, Waiting(Arc::clone(&right)));
        assert!(arrivals.try_recv().is_none());
        let mut next = || arrivals.try_recv().map(|arrival| arrival.subscription);
        send(&left, &[1, 4, 5]);
        send(&right, &[2, 3, 6]);
        let all: Vec<usize> = std::iter::from_fn(&mut next).collect();
        assert_eq!(all, [0, 1, 1, 0, 0, 1]);
        // each bell rings again
        send(&right, &[7]);
        assert_eq!((next(), next()), (Some(1), None));
        inbox.end(1);
        send(&right, &[8]);
        send(&left, &[9]);
        assert_eq!((next(), next()), (Some(0), None));
    }

    /// Fetched from, it lets a source that was asked before receive an earlier message.
    struct Later(Held, Option<u64>);

    impl Source for Later {
        fn fetch(&mut self, _: &Waker) -> Option<Fetched> {
            let sent = self.1.take()?;
            send(&self.0, &[sent - 1]);
            Some(Fetched {
                publisher: [0; 16],
                sent,
                bytes: Vec::new(),
            })
        }
    }

    #[test]
    fn a_source_that_was_asked_before_is_asked_again() {
        let (inbox, mut arrivals) = inbox();
        let held = Held::default();
        inbox.begin(0, Waiting(Arc::clone(&held)));
        inbox.begin(1, Later(held, Some(2)));
        let mut next = || arrivals.try_recv().map(|arrival| arrival.subscription);
        assert_eq!((next(), next(), next()), (Some(0), Some(1), None));
    }

    #[test]
    fn a_message_that_comes_while_it_is_waited_for_is_returned_at_once() {
        let (inbox, mut arrivals) = inbox();
        let held = Held::default();
        inbox.begin(0, Waiting(Arc::clone(&held)));
        let sender = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(30));
            send(&held, &[1]);
        });
        let begun = Instant::now();
        assert!(arrivals.recv_timeout(Duration::from_secs(20)).is_ok());
        assert!(begun.elapsed() < Duration::from_secs(10));
        sender.join().unwrap();
        let waited = arrivals.recv_timeout(Duration::from_millis(1));
        assert!(matches!(waited, Err(RecvTimeoutError::Timeout)));
    }
}
