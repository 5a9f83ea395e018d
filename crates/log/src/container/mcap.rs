//! The records of MCAP.

use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;

use super::unpack::Packing;
use super::{
    CHANNEL_LIMIT, CHUNK_LIMIT, Channel, Chunk, Container, Encoding, Fields, Found, SWALLOWED,
    Schema, Section, name_of, room_for, too_many,
};

pub(super) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

const HEADER: u8 = 1;
pub(super) const FOOTER: u8 = 2;
pub(super) const SCHEMA: u8 = 3;
pub(super) const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
pub(super) const CHUNK: u8 = 6;
const MESSAGE_INDEX: u8 = 7;
const ATTACHMENT: u8 = 9;
const STATISTICS: u8 = 11;
const METADATA: u8 = 12;
pub(super) const DATA_END: u8 = 15;
/// Opcode and length.
pub(super) const HEAD: u64 = 9;
/// The longest text in a channel's metadata: ROS 2 puts its quality of service there.
const METADATA_LIMIT: usize = 1 << 16;
/// What a chunk has before its compression's name.
const CHUNK_HEAD: u64 = 28;

impl Container {
    /// Waits in a file that is still written until the next record is whole.
    fn mcap_wait(&mut self) -> io::Result<()> {
        self.scan.wait(HEAD)?;
        let head = self.scan.peek(9)?;
        if head.starts_with(&MAGIC) {
            return Ok(());
        }
        let mut fields = Fields(head);
        let opcode = fields.bytes(1).map_or(0, |opcode| opcode[0]);
        let length = fields.u64().unwrap_or(0);
        let magic = if opcode == FOOTER { MAGIC.len() } else { 0 } as u64;
        if !is_known(opcode) {
            return Ok(());
        }
        let whole = length.saturating_add(HEAD + magic);
        self.scan.wait_for_record(whole, 64, is_chunk_or_file)?;
        Ok(())
    }

    /// One record from the file.
    pub(super) fn mcap_record(&mut self) -> io::Result<Option<Found>> {
        if self.scan.is_growing() {
            self.mcap_wait()?;
        }
        if self.mcap_was_read()? {
            return Ok(None);
        }
        let offset = self.scan.offset();
        let left = self.scan.left();
        let before = self.scan.crc();
        if left == 0 {
            if let Some(suspect) = self.passed_over.take()
                && self.swallowed(suspect, offset, 64, is_chunk_or_file)?
            {
                self.lose(suspect, self.scan.offset() - suspect, SWALLOWED);
                return Ok(None);
            }
            self.ended = true;
            if !self.closed {
                self.lose(offset, 0, "the file ends without its footer");
            }
            return Ok(None);
        }
        let mut head = Vec::new();
        self.scan.read(HEAD.min(left), &mut head)?;
        if head.starts_with(&MAGIC) {
            // The end of one file, or the start of one put behind it.
            self.scan.go_to(offset + MAGIC.len() as u64);
            if self.scan.left() > 0 {
                self.begin_file(offset);
                self.schemas.clear();
                self.closed = false;
                self.messages = 0;
                self.scan.begin_crc(&MAGIC);
            }
            return Ok(None);
        }
        let mut fields = Fields(head.get(1..).unwrap_or_default());
        let (Some(&opcode), Some(length)) = (head.first(), fields.u64()) else {
            self.ended = true;
            self.lose(offset, left, "the file ends within a record");
            return Ok(None);
        };
        let here = self.scan.left();
        let passed_over = self.passed_over;
        let known = is_known(opcode);
        if length > here
            && let Some(suspect) = passed_over
            && let back = self.scan.offset()
        {
            if self.swallowed(suspect, offset, 64, is_chunk_or_file)? {
                self.passed_over = None;
                self.lose(suspect, self.scan.offset() - suspect, SWALLOWED);
                return Ok(None);
            }
            self.scan.go_to(back);
        }
        if !known || (length > here && !matches!(opcode, CHUNK | MESSAGE)) {
            return self
                .mcap_resume(offset, passed_over, "no record begins here")
                .map(|()| None);
        }
        if opcode != MESSAGE_INDEX {
            self.settle();
        }
        if opcode == CHUNK {
            self.report_orphans();
            (self.passed_over, self.section) = (None, Section::Indexes);
            return self
                .mcap_chunk(offset, length.min(here), length > here)
                .map(|()| None);
        }
        if length > here || (length > CHUNK_LIMIT && matches!(opcode, SCHEMA | CHANNEL | MESSAGE)) {
            let what = format!(
                "a record declares {length} bytes; {here} are left, the limit is {CHUNK_LIMIT}"
            );
            return self.mcap_resume(offset, passed_over, &what).map(|()| None);
        }
        self.passed_over.get_or_insert(offset);
        let before = (before, self.section);
        if self.section == Section::Indexes {
            self.section = Section::Data;
        }
        self.mcap_known(opcode, (offset, length), before)
    }

