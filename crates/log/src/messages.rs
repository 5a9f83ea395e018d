//! Decoded messages of MCAP files and bags in the order of their time.

use std::collections::BTreeMap;
use std::path::Path;

use crate::container::{Channel, Container, Event};
use crate::error::{Cell, Result};
use crate::message::{Decoders, SharedDecoder, Value, View, decode};
use crate::order::Ordered;

/// How many messages a message may stand from its place in time.
pub const LOOK_AHEAD: usize = 4096;
/// How much the messages that are held back may take, bytes as they stand in the file: images and maps
/// are not held by the thousand. Decoded they take up to about ten times as much.
const HELD_LIMIT: usize = 1 << 20;

/// One decoded message.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Stamped {
    /// When it was taken, ns: the stamp of its header, or when it was recorded if it has none.
    pub time_ns: i64,
    /// When it was recorded, ns.
    pub log_time_ns: u64,
    /// The index of its channel in [`Messages::channels`].
    pub channel: usize,
    /// Bytes that it takes in the file, uncompressed.
    pub size: usize,
    /// Its fields.
    pub value: Value,
}

/// Which time of a message counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// The stamp of its header, where it has one that is not zero.
    #[default]
    Header,
    /// When it was recorded.
    Recorder,
}

/// What was left out on the way.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LeftOut {
    /// Places of the file that could not be read.
    pub damages: u64,
    /// Bytes of the file that are lost in them.
    pub bytes_lost: u64,
    /// Messages that could not be decoded, and rows of tables whose time is garbled.
    pub undecoded: u64,
    /// Why the first of them could not be.
    pub problem: Option<String>,
    /// Messages that stood too far from their place in time.
    pub late: u64,
    /// Readings that cannot be used.
    pub excluded: u64,
    /// Why the first of them cannot be.
    pub exclusion: Option<&'static str>,
    /// The last lines of tables that are cut off: the logger was ended while it wrote.
    pub cut_off: Vec<Cell>,
    /// Poses of exact zeros in rows of tables whose logger had no new pose.
    pub zero_poses: u64,
    /// Rows of tables.
    pub rows: u64,
    /// Those that have the time of the row before.
    pub same_time: u64,
}

impl LeftOut {
    /// A reading that cannot be used.
    pub(crate) fn exclude(&mut self, why: &'static str) {
        self.excluded += 1;
        self.exclusion.get_or_insert(why);
    }

    /// A row of a table that cannot be used.
    pub(crate) fn leave_out_row(&mut self, why: &crate::Error) {
        self.undecoded += 1;
        self.problem.get_or_insert_with(|| why.to_string());
    }

    /// What was left out of another file of the same run.
    pub(crate) fn add(&mut self, other: &Self) {
        self.damages += other.damages;
        self.bytes_lost += other.bytes_lost;
        self.undecoded += other.undecoded;
        self.late += other.late;
        self.excluded += other.excluded;
        self.cut_off.extend_from_slice(&other.cut_off);
        self.zero_poses += other.zero_poses;
        self.rows += other.rows;
        self.same_time += other.same_time;
        self.exclusion = self.exclusion.or(other.exclusion);
        if self.problem.is_none() {
            self.problem.clone_from(&other.problem);
        }
    }
}

/// Is a channel wanted?
type Wanted = Box<dyn FnMut(&Channel) -> bool + Send>;

/// The messages of an MCAP file or a bag, decoded by the definitions it holds, in the order of time.
///
/// Up to [`LOOK_AHEAD`] messages are held back (fewer if they are large), so that memory does not grow
/// with the file; one that comes later than that is counted in [`Messages::left_out`] and not given.
/// Damage does not end it. Only channels that are wanted are decoded.
pub struct Messages {
    container: Container,
    wanted: Wanted,
    clock: Clock,
    /// By channel; `None`: not wanted.
    decoders: BTreeMap<usize, Option<SharedDecoder>>,
    shared: Decoders,
    ordered: Ordered<Stamped>,
    held: usize,
    left_out: LeftOut,
    done: bool,
}

impl Messages {
    /// Opens a file for the messages of the channels that `wanted` takes.
    ///
    /// # Errors
    /// What does not let the file be opened.
    pub fn open(
        path: &Path,
        clock: Clock,
        wanted: impl FnMut(&Channel) -> bool + Send + 'static,
    ) -> Result<Self> {
        Ok(Self {
            container: Container::open(path)?,
            wanted: Box::new(wanted),
            clock,
            decoders: BTreeMap::new(),
            shared: Decoders::default(),
            ordered: Ordered::new(LOOK_AHEAD),
            held: 0,
            left_out: LeftOut::default(),
            done: false,
        })
    }

