//! MCAP files, ROS 1 bags and databases of rosbag2 as a stream of messages, whole or damaged.

mod bag;
mod event;
mod fields;
mod mcap;
mod rosbag2;
mod scan;
mod spare;
mod sqlite;
mod unpack;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::io::{Read, Seek};
use std::path::Path;
use std::sync::Arc;

use crate::error::{Error, Result};
use crate::source::{Source, unfolded_limit};
pub use event::{Channel, Damage, Encoding, Event, Format, Message};
use fields::Fields;
use rosbag2::Rosbag2;
use scan::Scan;
use spare::Spare;
use unpack::{Packing, Unpacker};

/// The maximum size of a record, and of a chunk that is not compressed, bytes.
pub const CHUNK_LIMIT: u64 = 48 << 20;
/// How many channels or schemas a file may declare.
pub(crate) const CHANNEL_LIMIT: usize = 8192;
/// The maximum length of a topic, or of a name of a type, an encoding or a language, bytes.
pub(crate) const NAME_LIMIT: usize = 1024;
/// How long all different definitions and the names of all channels may be together, bytes.
pub(crate) const DECLARED_LIMIT: usize = 4 << 20;

/// The maximum size of a chunk out of its compression, bytes, in a file of `file_bytes`: a small file
/// must not unfold far. Beside it stand the packed chunk and what a message is decoded to, and all is to
/// stay below 64 MiB and twice the file.
#[must_use]
pub fn unpacked_limit(file_bytes: u64) -> u64 {
    ((32 << 20) + file_bytes / 2).min(CHUNK_LIMIT)
}

/// The report where a record's length made the reader pass over others.
const SWALLOWED: &str = "a record declares more bytes than it has";

/// A message whose bytes stand in a buffer of the container.
struct Found {
    channel: usize,
    log_time_ns: u64,
    publish_time_ns: u64,
    sequence: u32,
    in_chunk: bool,
    start: usize,
    end: usize,
}

/// A chunk out of its compression.
#[derive(Default)]
struct Chunk {
    content: Vec<u8>,
    at: usize,
    offset: u64,
    bytes: u64,
    /// The chunk is truncated, so a truncated last record is expected and not reported again.
    truncated: bool,
    /// How many of its messages were met.
    met: u64,
}

/// The damage of a chunk until it is known how many messages are lost: the sum of its indexes, which
/// stand behind it.
struct Waiting {
    damage: Damage,
    indexed: Option<u64>,
}

/// What stands where an MCAP file is read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    /// Its data.
    Data,
    /// The indexes of a chunk.
    Indexes,
    /// What follows the end of the data.
    Summary,
}

/// A schema of an MCAP file.
struct Schema {
    name: String,
    language: String,
    text: Arc<[u8]>,
}

/// An open file. It is read from front to back: an index is not needed, and not believed.
///
/// Memory is bounded by one chunk, compressed and not, and the definitions.
pub struct Container {
    format: Format,
    scan: Scan,
    rosbag2: Option<Rosbag2>,
    channels: Vec<Channel>,
    ids: BTreeMap<u32, usize>,
    schemas: BTreeMap<u16, Schema>,
    definitions: BTreeSet<Arc<[u8]>>,
    /// How long the definitions and the channels' names are, bytes.
    declared: usize,
    /// What all compressed chunks declared to unfold to, bytes.
    unfolded: u64,
    unpacker: Unpacker,
    record: Vec<u8>,
    /// Room for a message that is expanded.
    message: Vec<u8>,
    chunk: Chunk,
    damages: VecDeque<Damage>,
    waiting: Option<Waiting>,
    /// Messages of channels that are not there, by channel: where the first is, and how many.
    orphans: BTreeMap<u32, (u64, u64)>,
    /// Where this file begins: others may stand before it.
    base: u64,
    /// The declarations that the end of the file repeats; `None` until they are wanted.
    spare: Option<Spare>,
    chunks: u64,
    promised_chunks: Option<u64>,
    index_at: Option<u64>,
    closed: bool,
    /// Did the writer complete the file, by its footer or its index?
    is_complete: bool,
    ended: bool,
    /// Where the first record began whose length nothing confirms yet: it may lie.
    passed_over: Option<u64>,
    /// The records of an MCAP file that were read before the reading went back, up to the place it went back from.
    read_before: Option<(Scan, u64)>,
    /// Where in an MCAP file the reading is.
    section: Section,
    /// Messages of this file so far.
    messages: u64,
    attached: u64,
    /// Whose conventions an MCAP file says it follows.
    profile: String,
}