    /// A record of a known kind that is no chunk; `before` are the CRC of what stands before it, and where it is.
    fn mcap_known(
        &mut self,
        opcode: u8,
        (offset, length): (u64, u64),
        (before, section): (Option<u32>, Section),
    ) -> io::Result<Option<Found>> {
        match opcode {
            SCHEMA | CHANNEL | MESSAGE => {
                let mut record = std::mem::take(&mut self.record);
                let read = self.scan.read(length, &mut record);
                self.record = record;
                read?;
                if section == Section::Summary && opcode == MESSAGE {
                    // One bit parts it from a channel of the summary.
                    self.lose(offset, 0, "a message follows the end of the data");
                    return Ok(None);
                }
                if section == Section::Indexes && opcode == MESSAGE && is_index(&self.record) {
                    self.section = Section::Indexes;
                    self.lose(offset, 0, "a chunk's index is marked as a message");
                    return Ok(None);
                }
                let record = std::mem::take(&mut self.record);
                let done = self.mcap_content(opcode, &record, (0, false));
                self.record = record;
                return Ok(done.unwrap_or_else(|what| {
                    self.lose(offset, HEAD + length, what);
                    None
                }));
            }
            HEADER if length <= 1024 => {
                let mut record = Vec::new();
                self.scan.read(length, &mut record)?;
                let profile = Fields(&record).counted().unwrap_or_default();
                self.profile = String::from_utf8_lossy(profile).into_owned();
            }
            MESSAGE_INDEX => self.mcap_index(offset, length)?,
            STATISTICS => self.mcap_statistics(offset, length)?,
            DATA_END => self.mcap_data_end(offset, length, before)?,
            FOOTER => {
                self.scan.skip(length)?;
                let mut end = Vec::new();
                self.scan.read(MAGIC.len() as u64, &mut end)?;
                if end == MAGIC {
                    (self.closed, self.is_complete) = (true, true);
                    self.passed_over = None;
                    self.scan.complete()?;
                } else {
                    self.lose(offset, 0, "the footer is not followed by the magic bytes");
                    self.closed = true;
                    self.scan.go_to(offset + HEAD + length);
                }
            }
            _ => {
                self.attached += u64::from(matches!(opcode, ATTACHMENT | METADATA));
                self.scan.skip(length)?;
            }
        }
        Ok(None)
    }

    /// How many messages of a channel the chunk before has.
    fn mcap_index(&mut self, offset: u64, length: u64) -> io::Result<()> {
        let mut record = Vec::new();
        self.scan.read(length.min(6), &mut record)?;
        let mut fields = Fields(&record);
        if let (Some(_), Some(bytes)) = (fields.u16(), fields.u32())
            && u64::from(bytes) + 6 == length
        {
            self.indexed(u64::from(bytes) / 16);
            (self.passed_over, self.section) = (None, Section::Indexes);
            self.scan.skip(length - 6)?;
            return Ok(());
        }
        // Its length may be what is wrong.
        self.mcap_resume(
            offset,
            None,
            "a chunk's index does not have the length that it declares",
        )
    }

    /// Are all messages there that the file says it holds?
    fn mcap_statistics(&mut self, offset: u64, length: u64) -> io::Result<()> {
        let mut record = Vec::new();
        self.scan.read(length.min(8), &mut record)?;
        self.scan.skip(length.saturating_sub(8))?;
        let found = self.messages;
        if let Some(written) = Fields(&record).u64()
            && written != found
        {
            let what = format!("the file says {written} messages, but {found} were read");
            self.lose(offset, 0, what);
        }
        Ok(())
    }

