//! The samples of one bag or MCAP file.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use grouser_slip::Sample;

use super::Recording;
use super::intake::Intake;
use crate::container::{Container, Event};
use crate::error::Result;
use crate::source::Source;

/// How long samples of a file that is still written are held back, to be put into the order of time: senders stamp a
/// message up to this long before they send it.
const GROWING_HOLD: Duration = Duration::from_millis(500);

/// Samples of one file in the order of time.
pub(crate) struct RecordingReader {
    container: Container,
    intake: Intake,
    /// The intake's numbers of the container's channels.
    channels: BTreeMap<usize, Option<usize>>,
    recording: Recording,
    read: Arc<AtomicU64>,
    counted: u64,
    done: bool,
}

impl RecordingReader {
    /// Opens a file. `shifts_ns` is added to the times of each topic; what is read of the file is added to `read`.
    pub(crate) fn open(
        file: &Source,
        recording: &Recording,
        shifts_ns: &[i64],
        read: &Arc<AtomicU64>,
    ) -> Result<Self> {
        let mut intake = Intake::new(Arc::clone(&recording.choice), shifts_ns.to_vec());
        if file.is_growing() {
            intake = intake.with_hold(GROWING_HOLD);
        }
        Ok(Self {
            container: Container::from_source(file)?,
            intake,
            channels: BTreeMap::new(),
            recording: recording.clone(),
            read: Arc::clone(read),
            counted: 0,
            done: false,
        })
    }

    /// Reads on by one message or one damage.
    fn advance(&mut self) {
        match self.container.next() {
            None => {
                self.done = true;
                self.intake.finish();
                self.recording.add(self.intake.left_out());
            }
            Some(Event::Damage(damage)) => self.intake.lose(damage.bytes),
            Some(Event::Message(message)) => {
                let intake = &mut self.intake;
                let channel = self
                    .channels
                    .entry(message.channel)
                    .or_insert_with(|| intake.channel(message.of));
                intake.push(*channel, message.data, message.log_time_ns);
            }
        }
        let more = self.container.offset().saturating_sub(self.counted);
        self.read.fetch_add(more, Ordering::Relaxed);
        self.counted += more;
    }
}

impl Iterator for RecordingReader {
    type Item = Result<Sample>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let sample = self.intake.pop();
            if sample.is_some() || self.done {
                return sample.map(Ok);
            }
            self.advance();
        }
    }
}
