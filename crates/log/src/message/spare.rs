//! Values of messages that are done with, for the next of their channel.

use std::collections::BTreeMap;

use super::Value;

/// Only messages up to this size are kept, bytes: larger ones would keep their memory.
const SIZE: usize = 1 << 12;
/// Only for so many channels: a robot has fewer that matter, a hostile file may declare thousands.
const CHANNELS: usize = 64;

/// Is the value of a message of so many bytes worth keeping for the next of its channel?
pub(crate) const fn is_spare(channel: usize, size: usize) -> bool {
    size <= SIZE && channel < CHANNELS
}

/// One value for each channel, to decode into without allocating.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spare(BTreeMap<usize, Value>);

impl Spare {
    /// The one of a channel, or an empty one.
    pub(crate) fn take(&mut self, channel: usize) -> Value {
        self.0.remove(&channel).unwrap_or(Value::Null)
    }

    /// Keeps a value that was decoded from so many bytes.
    pub(crate) fn keep(&mut self, channel: usize, size: usize, value: Value) {
        if size <= SIZE && (self.0.len() < CHANNELS || self.0.contains_key(&channel)) {
            self.0.insert(channel, value);
        }
    }
}