impl Container {
    /// What kind of file it is by its first bytes; `None` for another kind.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn kind(path: &Path) -> Result<Option<Format>> {
        Self::kind_of(&Source::file(path.to_owned()))
    }

    pub(crate) fn kind_of(source: &Source) -> Result<Option<Format>> {
        let scan = Scan::over(source.open()?);
        scan.and_then(|mut scan| kind(&mut scan))
            .map_err(|error| unreadable(source.path(), error))
    }

    /// Opens a file.
    ///
    /// # Errors
    /// [`Error::Version`] for another version of the format, [`Error::NotALog`] for another kind of file.
    pub fn open(path: &Path) -> Result<Self> {
        Self::from_source(&Source::file(path.to_owned()))
    }

    /// Reads from anything that can be read from any place, such as bytes in memory; `name` is what errors
    /// call it.
    ///
    /// # Errors
    /// As [`Container::open`].
    ///
    /// ```
    /// use grouser_log::container::{Container, Event};
    /// use grouser_log::message::build;
    /// use grouser_log::write::McapWriter;
    ///
    /// let mut writer = McapWriter::new(Vec::new(), "ros2")?;
    /// let mut topic = writer.topic("/cmd_vel", "geometry_msgs/Twist")?;
    /// writer.send(&mut topic, 1_000, &build::twist([0.2, 0.0, 0.0], [0.0; 3]))?;
    /// let file = writer.finish()?;
    ///
    /// let mut container = Container::over("memory.mcap".as_ref(), std::io::Cursor::new(file))?;
    /// let mut times = Vec::new();
    /// while let Some(event) = container.next() {
    ///     if let Event::Message(message) = event {
    ///         times.push(message.log_time_ns);
    ///     }
    /// }
    /// assert_eq!(times, [1_000]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn over(name: &Path, source: impl Read + Seek + Send + 'static) -> Result<Self> {
        Self::from_source(&Source::over(name, source))
    }

    pub(crate) fn from_source(source: &Source) -> Result<Self> {
        let file = || source.name();
        let failed = |error| unreadable(source.path(), error);
        let mut scan = Scan::over(source.open()?).map_err(failed)?;
        let Some(format) = kind(&mut scan).map_err(failed)? else {
            return Err(Error::NotALog { file: file() });
        };
        let (magic, version): (&[u8], _) = match format {
            Format::Mcap => (&mcap::MAGIC, 5..6),
            Format::Bag => (bag::MAGIC, 9..12),
            Format::Rosbag2 => (sqlite::MAGIC, 0..0),
        };
        let mut start = Vec::new();
        scan.read(magic.len() as u64, &mut start).map_err(failed)?;
        if start != magic {
            let found = start.get(version.clone()).unwrap_or_default();
            return Err(Error::Version {
                file: file(),
                format: format.name(),
                found: String::from_utf8_lossy(found).into_owned(),
                known: String::from_utf8_lossy(&magic[version]).into_owned(),
            });
        }
        scan.begin_crc(magic);
        let database = match format {
            Format::Rosbag2 => Some(Rosbag2::of(source)?),
            Format::Mcap | Format::Bag => None,
        };
        let mut own = Self {
            format,
            scan,
            rosbag2: None,
            channels: Vec::new(),
            ids: BTreeMap::new(),
            schemas: BTreeMap::new(),
            definitions: BTreeSet::new(),
            declared: 0,
            unfolded: 0,
            unpacker: Unpacker::new(),
            record: Vec::new(),
            message: Vec::new(),
            chunk: Chunk::default(),
            damages: VecDeque::new(),
            waiting: None,
            orphans: BTreeMap::new(),
            base: 0,
            spare: None,
            chunks: 0,
            promised_chunks: None,
            index_at: None,
            closed: false,
            is_complete: false,
            ended: false,
            passed_over: None,
            read_before: None,
            section: Section::Data,
            messages: 0,
            attached: 0,
            profile: String::new(),
        };
        if let Some((database, channels)) = database {
            own.begin_rosbag2(database, channels);
        }
        Ok(own)
    }

    /// The kind of file.
    ///
    /// ```
    /// use grouser_log::container::{Container, Format};
    /// use grouser_log::write::McapWriter;
    ///
    /// let file = McapWriter::new(Vec::new(), "")?.finish()?;
    /// let container = Container::over("memory.mcap".as_ref(), std::io::Cursor::new(file))?;
    /// assert_eq!(container.format(), Format::Mcap);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub const fn format(&self) -> Format {
        self.format
    }

    /// The channels that have been met so far.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// How many bytes of the file have been read.
    #[must_use]
    pub fn offset(&self) -> u64 {
        self.scan.offset()
    }

    /// Did the writer complete the file, by what was read so far?
    pub(crate) const fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Whose conventions the messages follow, by what was read so far: `ros1`, `ros2` or nothing.
    #[must_use]
    pub fn profile(&self) -> &str {
        match self.format {
            Format::Mcap => &self.profile,
            Format::Bag => "ros1",
            Format::Rosbag2 => "ros2",
        }
    }

    /// How many attachments and metadata records of an MCAP file were passed over.
    #[must_use]
    pub fn attached(&self) -> u64 {
        self.attached
    }

    /// What comes next, in the order of the file; `None` at its end.
    #[allow(
        clippy::should_implement_trait,
        reason = "what it gives borrows from the container"
    )]
    pub fn next(&mut self) -> Option<Event<'_>> {
        let found = loop {
            if let Some(damage) = self.damages.pop_front() {
                return Some(Event::Damage(damage));
            }
            if self.chunk.at < self.chunk.content.len() {
                let found = match self.format {
                    Format::Bag => self.bag_in_chunk(),
                    Format::Mcap | Format::Rosbag2 => self.mcap_in_chunk(),
                };
                if let Some(found) = found.and_then(|found| self.expanded(found)) {
                    break found;
                }
                continue;
            }
            if self.ended {
                self.settle();
                self.report_orphans();
                if self.damages.is_empty() {
                    return None;
                }
                continue;
            }
            let found = match self.format {
                Format::Mcap => self.mcap_record(),
                Format::Bag => self.bag_record(),
                Format::Rosbag2 => self.rosbag2_row(),
            };
            match found {
                Ok(found) => {
                    if let Some(found) = found.and_then(|found| self.expanded(found)) {
                        break found;
                    }
                }
                Err(error) => {
                    self.ended = true;
                    self.lose(self.scan.offset(), self.scan.left(), error.to_string());
                }
            }
        };
        let buffer = if found.in_chunk {
            &self.chunk.content
        } else {
            &self.record
        };
        Some(Event::Message(Message {
            channel: found.channel,
            of: &self.channels[found.channel],
            log_time_ns: found.log_time_ns,
            publish_time_ns: found.publish_time_ns,
            sequence: found.sequence,
            data: buffer.get(found.start..found.end).unwrap_or_default(),
        }))
    }

    /// Another file begins at `offset`: nothing that was declared holds there.
    fn begin_file(&mut self, offset: u64) {
        self.settle();
        self.report_orphans();
        self.ids.clear();
        self.base = offset;
        self.spare = None;
        self.passed_over = None;
        self.section = Section::Data;
    }

    /// Goes to the next place after `offset` where `fits` finds a record, or to one before it that the
    /// record at `suspect` made the reading pass over; from where on nothing is read.
    fn look_again(
        &mut self,
        offset: u64,
        suspect: Option<u64>,
        reach: usize,
        fits: impl Fn(&[u8], u64) -> bool,
    ) -> std::io::Result<u64> {
        if let Some(suspect) = suspect
            && self.swallowed(suspect, offset, reach, &fits)?
        {
            return Ok(suspect);
        }
        self.scan.find(offset + 1..u64::MAX, reach, &fits)?;
        Ok(offset)
    }

    /// Does `fits` find a record in what the record at `suspect` made the reading pass over, up to `offset`?
    /// Then the scan stands there.
    fn swallowed(
        &mut self,
        suspect: u64,
        offset: u64,
        reach: usize,
        fits: impl Fn(&[u8], u64) -> bool,
    ) -> std::io::Result<bool> {
        let found = self.scan.find(suspect + 1..offset, reach, fits)?.is_some();
        if found {
            self.read_before = Some((self.scan.beside(suspect), offset));
        }
        Ok(found)
    }

    fn lose(&mut self, offset: u64, bytes: u64, what: impl Into<String>) {
        self.settle();
        self.damages.push_back(Damage {
            offset,
            bytes,
            messages: None,
            what: what.into(),
        });
    }

    /// Tells what is wrong with the chunk, once it is known how many messages that costs.
    fn lose_of_chunk(&mut self, what: impl Into<String>) {
        self.settle();
        self.waiting = Some(Waiting {
            damage: Damage {
                offset: self.chunk.offset,
                bytes: self.chunk.bytes,
                messages: None,
                what: what.into(),
            },
            indexed: None,
        });
    }

    /// The index of the chunk names `messages` more.
    fn indexed(&mut self, messages: u64) {
        if let Some(waiting) = &mut self.waiting {
            let before = waiting.indexed.unwrap_or(0);
            waiting.indexed = Some(before.saturating_add(messages));
        }
    }

    /// No more indexes follow.
    fn settle(&mut self) {
        if let Some(Waiting {
            mut damage,
            indexed,
        }) = self.waiting.take()
        {
            damage.messages = indexed.map(|indexed| indexed.saturating_sub(self.chunk.met));
            self.damages.push_back(damage);
        }
    }

    /// A message of channel `id`, which is not there.
    fn orphan(&mut self, id: u32) {
        let offset = self.chunk.offset;
        self.orphans.entry(id).or_insert((offset, 0)).1 += 1;
    }

    fn report_orphans(&mut self) {
        for (id, (offset, count)) in std::mem::take(&mut self.orphans) {
            self.damages.push_back(Damage {
                offset,
                bytes: 0,
                messages: Some(count),
                what: format!("{count} messages belong to channel {id}, which is not there"),
            });
        }
    }

    /// Gives up the rest of the chunk.
    fn lose_chunk(&mut self, what: impl Into<String>) {
        self.chunk.at = self.chunk.content.len();
        if !self.chunk.truncated {
            self.lose_of_chunk(what);
        }
    }

    /// Enters a channel under the number `id`. One that contradicts another of that number is left out.
    fn enter(&mut self, id: u32, channel: Channel) -> std::result::Result<(), String> {
        if let Some(&index) = self.ids.get(&id) {
            return if self.channels[index] == channel {
                Ok(())
            } else {
                Err(format!(
                    "channel {id} is declared again as another: the first is kept"
                ))
            };
        }
        if self.ids.len() >= CHANNEL_LIMIT {
            return Err(too_many("channels"));
        }
        // The same topic in a second file that was put behind the first.
        let index = match self.channels.iter().position(|other| *other == channel) {
            Some(index) => index,
            None if self.channels.len() >= CHANNEL_LIMIT => return Err(too_many("channels")),
            None => {
                let names = [
                    &channel.topic,
                    &channel.type_name,
                    &channel.encoding_name,
                    &channel.definition_language,
                ];
                let metadata = channel.metadata.iter();
                let named: usize = names.iter().map(|name| name.len()).sum();
                self.declare(named + metadata.map(|(a, b)| a.len() + b.len()).sum::<usize>())?;
                self.channels.push(channel);
                self.channels.len() - 1
            }
        };
        self.ids.insert(id, index);
        Ok(())
    }

    /// A definition, held once however often it is declared.
    fn definition(&mut self, text: &[u8]) -> std::result::Result<Arc<[u8]>, String> {
        if let Some(known) = self.definitions.get(text) {
            return Ok(Arc::clone(known));
        }
        self.declare(text.len())?;
        let text: Arc<[u8]> = text.into();
        self.definitions.insert(Arc::clone(&text));
        Ok(text)
    }

    /// Makes room for `more` bytes of definitions and names.
    fn declare(&mut self, more: usize) -> std::result::Result<(), String> {
        let declared = self.declared.saturating_add(more);
        if declared > DECLARED_LIMIT {
            return Err(format!(
                "definitions and names have {declared} bytes, more than the limit of {DECLARED_LIMIT}"
            ));
        }
        self.declared = declared;
        Ok(())
    }
}