    /// The channels met so far.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        self.container.channels()
    }

    /// The view of a message, for the types that have one.
    #[must_use]
    pub fn view<'a>(&self, message: &'a Stamped) -> Option<View<'a>> {
        View::new(&self.channels()[message.channel].type_name, &message.value)
    }

    /// What was left out so far.
    #[must_use]
    pub fn left_out(&self) -> &LeftOut {
        &self.left_out
    }

    /// How many bytes of the file have been read.
    #[must_use]
    pub fn offset(&self) -> u64 {
        self.container.offset()
    }

    /// Reads one message of the file into the ordering.
    fn take(&mut self) {
        let message = match self.container.next() {
            None => {
                self.done = true;
                return;
            }
            Some(Event::Damage(damage)) => {
                self.left_out.damages += 1;
                self.left_out.bytes_lost += damage.bytes;
                return;
            }
            Some(Event::Message(message)) => {
                let (wanted, shared) = (&mut self.wanted, &mut self.shared);
                let decoder = self
                    .decoders
                    .entry(message.channel)
                    .or_insert_with(|| wanted(message.of).then(|| shared.of(message.of)));
                let Some(decoder) = decoder else {
                    return;
                };
                let mut value = Value::Null;
                if let Err(problem) = decode(decoder, message.data, &mut value) {
                    self.left_out.undecoded += 1;
                    self.left_out.problem.get_or_insert(problem);
                    return;
                }
                let recorded = i64::try_from(message.log_time_ns).unwrap_or(i64::MAX);
                let stamp = match self.clock {
                    Clock::Header => stamp_of(&value),
                    Clock::Recorder => Ok(None),
                };
                let Ok(stamp) = stamp else {
                    self.left_out.undecoded += 1;
                    self.left_out
                        .problem
                        .get_or_insert_with(|| NO_STAMP.to_owned());
                    return;
                };
                Stamped {
                    time_ns: stamp.unwrap_or(recorded),
                    log_time_ns: message.log_time_ns,
                    channel: message.channel,
                    size: message.data.len(),
                    value,
                }
            }
        };
        if self.ordered.begin_row(message.time_ns).is_err() {
            self.left_out.late += 1;
            return;
        }
        self.held += message.size;
        self.ordered.push(message);
    }
}

impl Iterator for Messages {
    type Item = Stamped;

    fn next(&mut self) -> Option<Stamped> {
        while !self.done && !self.ordered.is_ripe() && self.held <= HELD_LIMIT {
            self.take();
        }
        let message = self.ordered.pop()?;
        self.held -= message.size;
        Some(message)
    }
}

/// Why a message whose stamp is garbled is left out.
pub(crate) const NO_STAMP: &str =
    "its stamp is not a time: `nanosec` must be below 1000000000, and the sum must fit in 64 bits";

/// A stamp that is not a time.
#[derive(Debug)]
pub(crate) struct NoStamp;

/// The stamp of a message's header, ns; a stamp of zero is none. Of transforms, the first one's.
pub(crate) fn stamp_of(value: &Value) -> std::result::Result<Option<i64>, NoStamp> {
    let stamp = value
        .at("header.stamp")
        .or_else(|| value.at("transforms[0].header.stamp"));
    let Some(stamp) = stamp else { return Ok(None) };
    match stamp.time_ns() {
        Some(time_ns) => Ok(Some(time_ns).filter(|time_ns| *time_ns > 0)),
        None if stamp.at("sec").is_some() => Err(NoStamp),
        None => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_two_files_leave_out_is_one_sum() {
        let cell = Cell {
            file: "a.csv".into(),
            line: 7,
            column: None,
            name: None,
        };
        let file = |scale: u64, why: Option<&'static str>| LeftOut {
            damages: scale,
            bytes_lost: 2 * scale,
            undecoded: 3 * scale,
            problem: why.map(Into::into),
            late: 4 * scale,
            excluded: 5 * scale,
            exclusion: why,
            cut_off: (0..scale).map(|_| cell.clone()).collect(),
            zero_poses: 6 * scale,
            rows: 7 * scale,
            same_time: 8 * scale,
        };
        let mut all = file(10, None);
        all.add(&file(1, Some("first")));
        all.add(&file(1, Some("second")));
        assert_eq!(all, file(12, Some("first")));
        all.exclude("third");
        assert_eq!((all.excluded, all.exclusion), (61, Some("first")));
    }
}
