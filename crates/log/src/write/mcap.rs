//! Writing MCAP: chunks of LZ4 with their CRCs, an index of messages behind each, and a summary.
//!
//! Source: the MCAP specification, version 0 (mcap.dev/spec).

use std::collections::BTreeMap;
use std::io::{self, Write};

use super::chunk::Age;
use super::{Times, invalid, length_u32, lz4};
use crate::container::Channel;

const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";
const HEADER: u8 = 1;
const FOOTER: u8 = 2;
const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const CHUNK_RECORD: u8 = 6;
const MESSAGE_INDEX: u8 = 7;
const CHUNK_INDEX: u8 = 8;
const STATISTICS: u8 = 11;
const SUMMARY_OFFSET: u8 = 14;
const DATA_END: u8 = 15;

/// Name, language and text of a schema.
type SchemaKey = (String, String, Vec<u8>);

/// An MCAP file in the making. Memory holds one chunk, and the index.
///
/// A chunk is closed, and given to the system, after 1 MiB or one second of messages: what a program that is
/// killed may lose.
///
/// ```
/// use grouser_log::message::build;
/// use grouser_log::write::McapWriter;
///
/// let mut writer = McapWriter::new(Vec::new(), "ros2")?;
/// let mut topic = writer.topic("/cmd_vel", "geometry_msgs/Twist")?;
/// writer.send(&mut topic, 1_000_000_000, &build::twist([0.2, 0.0, 0.0], [0.0; 3]))?;
/// let file = writer.finish()?;
/// assert!(file.starts_with(b"\x89MCAP0\r\n") && file.ends_with(b"\x89MCAP0\r\n"));
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct McapWriter<W: Write> {
    out: W,
    at: u64,
    data_crc: crc32fast::Hasher,
    schemas: BTreeMap<SchemaKey, u16>,
    channels: Vec<Entered>,
    chunk: OpenChunk,
    age: Age,
    chunks: Vec<ChunkIndex>,
    /// Schemas and channels once more, for the summary.
    schema_records: Vec<u8>,
    channel_records: Vec<u8>,
}

struct Entered {
    channel: Channel,
    messages: u64,
    /// Time and place of its messages in the open chunk.
    index: Vec<(u64, u64)>,
}

#[derive(Default)]
struct OpenChunk {
    content: Vec<u8>,
    span: Option<(u64, u64)>,
}

struct ChunkIndex {
    span: (u64, u64),
    start: u64,
    length: u64,
    indexes: Vec<(u16, u64)>,
    index_length: u64,
    packed: u64,
    unpacked: u64,
}

/// The fields of a record.
#[derive(Default)]
struct Record(Vec<u8>);

impl Record {
    fn bytes(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }

    fn u16(self, value: u16) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    fn u32(self, value: u32) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    fn u64(self, value: u64) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    fn counted(self, bytes: &[u8]) -> io::Result<Self> {
        let length = length_u32(bytes.len())?;
        Ok(self.u32(length).bytes(bytes))
    }

    /// With opcode and length, behind `content`.
    fn end(self, opcode: u8, content: &mut Vec<u8>) {
        content.push(opcode);
        content.extend_from_slice(&(self.0.len() as u64).to_le_bytes());
        content.extend_from_slice(&self.0);
    }
}