/// How many bytes the chunk that was just read may unfold to, if it is packed and declares `declared`;
/// `unfolded` counts them over the file.
fn room_for(declared: u64, packing: Packing, scan: &Scan, unfolded: &mut u64) -> u64 {
    if packing == Packing::None {
        return CHUNK_LIMIT;
    }
    let all = unfolded_limit(scan.offset());
    let room = unpacked_limit(scan.length()).min(all.saturating_sub(*unfolded));
    if declared <= room {
        *unfolded += declared;
    }
    room
}

fn too_many(what: &str) -> String {
    format!("there are more {what} than the limit of {CHANNEL_LIMIT}")
}

/// A name that a file gives to something.
fn name_of(bytes: &[u8], what: &str) -> std::result::Result<String, String> {
    if bytes.len() > NAME_LIMIT {
        let found = bytes.len();
        return Err(format!(
            "{what} has {found} bytes, more than the limit of {NAME_LIMIT} for a name"
        ));
    }
    let name = std::str::from_utf8(bytes).map_err(|_| format!("{what} is not UTF-8 text"))?;
    Ok(name.to_owned())
}

fn kind(scan: &mut Scan) -> std::io::Result<Option<Format>> {
    let start = scan.peek(16)?;
    Ok(if start.starts_with(&mcap::MAGIC[..5]) {
        Some(Format::Mcap)
    } else if start.starts_with(b"#ROSBAG") {
        Some(Format::Bag)
    } else if start == sqlite::MAGIC {
        Some(Format::Rosbag2)
    } else {
        None
    })
}

fn unreadable(path: &Path, source: std::io::Error) -> Error {
    grouser_files::Error::Unreadable {
        file: path.display().to_string(),
        source,
    }
    .into()
}

#[cfg(test)]
mod tests;
