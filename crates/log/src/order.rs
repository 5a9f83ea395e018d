//! Putting rows and messages into the order of time with a bounded look-ahead.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Holds the newest rows back until `look_ahead` others have come, and gives records out by time;
/// records of equal time keep their order.
pub(crate) struct Ordered<T> {
    look_ahead: usize,
    heap: BinaryHeap<Reverse<Held<T>>>,
    rows: BinaryHeap<Reverse<i64>>,
    sequence: u64,
    given_ns: Option<i64>,
}

struct Held<T> {
    key: (i64, u64),
    held: T,
}

impl<T> PartialEq for Held<T> {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl<T> Eq for Held<T> {}

impl<T> PartialOrd for Held<T> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Held<T> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.key.cmp(&other.key)
    }
}

impl<T> Ordered<T> {
    pub(crate) fn new(look_ahead: usize) -> Self {
        Self {
            look_ahead,
            heap: BinaryHeap::new(),
            rows: BinaryHeap::new(),
            sequence: 0,
            given_ns: None,
        }
    }

    /// Announces a row. Its age in seconds if newer ones have already been given out.
    pub(crate) fn begin_row(&mut self, time_ns: i64) -> Result<(), f64> {
        if let Some(given) = self.given_ns
            && time_ns < given
        {
            return Err(given.saturating_sub(time_ns) as f64 * 1e-9);
        }
        self.rows.push(Reverse(time_ns));
        // Rows without a record must not pile up.
        if self.heap.is_empty() && self.rows.len() > self.look_ahead {
            self.rows.pop();
        }
        Ok(())
    }

    pub(crate) fn push(&mut self, time_ns: i64, held: T) {
        self.heap.push(Reverse(Held {
            key: (time_ns, self.sequence),
            held,
        }));
        self.sequence += 1;
    }

    /// Are enough rows held that the first record may go?
    pub(crate) fn is_ripe(&self) -> bool {
        self.rows.len() > self.look_ahead && !self.heap.is_empty()
    }

    /// The earliest, with its time.
    pub(crate) fn pop(&mut self) -> Option<(i64, T)> {
        let Reverse(Held {
            key: (time_ns, _),
            held,
        }) = self.heap.pop()?;
        self.given_ns = Some(time_ns);
        let next_is_later = self
            .heap
            .peek()
            .is_none_or(|Reverse(next)| next.key.0 > time_ns);
        while next_is_later && self.rows.peek().is_some_and(|Reverse(row)| *row <= time_ns) {
            self.rows.pop();
        }
        Some((time_ns, held))
    }

    pub(crate) fn clear(&mut self) {
        self.heap.clear();
        self.rows.clear();
    }
}