impl<W: Write> McapWriter<W> {
    /// Begins a file; `profile` says whose conventions its messages follow: `ros1`, `ros2` or nothing.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn new(out: W, profile: &str) -> io::Result<Self> {
        let mut writer = Self {
            out,
            at: 0,
            data_crc: crc32fast::Hasher::new(),
            schemas: BTreeMap::new(),
            channels: Vec::new(),
            chunk: OpenChunk::default(),
            age: Age::default(),
            chunks: Vec::new(),
            schema_records: Vec::new(),
            channel_records: Vec::new(),
        };
        let mut start = MAGIC.to_vec();
        Record::default()
            .counted(profile.as_bytes())?
            .counted(b"grouser")?
            .end(HEADER, &mut start);
        writer.put(&start)?;
        Ok(writer)
    }

    /// Enters a channel, or finds the same one; its number is for [`McapWriter::message`].
    ///
    /// # Errors
    /// `InvalidInput` for more channels or schemas than the format has numbers for.
    pub fn channel(&mut self, channel: &Channel) -> io::Result<u16> {
        let known = self.channels.iter().position(|c| c.channel == *channel);
        let full = |_| invalid("MCAP holds 65 535 channels and schemas at most");
        if let Some(index) = known {
            return u16::try_from(index).map_err(full);
        }
        let id = u16::try_from(self.channels.len()).map_err(full)?;
        let nameless = channel.type_name.is_empty() && channel.definition.is_empty();
        let schema = if nameless { 0 } else { self.schema(channel)? };
        let mut metadata = Record::default();
        for (key, value) in &channel.metadata {
            metadata = metadata
                .counted(key.as_bytes())?
                .counted(value.as_bytes())?;
        }
        let mut record = Vec::new();
        Record::default()
            .u16(id)
            .u16(schema)
            .counted(channel.topic.as_bytes())?
            .counted(channel.encoding_name.as_bytes())?
            .counted(&metadata.0)?
            .end(CHANNEL, &mut record);
        self.chunk.content.extend_from_slice(&record);
        self.channel_records.extend_from_slice(&record);
        self.channels.push(Entered {
            channel: channel.clone(),
            messages: 0,
            index: Vec::new(),
        });
        Ok(id)
    }

    fn schema(&mut self, channel: &Channel) -> io::Result<u16> {
        let key = (
            channel.type_name.clone(),
            channel.definition_language.clone(),
            channel.definition.to_vec(),
        );
        if let Some(id) = self.schemas.get(&key) {
            return Ok(*id);
        }
        // 0 stands for none.
        let id = u16::try_from(self.schemas.len() + 1)
            .map_err(|_| invalid("MCAP holds 65 535 channels and schemas at most"))?;
        let mut record = Vec::new();
        Record::default()
            .u16(id)
            .counted(channel.type_name.as_bytes())?
            .counted(channel.definition_language.as_bytes())?
            .counted(&channel.definition)?
            .end(SCHEMA, &mut record);
        self.chunk.content.extend_from_slice(&record);
        self.schema_records.extend_from_slice(&record);
        self.schemas.insert(key, id);
        Ok(id)
    }

    /// Writes a message of a channel.
    ///
    /// # Errors
    /// What the system refuses; `InvalidInput` for a channel that was never entered.
    pub fn message(&mut self, channel: u16, times: Times, data: &[u8]) -> io::Result<()> {
        let Some(entered) = self.channels.get_mut(usize::from(channel)) else {
            return Err(invalid(
                "a message belongs to a channel that was never entered",
            ));
        };
        let (time, chunk) = (times.log_ns, &mut self.chunk);
        entered.messages += 1;
        entered.index.push((time, chunk.content.len() as u64));
        let (first, last) = chunk.span.unwrap_or((time, time));
        chunk.span = Some((first.min(time), last.max(time)));
        Record::default()
            .u16(channel)
            .u32(times.sequence)
            .u64(time)
            .u64(times.publish_ns)
            .bytes(data)
            .end(MESSAGE, &mut chunk.content);
        if self.age.is_full(time, chunk.content.len()) {
            self.close_chunk()?;
        }
        Ok(())
    }

    fn close_chunk(&mut self) -> io::Result<()> {
        let chunk = std::mem::take(&mut self.chunk);
        if chunk.content.is_empty() {
            return Ok(());
        }
        let span = chunk.span.unwrap_or_default();
        let packed = lz4(&chunk.content)?;
        let start = self.at;
        let mut record = Vec::new();
        Record::default()
            .u64(span.0)
            .u64(span.1)
            .u64(chunk.content.len() as u64)
            .u32(crc32fast::hash(&chunk.content))
            .counted(b"lz4")?
            .u64(packed.len() as u64)
            .bytes(&packed)
            .end(CHUNK_RECORD, &mut record);
        self.put(&record)?;
        let length = self.at - start;
        let (mut indexes, index_start) = (Vec::new(), self.at);
        for id in 0..self.channels.len() {
            let index = std::mem::take(&mut self.channels[id].index);
            if index.is_empty() {
                continue;
            }
            let id = u16::try_from(id).unwrap_or(u16::MAX);
            indexes.push((id, self.at));
            let places = index
                .iter()
                .fold(Record::default(), |record, (time, place)| {
                    record.u64(*time).u64(*place)
                });
            record.clear();
            Record::default()
                .u16(id)
                .counted(&places.0)?
                .end(MESSAGE_INDEX, &mut record);
            self.put(&record)?;
        }
        self.chunks.push(ChunkIndex {
            span,
            start,
            length,
            indexes,
            index_length: self.at - index_start,
            packed: packed.len() as u64,
            unpacked: chunk.content.len() as u64,
        });
        self.out.flush()
    }

    /// Ends the file with its summary.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(mut self) -> io::Result<W> {
        self.close_chunk()?;
        let mut record = Vec::new();
        let crc = self.data_crc.clone().finalize();
        Record::default().u32(crc).end(DATA_END, &mut record);
        self.put(&record)?;
        let summary_start = self.at;
        let mut summary = Vec::new();
        let mut groups = Vec::new();
        let mut group = |opcode: u8, records: &[u8]| {
            if !records.is_empty() {
                let start = summary_start + summary.len() as u64;
                groups.push((opcode, start, records.len() as u64));
                summary.extend_from_slice(records);
            }
        };
        group(SCHEMA, &self.schema_records);
        group(CHANNEL, &self.channel_records);
        group(STATISTICS, &self.statistics()?);
        group(CHUNK_INDEX, &self.chunk_indexes()?);
        let offsets_start = summary_start + summary.len() as u64;
        for (opcode, start, length) in groups {
            Record::default()
                .bytes(&[opcode])
                .u64(start)
                .u64(length)
                .end(SUMMARY_OFFSET, &mut summary);
        }
        // The CRC covers the footer up to itself.
        let footer = Record::default().u64(summary_start).u64(offsets_start);
        let mut covered = summary.clone();
        covered.push(FOOTER);
        covered.extend_from_slice(&20_u64.to_le_bytes());
        covered.extend_from_slice(&footer.0);
        footer
            .u32(crc32fast::hash(&covered))
            .end(FOOTER, &mut summary);
        summary.extend_from_slice(&MAGIC);
        self.put(&summary)?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn statistics(&self) -> io::Result<Vec<u8>> {
        let spans = self.chunks.iter().filter(|chunk| !chunk.indexes.is_empty());
        let first = spans.clone().map(|chunk| chunk.span.0).min();
        let last = spans.map(|chunk| chunk.span.1).max();
        let mut counts = Record::default();
        for (id, entered) in self.channels.iter().enumerate() {
            let id = u16::try_from(id).unwrap_or(u16::MAX);
            counts = counts.u16(id).u64(entered.messages);
        }
        let mut record = Vec::new();
        Record::default()
            .u64(self.channels.iter().map(|entered| entered.messages).sum())
            .u16(u16::try_from(self.schemas.len()).unwrap_or(u16::MAX))
            .u32(length_u32(self.channels.len())?)
            .u32(0)
            .u32(0)
            .u32(length_u32(self.chunks.len())?)
            .u64(first.unwrap_or(0))
            .u64(last.unwrap_or(0))
            .counted(&counts.0)?
            .end(STATISTICS, &mut record);
        Ok(record)
    }

    fn chunk_indexes(&self) -> io::Result<Vec<u8>> {
        let mut records = Vec::new();
        for chunk in &self.chunks {
            let indexes = &chunk.indexes;
            let places = indexes
                .iter()
                .fold(Record::default(), |record, (id, place)| {
                    record.u16(*id).u64(*place)
                });
            Record::default()
                .u64(chunk.span.0)
                .u64(chunk.span.1)
                .u64(chunk.start)
                .u64(chunk.length)
                .counted(&places.0)?
                .u64(chunk.index_length)
                .counted(b"lz4")?
                .u64(chunk.packed)
                .u64(chunk.unpacked)
                .end(CHUNK_INDEX, &mut records);
        }
        Ok(records)
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.data_crc.update(bytes);
        self.at += bytes.len() as u64;
        Ok(())
    }
}