    /// Is all of the data as it was written? `crc` is that of what stands before.
    fn mcap_data_end(&mut self, offset: u64, length: u64, crc: Option<u32>) -> io::Result<()> {
        let mut record = Vec::new();
        self.scan.read(length.min(4), &mut record)?;
        self.scan.skip(length.saturating_sub(4))?;
        let stored = Fields(&record).u32().unwrap_or(0);
        if length == 4 {
            self.section = Section::Summary;
        }
        if let Some(crc) = crc.filter(|crc| stored != 0 && *crc != stored) {
            let what = format!("the CRC of the data is {crc:08x}, but {stored:08x} is stored");
            self.lose(offset, 0, what);
        }
        Ok(())
    }

    /// Looks for the next chunk after a place that makes no sense, first in what the record at `suspect`
    /// made it pass over.
    fn mcap_resume(&mut self, offset: u64, suspect: Option<u64>, what: &str) -> io::Result<()> {
        self.passed_over = None;
        let from = self.look_again(offset, suspect, 64, is_chunk_or_file)?;
        if self.scan.left() == 0 {
            self.closed = true;
        }
        self.lose(from, self.scan.offset() - from, what);
        Ok(())
    }

    /// Was the record here read before the reading went back? Then so were those behind it, and it stands behind them.
    fn mcap_was_read(&mut self) -> io::Result<bool> {
        let here = self.scan.offset();
        let Some((records, until)) = &mut self.read_before else {
            return Ok(false);
        };
        let until = *until;
        if here >= until {
            self.read_before = None;
            return Ok(false);
        }
        while records.offset() < here {
            let mut head = Fields(records.peek(9)?);
            let length = head.bytes(1).and_then(|_| head.u64()).unwrap_or(0);
            records.go_to(records.offset().saturating_add(HEAD + length));
        }
        let was_read = records.offset() == here;
        if was_read {
            // another one may have swallowed more
            self.passed_over = Some(here);
            self.scan.go_to(until);
            self.read_before = None;
        }
        Ok(was_read)
    }

    fn mcap_chunk(&mut self, offset: u64, length: u64, truncated: bool) -> io::Result<()> {
        let mut record = std::mem::take(&mut self.record);
        let whole = self.scan.read(length, &mut record);
        self.record = record;
        whole?;
        let mut fields = Fields(&self.record);
        let head = (|| {
            fields.bytes(16)?;
            let (declared, crc) = (fields.u64()?, fields.u32()?);
            let packing = fields.counted()?;
            Some((declared, crc, packing, fields.u64()?))
        })();
        let Some((declared, crc, name, packed)) = head else {
            if truncated {
                self.lose(
                    offset,
                    HEAD + length,
                    "the file ends within the head of a chunk",
                );
                return Ok(());
            }
            return self.mcap_pass_chunk(offset, length, "the chunk is too short for its head");
        };
        let Some(packing) = Packing::named(name) else {
            let name = String::from_utf8_lossy(name)
                .chars()
                .take(32)
                .collect::<String>();
            let what = format!("the chunk is compressed as `{name}`, which is not known");
            return self.mcap_pass_chunk(offset, length, &what);
        };
        let rest = fields.0;
        if packed > rest.len() as u64 && !truncated {
            let what = format!(
                "the chunk holds {} bytes, but declares {packed}",
                rest.len()
            );
            return self.mcap_pass_chunk(offset, length, &what);
        }
        // A chunk that declares more bytes than it holds would swallow its neighbours.
        let surplus = (rest.len() as u64).saturating_sub(packed);
        let packed = &rest[..rest
            .len()
            .min(usize::try_from(packed).unwrap_or(usize::MAX))];
        let limit = room_for(declared, packing, &self.scan, &mut self.unfolded);
        let mut content = std::mem::take(&mut self.chunk.content);
        let sizes = (declared, limit);
        let unpacked = self.unpacker.unpack(packing, packed, sizes, &mut content);
        let found = crc32fast::hash(&content);
        self.chunk = Chunk {
            content,
            offset,
            bytes: HEAD + length,
            truncated,
            ..Chunk::default()
        };
        let wrong = if truncated {
            // A length that lies looks like a cut: what stands behind it is looked for.
            let next = if self.scan.is_growing() {
                // A writer that was ended and begins again puts another file behind.
                self.scan.find(offset + 1..u64::MAX, 64, is_chunk_or_file)?
            } else {
                self.scan.find(offset + 1..u64::MAX, 64, is_chunk)?
            };
            self.chunk.bytes = next.unwrap_or(self.scan.offset()) - offset;
            if next.is_none() {
                self.closed = true;
            }
            Some("the file ends within a chunk; its readable part is kept".to_owned())
        } else if let Err(what) = unpacked {
            self.chunk.content.clear();
            Some(what)
        } else if crc != 0 && crc != found {
            self.chunk.content.clear();
            Some(format!(
                "the CRC of the chunk is {found:08x}, but {crc:08x} is stored"
            ))
        } else {
            None
        };
        // A writer that was ended within the chunk, and one that began behind it.
        if wrong.is_some()
            && !truncated
            && let Some(begin) = self.scan.beside(offset).find(
                offset + 1..offset + HEAD + length,
                64,
                is_chunk_or_file,
            )?
        {
            self.scan.go_to(begin);
            self.chunk.bytes = begin - offset;
        } else if surplus > 0 && !truncated {
            self.scan.go_to(offset + HEAD + length - surplus);
            self.chunk.bytes -= surplus;
        }
        if let Some(what) = wrong {
            self.lose_of_chunk(what);
        }
        Ok(())
    }

