//! Writing ROS 1 bags, version 2.0: chunks of LZ4, an index behind each, and one of the whole at the end.
//!
//! Source: "Bag File Format 2.0" of the ROS wiki (wiki.ros.org/Bags/Format/2.0).

use std::collections::BTreeMap;
use std::io::{self, Seek, SeekFrom, Write};

use super::chunk::Age;
use super::{Times, invalid, length_u32, lz4};
use crate::container::{Channel, Encoding};

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
const MESSAGE: u8 = 2;
const BAG_HEADER: u8 = 3;
const INDEX: u8 = 4;
const CHUNK_RECORD: u8 = 5;
const CHUNK_INFO: u8 = 6;
const CONNECTION: u8 = 7;
/// The bag's header with its padding, bytes: it is written anew at the end.
const HEADER_LENGTH: usize = 4096;

/// A bag in the making. Memory holds one chunk, and the index.
///
/// A chunk is closed, and given to the system, after 1 MiB or one second of messages, as of
/// [`McapWriter`](super::McapWriter).
pub struct BagWriter<W: Write + Seek> {
    out: W,
    at: u64,
    connections: Vec<(Channel, Vec<u8>)>,
    chunk: Vec<u8>,
    age: Age,
    span: Option<(u64, u64)>,
    /// Of the open chunk: time and place by connection.
    index: BTreeMap<u32, Vec<(u64, u32)>>,
    chunks: Vec<u8>,
    chunk_count: u32,
}

/// `name=value` with its length.
fn field(name: &str, value: &[u8], header: &mut Vec<u8>) -> io::Result<()> {
    let length = length_u32(name.len() + 1 + value.len())?;
    header.extend_from_slice(&length.to_le_bytes());
    header.extend_from_slice(name.as_bytes());
    header.push(b'=');
    header.extend_from_slice(value);
    Ok(())
}

/// A record of these fields and this data.
fn record(fields: &[(&str, &[u8])], data: &[u8], out: &mut Vec<u8>) -> io::Result<()> {
    let mut header = Vec::new();
    for (name, value) in fields {
        field(name, value, &mut header)?;
    }
    out.extend_from_slice(&length_u32(header.len())?.to_le_bytes());
    out.extend_from_slice(&header);
    out.extend_from_slice(&length_u32(data.len())?.to_le_bytes());
    out.extend_from_slice(data);
    Ok(())
}

/// Seconds and nanoseconds.
fn time(time_ns: u64) -> io::Result<[u8; 8]> {
    let seconds = u32::try_from(time_ns / 1_000_000_000)
        .map_err(|_| invalid("a bag holds no time after the year 2106"))?;
    let nanoseconds = u32::try_from(time_ns % 1_000_000_000).unwrap_or(0);
    let mut bytes = [0; 8];
    bytes[..4].copy_from_slice(&seconds.to_le_bytes());
    bytes[4..].copy_from_slice(&nanoseconds.to_le_bytes());
    Ok(bytes)
}

