//! Values of messages that are done with, for the next of their channel.

use std::collections::BTreeMap;

use super::Value;

/// Maximum size of a message whose value is kept, bytes: larger ones would keep their memory.
const MAX_BYTES: usize = 1 << 12;
/// Maximum number of channels with a spare value: a hostile file may declare thousands.
const MAX_CHANNELS: usize = 64;

/// Is the value of a message of this size kept for the next of its channel?
pub(crate) const fn is_spare(channel: usize, size: usize) -> bool {
    size <= MAX_BYTES && channel < MAX_CHANNELS
}

/// One value for each channel, to decode into without allocating.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spare(BTreeMap<usize, Value>);

impl Spare {
    /// The one of a channel, or an empty one.
    pub(crate) fn take(&mut self, channel: usize) -> Value {
        self.0.remove(&channel).unwrap_or(Value::Null)
    }

    /// Keeps a value that was decoded from `size` bytes.
    pub(crate) fn keep(&mut self, channel: usize, size: usize, value: Value) {
        if size <= MAX_BYTES && (self.0.len() < MAX_CHANNELS || self.0.contains_key(&channel)) {
            self.0.insert(channel, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_values_of_few_channels_are_kept() {
        let kept =
            [(63, 4096), (64, 4096), (63, 4097)].map(|(channel, size)| is_spare(channel, size));
        assert_eq!(kept, [true, false, false]);
        let mut spare = Spare::default();
        assert_eq!(spare.take(5), Value::Null);
        for channel in 0..65 {
            spare.keep(channel, 4096, Value::UInt(1));
        }
        // the 65th has no room, a known one has
        spare.keep(7, 10, Value::UInt(2));
        spare.keep(8, 4097, Value::UInt(3));
        let taken = [64, 7, 8, 63].map(|channel| spare.take(channel));
        assert_eq!(
            taken,
            [Value::Null, Value::UInt(2), Value::UInt(1), Value::UInt(1)]
        );
        assert_eq!(spare.take(7), Value::Null);
    }
}