    /// Passes over a chunk that makes no sense, by its length if a record stands behind it.
    fn mcap_pass_chunk(&mut self, offset: u64, length: u64, what: &str) -> io::Result<()> {
        let left = self.scan.left();
        let mut fields = Fields(self.scan.peek(9)?);
        let opcode = fields.bytes(1).map(|opcode| opcode[0]);
        let behind = fields.u64();
        let sound = opcode.is_some_and(|opcode| (1..=DATA_END).contains(&opcode))
            && behind.is_some_and(|length| length < left);
        if !sound {
            return self.mcap_resume(offset, None, what);
        }
        self.chunk = Chunk {
            offset,
            bytes: HEAD + length,
            ..Chunk::default()
        };
        self.lose_of_chunk(what);
        Ok(())
    }

    /// The next record of the chunk.
    pub(super) fn mcap_in_chunk(&mut self) -> Option<Found> {
        let rest = self.chunk.content.get(self.chunk.at..)?;
        let mut fields = Fields(rest);
        let head = (|| Some((*fields.bytes(1)?.first()?, fields.u64()?)))();
        let whole = head.filter(|(_, length)| *length <= fields.0.len() as u64);
        let Some((opcode, length)) = whole else {
            self.lose_chunk("a record reaches past the end of its chunk");
            return None;
        };
        let length = usize::try_from(length).unwrap_or(0);
        let start = self.chunk.at + 9;
        self.chunk.at = start + length;
        let content = std::mem::take(&mut self.chunk.content);
        let done = self.mcap_content(opcode, &content[start..start + length], (start, true));
        self.chunk.content = content;
        done.unwrap_or_else(|what| {
            self.lose(self.chunk.offset, 0, what);
            None
        })
    }

