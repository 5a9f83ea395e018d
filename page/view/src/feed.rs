//! The parts of a run as they are found: written by one thread, read by any number of pages, none of which delays it.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use axum::body::Bytes;
use tokio::sync::watch;
use tokio::time::timeout;

/// Parts of a run that are kept, bytes: a day and a half of a robot of five wheels at 10 Hz. Older ones are let go.
const MAX_KEPT_BYTES: usize = 256 << 20;
/// Largest answer, bytes, unless one part is larger.
const MAX_ANSWER_BYTES: usize = 4 << 20;
/// How long a page waits for a part that is not there yet.
const MAX_WAIT: Duration = Duration::from_secs(5);

/// A run in parts.
///
/// ```
/// use grouser_view::feed::Feed;
///
/// let feed = Feed::new();
/// feed.add(b"part\0\0\0\0");
/// let answer = feed.from(0);
/// assert_eq!((answer.next, answer.lost, answer.parts.len()), (1, 0, 1));
/// ```
#[derive(Clone, Debug)]
pub struct Feed {
    kept: Arc<Mutex<Kept>>,
    count: watch::Sender<usize>,
}

/// Parts of a run for a page.
#[derive(Clone, Debug)]
pub struct PartsFrom {
    /// The number of the part to request next.
    pub next: usize,
    /// Parts that were let go.
    pub lost: usize,
    /// The parts, each after its length (u32, and four bytes of zero): shared, not copied.
    pub parts: Vec<Bytes>,
}

impl PartsFrom {
    /// The pieces of an answer: `next` and `lost` in u32, then the parts. Everything begins at a multiple of 8 bytes.
    pub fn pieces(self) -> impl Iterator<Item = Bytes> {
        let head: Vec<u8> = [number(self.next), number(self.lost)].concat();
        std::iter::once(Bytes::from(head)).chain(self.parts)
    }

    /// How long the answer is, bytes.
    #[must_use]
    pub fn length(&self) -> usize {
        8 + self.parts.iter().map(Bytes::len).sum::<usize>()
    }
}

#[derive(Debug, Default)]
struct Kept {
    parts: VecDeque<Bytes>,
    /// Parts that were let go.
    lost: usize,
    bytes: usize,
}

impl Default for Feed {
    fn default() -> Self {
        Self::new()
    }
}

impl Feed {
    /// A run without parts.
    #[must_use]
    pub fn new() -> Self {
        Self {
            kept: Arc::default(),
            count: watch::Sender::new(0),
        }
    }

    /// Adds a part. It waits for no reader.
    pub fn add(&self, part: &[u8]) {
        let framed: Vec<u8> = [&number(part.len())[..], &[0; 4], part].concat();
        let mut kept = self.lock();
        kept.bytes += framed.len();
        kept.parts.push_back(framed.into());
        // the first part has the wheels: it stays
        while kept.bytes > MAX_KEPT_BYTES && kept.parts.len() > 2 {
            if let Some(part) = kept.parts.remove(1) {
                kept.bytes -= part.len();
                kept.lost += 1;
            }
        }
        let count = kept.lost + kept.parts.len();
        drop(kept);
        self.count.send_replace(count);
    }

    /// The parts from number `next` on.
    #[must_use]
    pub fn from(&self, next: usize) -> PartsFrom {
        let kept = self.lock();
        let count = kept.lost + kept.parts.len();
        // the first part has number 0, the others follow those that were let go
        let first = if next == 0 {
            0
        } else {
            next.saturating_sub(kept.lost).max(1)
        };
        let mut length = 0;
        let parts: Vec<Bytes> = kept
            .parts
            .iter()
            .skip(first)
            .take_while(|part| {
                let is_first = length == 0;
                length += part.len();
                is_first || length <= MAX_ANSWER_BYTES
            })
            .cloned()
            .collect();
        let at = first.saturating_add(parts.len());
        let next = if at <= 1 {
            at
        } else {
            at.saturating_add(kept.lost)
        };
        PartsFrom {
            next: next.min(count),
            lost: kept.lost,
            parts,
        }
    }

    /// As [`Feed::from`]; waits a while for a part that is not there yet.
    pub async fn wait_from(&self, next: usize) -> PartsFrom {
        let mut count = self.count.subscribe();
        // an answer without parts after a while: the page requests again
        let _ = timeout(MAX_WAIT, count.wait_for(|count| *count > next)).await;
        self.from(next)
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        // a thread that panicked left whole parts behind
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Lengths and numbers of parts stay far below 2³².
fn number(value: usize) -> [u8; 4] {
    u32::try_from(value).unwrap_or(u32::MAX).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_parts_are_let_go_but_never_the_first() {
        let feed = Feed::new();
        feed.add(b"a");
        for name in b'b'..b'h' {
            feed.add(&vec![name; MAX_KEPT_BYTES / 4]);
        }
        let from = |next| {
            let answer = feed.from(next);
            let firsts: Vec<u8> = answer.parts.iter().map(|part| part[8]).collect();
            (answer.next, answer.lost, firsts)
        };
        // three of four quarters fit beside the first part
        assert_eq!(from(0), (1, 3, vec![b'a']));
        assert_eq!(from(1), (5, 3, vec![b'e']));
        assert_eq!(from(5), (6, 3, vec![b'f']));
        assert_eq!(from(6), (7, 3, vec![b'g']));
        assert_eq!(from(7), (7, 3, Vec::new()));
        assert_eq!(from(usize::MAX), (7, 3, Vec::new()));
    }

    #[test]
    fn an_answer_is_its_head_and_framed_parts() {
        let feed = Feed::new();
        feed.add(b"12345678");
        let answer = feed.from(0);
        assert_eq!(answer.length(), 24);
        let bytes: Vec<u8> = answer.pieces().flatten().collect();
        assert_eq!(bytes, b"\x01\0\0\0\0\0\0\0\x08\0\0\0\0\0\0\x0012345678");
    }
}