impl<W: Write + Seek> BagWriter<W> {
    /// Begins a bag.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn new(out: W) -> io::Result<Self> {
        let mut writer = Self {
            out,
            at: 0,
            connections: Vec::new(),
            chunk: Vec::new(),
            age: Age::default(),
            span: None,
            index: BTreeMap::new(),
            chunks: Vec::new(),
            chunk_count: 0,
        };
        writer.put(MAGIC)?;
        let header = writer.header(0)?;
        writer.put(&header)?;
        Ok(writer)
    }

    fn header(&self, index_at: u64) -> io::Result<Vec<u8>> {
        let connections = length_u32(self.connections.len())?;
        let fields: [(&str, &[u8]); 4] = [
            ("op", &[BAG_HEADER]),
            ("index_pos", &index_at.to_le_bytes()),
            ("conn_count", &connections.to_le_bytes()),
            ("chunk_count", &self.chunk_count.to_le_bytes()),
        ];
        let mut bare = Vec::new();
        record(&fields, &[], &mut bare)?;
        let mut padded = Vec::new();
        let padding = vec![b' '; HEADER_LENGTH - bare.len()];
        record(&fields, &padding, &mut padded)?;
        Ok(padded)
    }

    /// Enters a channel, or finds the same one; its number is for [`BagWriter::message`].
    ///
    /// # Errors
    /// `InvalidInput` for messages that are not laid out as ROS 1 lays them out.
    pub fn channel(&mut self, channel: &Channel) -> io::Result<u16> {
        let known = self.connections.iter().position(|c| c.0 == *channel);
        let full = |_| invalid("more than 65 535 topics");
        if let Some(index) = known {
            return u16::try_from(index).map_err(full);
        }
        if channel.encoding != Encoding::Ros1 {
            return Err(invalid("a bag holds messages of ROS 1 only"));
        }
        let id = u16::try_from(self.connections.len()).map_err(full)?;
        let mut data = Vec::new();
        field("topic", channel.topic.as_bytes(), &mut data)?;
        field("type", channel.type_name.as_bytes(), &mut data)?;
        let others = ["md5sum", "callerid", "latching"];
        for key in others {
            // ROS takes any sum for `*`.
            let given = channel.metadata.get(key).map(String::as_str);
            if let Some(value) = given.or((key == "md5sum").then_some("*")) {
                field(key, value.as_bytes(), &mut data)?;
            }
        }
        field("message_definition", &channel.definition, &mut data)?;
        let mut connection = Vec::new();
        let fields: [(&str, &[u8]); 3] = [
            ("op", &[CONNECTION]),
            ("conn", &u32::from(id).to_le_bytes()),
            ("topic", channel.topic.as_bytes()),
        ];
        record(&fields, &data, &mut connection)?;
        self.chunk.extend_from_slice(&connection);
        self.connections.push((channel.clone(), connection));
        Ok(id)
    }

    /// Writes a message of a channel. A bag has one time: that of recording.
    ///
    /// # Errors
    /// What the system refuses; `InvalidInput` for a channel that was never entered, and for times that a
    /// bag does not hold.
    pub fn message(&mut self, channel: u16, times: Times, data: &[u8]) -> io::Result<()> {
        if usize::from(channel) >= self.connections.len() {
            return Err(invalid(
                "a message belongs to a channel that was never entered",
            ));
        }
        let (id, when) = (u32::from(channel), times.log_ns);
        let place = length_u32(self.chunk.len())?;
        let fields: [(&str, &[u8]); 3] = [
            ("op", &[MESSAGE]),
            ("conn", &id.to_le_bytes()),
            ("time", &time(when)?),
        ];
        record(&fields, data, &mut self.chunk)?;
        self.index.entry(id).or_default().push((when, place));
        let (first, last) = self.span.unwrap_or((when, when));
        self.span = Some((first.min(when), last.max(when)));
        if self.age.is_full(when, self.chunk.len()) {
            self.close_chunk()?;
        }
        Ok(())
    }

    fn close_chunk(&mut self) -> io::Result<()> {
        let content = std::mem::take(&mut self.chunk);
        if content.is_empty() {
            return Ok(());
        }
        let (first, last) = self.span.take().unwrap_or_default();
        let index = std::mem::take(&mut self.index);
        let start = self.at;
        let mut out = Vec::new();
        let fields: [(&str, &[u8]); 3] = [
            ("op", &[CHUNK_RECORD]),
            ("compression", b"lz4"),
            ("size", &length_u32(content.len())?.to_le_bytes()),
        ];
        record(&fields, &lz4(&content)?, &mut out)?;
        let mut counts = Vec::new();
        for (id, places) in &index {
            let count = length_u32(places.len())?.to_le_bytes();
            let mut data = Vec::new();
            for (when, place) in places {
                data.extend_from_slice(&time(*when)?);
                data.extend_from_slice(&place.to_le_bytes());
            }
            let fields: [(&str, &[u8]); 4] = [
                ("op", &[INDEX]),
                ("ver", &1_u32.to_le_bytes()),
                ("conn", &id.to_le_bytes()),
                ("count", &count),
            ];
            record(&fields, &data, &mut out)?;
            counts.extend_from_slice(&id.to_le_bytes());
            counts.extend_from_slice(&count);
        }
        self.put(&out)?;
        let fields: [(&str, &[u8]); 6] = [
            ("op", &[CHUNK_INFO]),
            ("ver", &1_u32.to_le_bytes()),
            ("chunk_pos", &start.to_le_bytes()),
            ("start_time", &time(first)?),
            ("end_time", &time(last)?),
            ("count", &length_u32(index.len())?.to_le_bytes()),
        ];
        record(&fields, &counts, &mut self.chunks)?;
        self.chunk_count += 1;
        self.out.flush()
    }

    /// Ends the bag with its index.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(mut self) -> io::Result<W> {
        self.close_chunk()?;
        let index_at = self.at;
        let mut index = Vec::new();
        for (_, connection) in &self.connections {
            index.extend_from_slice(connection);
        }
        index.extend_from_slice(&self.chunks);
        self.put(&index)?;
        let header = self.header(index_at)?;
        self.out.seek(SeekFrom::Start(MAGIC.len() as u64))?;
        self.out.write_all(&header)?;
        self.out.seek(SeekFrom::End(0))?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.out.write_all(bytes)?;
        self.at += bytes.len() as u64;
        Ok(())
    }
}