    /// A record that may stand in a chunk; `base` is its place there.
    pub(super) fn mcap_content(
        &mut self,
        opcode: u8,
        content: &[u8],
        (base, in_chunk): (usize, bool),
    ) -> Result<Option<Found>, String> {
        let mut fields = Fields(content);
        let short = || "a record is too short for its fields".to_owned();
        match opcode {
            SCHEMA => {
                let id = fields.u16().ok_or_else(short)?;
                let name = name_of(fields.counted().ok_or_else(short)?, "the name of a type")?;
                let language = name_of(fields.counted().ok_or_else(short)?, "a schema's language")?;
                let body = fields.counted().ok_or_else(short)?;
                if let Some(old) = self.schemas.get(&id) {
                    if old.name != name || *old.text != *body {
                        return Err(format!(
                            "schema {id} is declared again as another: the first is kept"
                        ));
                    }
                } else if self.schemas.len() >= CHANNEL_LIMIT {
                    return Err(too_many("schemas"));
                } else {
                    let text = self.definition(body)?;
                    self.schemas.insert(
                        id,
                        Schema {
                            name,
                            language,
                            text,
                        },
                    );
                }
                Ok(None)
            }
            CHANNEL => {
                let id = fields.u16().ok_or_else(short)?;
                let schema = fields.u16().ok_or_else(short)?;
                let topic = name_of(fields.counted().ok_or_else(short)?, "a topic")?;
                let encoding_name =
                    name_of(fields.counted().ok_or_else(short)?, "an encoding's name")?;
                let metadata = metadata_of(&mut fields);
                if schema != 0 && !self.schemas.contains_key(&schema) {
                    self.mcap_spare(SCHEMA, schema);
                }
                let schema = match (schema, self.schemas.get(&schema)) {
                    (_, Some(found)) => Some(found),
                    (0, None) => None,
                    (id, None) => {
                        return Err(format!(
                            "channel `{topic}` has schema {id}, which is not there"
                        ));
                    }
                };
                let channel = Channel {
                    type_name: schema.map(|s| s.name.clone()).unwrap_or_default(),
                    definition_language: schema.map(|s| s.language.clone()).unwrap_or_default(),
                    definition: schema.map_or_else(|| [].into(), |s| Arc::clone(&s.text)),
                    encoding: match encoding_name.as_str() {
                        "cdr" => Encoding::Cdr,
                        "ros1" => Encoding::Ros1,
                        "json" => Encoding::Json,
                        _ => Encoding::Other,
                    },
                    topic,
                    encoding_name,
                    metadata,
                };
                self.enter(id.into(), channel).map(|()| None)
            }
            MESSAGE => {
                let id = fields.u16().ok_or_else(short)?;
                let sequence = fields.u32().ok_or_else(short)?;
                let log_time_ns = fields.u64().ok_or_else(short)?;
                let publish_time_ns = fields.u64().ok_or_else(short)?;
                if in_chunk {
                    self.chunk.met += 1;
                }
                if !self.ids.contains_key(&id.into()) {
                    self.mcap_spare(CHANNEL, id);
                }
                let Some(&channel) = self.ids.get(&id.into()) else {
                    self.orphan(id.into());
                    return Ok(None);
                };
                self.messages += 1;
                Ok(Some(Found {
                    channel,
                    log_time_ns,
                    publish_time_ns,
                    sequence,
                    in_chunk,
                    start: base + content.len() - fields.0.len(),
                    end: base + content.len(),
                }))
            }
            _ => Ok(None),
        }
    }
}

/// What a channel says of itself besides. What is too long or no text is left out: it decodes nothing.
fn metadata_of(fields: &mut Fields<'_>) -> BTreeMap<String, String> {
    let mut pairs = Fields(fields.counted().unwrap_or_default());
    let mut metadata = BTreeMap::new();
    while let (Some(key), Some(value)) = (pairs.counted(), pairs.counted()) {
        let fits = key.len() <= METADATA_LIMIT && value.len() <= METADATA_LIMIT;
        if let (true, Ok(key), Ok(value)) =
            (fits, std::str::from_utf8(key), std::str::from_utf8(value))
        {
            metadata.insert(key.to_owned(), value.to_owned());
        }
    }
    metadata
}

/// Is this the content of a message's index?
fn is_index(content: &[u8]) -> bool {
    let mut fields = Fields(content);
    fields.u16();
    let bytes = fields.u32().map_or(0, |bytes| bytes as usize);
    bytes == fields.0.len() && bytes.is_multiple_of(16)
}

const fn is_known(opcode: u8) -> bool {
    (opcode >= 1 && opcode <= DATA_END) || opcode >= 0x80
}

fn is_chunk_or_file(bytes: &[u8], left: u64) -> bool {
    bytes.starts_with(&MAGIC) || is_chunk(bytes, left)
}

/// Does a chunk begin here, by all that its head says?
fn is_chunk(bytes: &[u8], left: u64) -> bool {
    let mut fields = Fields(bytes);
    let check = (|| {
        if *fields.bytes(1)?.first()? != CHUNK {
            return Some(false);
        }
        let length = fields.u64()?;
        fields.bytes(20 + 8)?;
        let name = fields.counted().filter(|name| name.len() <= 4)?;
        let packed = fields.u64()?;
        let head = CHUNK_HEAD + 4 + name.len() as u64 + 8;
        Some(
            Packing::named(name).is_some()
                && length.checked_sub(head) == Some(packed)
                && packed < left,
        )
    })();
    check == Some(true)
}
