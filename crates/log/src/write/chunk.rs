//! When a chunk is closed.

/// A chunk is closed when it holds this many bytes: the size of others' writers.
const BYTES: usize = 1 << 20;
/// A chunk is closed when it spans this time, ns: what a robot loses of its log when its power fails.
const SPAN_NS: u64 = 1_000_000_000;

/// The time of an open chunk.
///
/// It counts from the newest message before the chunk to the newest in it: topics whose clocks differ do
/// not close a chunk with every message.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Age {
    newest_ns: u64,
    begin_ns: Option<u64>,
}

impl Age {
    /// Is a chunk of this size to be closed before another message?
    pub(super) fn is_full(&mut self, time_ns: u64, bytes: usize) -> bool {
        self.newest_ns = self.newest_ns.max(time_ns);
        let begin_ns = *self.begin_ns.get_or_insert(self.newest_ns);
        let full = bytes >= BYTES || self.newest_ns - begin_ns >= SPAN_NS;
        if full {
            self.begin_ns = Some(self.newest_ns);
        }
        full
    }
}
