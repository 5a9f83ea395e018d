//! The records of ROS 1 bags, version 2.0.

use std::io;

use super::scan::Scan;
use super::unpack::Packing;
use super::{
    CHUNK_LIMIT, Channel, Chunk, Container, Encoding, Fields, Found, SWALLOWED, name_of, room_for,
};

pub(super) const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

const MESSAGE: u8 = 2;
const BAG_HEADER: u8 = 3;
const INDEX: u8 = 4;
const CHUNK: u8 = 5;
const CHUNK_INFO: u8 = 6;
pub(super) const CONNECTION: u8 = 7;
/// The maximum size of a record's header, bytes.
const HEADER_LIMIT: u64 = 1 << 20;
/// Bytes of an entry of an index, and of an entry of a chunk's information.
const INDEX_ENTRY: u64 = 12;
const CHUNK_INFO_ENTRY: u64 = 8;
/// How long the header of a chunk may be for it to be found after damage, bytes.
const CHUNK_HEADER: usize = 96;
const CHUNK_FIELDS: std::ops::Range<u32> = 16..88;

/// One field of a header, by name.
fn field<'a>(header: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    let mut fields = Fields(header);
    while let Some(pair) = fields.counted() {
        let at = pair.iter().position(|byte| *byte == b'=')?;
        if &pair[..at] == name {
            return Some(&pair[at + 1..]);
        }
    }
    None
}

pub(super) fn number(header: &[u8], name: &[u8]) -> Option<u32> {
    field(header, name).and_then(|bytes| Fields(bytes).u32())
}

pub(super) fn opcode(header: &[u8]) -> Option<u8> {
    match field(header, b"op")? {
        [op] => Some(*op),
        _ => None,
    }
}

impl Container {
    /// Waits in a bag that is still written until the next record is whole. A recorder writes the length of a chunk
    /// when it closes it: until then it is zero.
    fn bag_wait(&mut self) -> io::Result<()> {
        while self.scan.is_growing() {
            self.scan.wait(4)?;
            let length = u64::from(Fields(self.scan.peek(4)?).u32().unwrap_or(0));
            // no record, or another bag: its magic bytes are a great number
            if length > HEADER_LIMIT {
                return Ok(());
            }
            self.scan.wait(length + 8)?;
            let mut beside = self.scan.beside(self.scan.offset() + 4);
            let (mut header, mut head) = (Vec::new(), Vec::new());
            beside.read(length, &mut header)?;
            beside.read(4, &mut head)?;
            let data = u64::from(Fields(&head).u32().unwrap_or(0));
            let is_open = data == 0 && opcode(&header) == Some(CHUNK);
            // the next growth, or a chunk behind this one
            let whole = if is_open {
                self.scan.left() + 1
            } else {
                length + 8 + data
            };
            let is_cut = self.scan.wait_for_record(whole, CHUNK_HEADER, is_chunk)?;
            self.scan.look_again();
            if !is_open || is_cut {
                break;
            }
        }
        Ok(())
    }

    /// One record from the file.
    pub(super) fn bag_record(&mut self) -> io::Result<Option<Found>> {
        if self.scan.is_growing() {
            self.bag_wait()?;
        }
        let offset = self.scan.offset();
        if self.scan.left() == 0 {
            if let Some(suspect) = self.passed_over.take()
                && self.swallowed(suspect, offset, CHUNK_HEADER, is_chunk)?
            {
                self.lose(suspect, self.scan.offset() - suspect, SWALLOWED);
                return Ok(None);
            }
            self.ended = true;
            self.bag_end(offset);
            return Ok(None);
        }
        if self.scan.stands(MAGIC)? {
            // A second bag behind the first.
            self.bag_end(offset);
            self.begin_file(offset);
            (self.chunks, self.promised_chunks, self.index_at) = (0, None, None);
            self.scan.skip(MAGIC.len() as u64)?;
            return Ok(None);
        }
        let suspect = self.passed_over;
        let mut head = Vec::new();
        if !self.scan.read(4, &mut head)? {
            return self.bag_resume(offset, suspect, "the file ends within a record");
        }
        let length = u64::from(Fields(&head).u32().unwrap_or(0));
        if length > HEADER_LIMIT {
            let what =
                format!("a header declares {length} bytes, more than the limit of {HEADER_LIMIT}");
            return self.bag_resume(offset, suspect, &what);
        }
        let mut header = Vec::new();
        if !self.scan.read(length, &mut header)? {
            return self.bag_resume(offset, suspect, "the file ends within a header");
        }
        let Some(op) = opcode(&header) else {
            return self.bag_resume(offset, suspect, "no record begins here");
        };
        if !self.scan.read(4, &mut head)? {
            return self.bag_resume(offset, suspect, "the file ends within a record");
        }
        let length = u64::from(Fields(&head).u32().unwrap_or(0));
        let left = self.scan.left();
        let truncated = length > left;
        if op == CHUNK {
            self.bag_chunk(offset, &header, length.min(left), truncated)?;
            // One that declares too much swallows its neighbours, which shows behind it.
            self.passed_over = Some(offset);
            return Ok(None);
        }
        if truncated || (length > CHUNK_LIMIT && matches!(op, MESSAGE | CONNECTION)) {
            let what = format!(
                "a record declares {length} bytes; {left} are left, the limit is {CHUNK_LIMIT}"
            );
            return self.bag_resume(offset, suspect, &what);
        }
        let count = u64::from(number(&header, b"count").unwrap_or(0));
        let entry = match op {
            INDEX => INDEX_ENTRY,
            CHUNK_INFO => CHUNK_INFO_ENTRY,
            _ => 0,
        };
        if entry == 0 || count * entry != length {
            // Its length may be what is wrong, if nothing makes sense behind it.
            self.passed_over.get_or_insert(offset);
        } else {
            self.passed_over = None;
        }
        if op == INDEX {
            self.indexed(count);
        } else {
            self.settle();
        }
        match op {
            MESSAGE | CONNECTION => {
                let mut record = std::mem::take(&mut self.record);
                let read = self.scan.read(length, &mut record);
                self.record = record;
                read?;
                let record = std::mem::take(&mut self.record);
                let done = self.bag_content(op, &header, &record, (0, false));
                self.record = record;
                return Ok(done.unwrap_or_else(|what| {
                    self.lose(offset, self.scan.offset() - offset, what);
                    None
                }));
            }
            BAG_HEADER => {
                self.bag_header(&header)?;
            }
            CHUNK_INFO if self.scan.is_growing() => return self.bag_closed(offset, length),
            INDEX | CHUNK_INFO => {}
            _ => {
                let what = format!("the record's kind {op} is not known");
                return self.bag_resume(offset, suspect, &what);
            }
        }
        self.scan.skip(length)?;
        Ok(None)
    }

    /// The index of a bag that was still written: it is written last; another bag may follow.
    fn bag_closed(&mut self, offset: u64, length: u64) -> io::Result<Option<Found>> {
        // the header was read before it said so
        self.index_at = Some(offset);
        self.scan.skip(length)?;
        self.scan.complete()?;
        self.ended = !self.scan.is_growing();
        Ok(None)
    }

    /// What the record at the start says of the whole: nothing until the bag is closed.
    fn bag_header(&mut self, header: &[u8]) -> io::Result<()> {
        self.promised_chunks = number(header, b"chunk_count").map(u64::from);
        self.index_at = field(header, b"index_pos").and_then(|bytes| Fields(bytes).u64());
        if self.index_at.is_some_and(|at| at > 0) {
            self.is_complete = true;
            self.scan.complete()?;
        }
        Ok(())
    }

    /// Was the bag closed, and are all chunks there?
    fn bag_end(&mut self, offset: u64) {
        let (chunks, promised) = (self.chunks, self.promised_chunks);
        match (self.index_at, promised) {
            (Some(at), Some(promised)) if at > 0 && chunks < promised => {
                self.lose(
                    offset,
                    0,
                    format!("the bag promises {promised} chunks, but {chunks} are there"),
                );
            }
            (Some(0) | None, _) => {
                self.lose(offset, 0, "the bag was not closed: it has no index");
            }
            _ => {}
        }
    }

    /// Looks for the next chunk after a place that makes no sense, first in what the record at `suspect`
    /// made it pass over.
    fn bag_resume(
        &mut self,
        offset: u64,
        suspect: Option<u64>,
        what: &str,
    ) -> io::Result<Option<Found>> {
        self.passed_over = None;
        let from = self.look_again(offset, suspect, CHUNK_HEADER, is_chunk)?;
        self.lose(from, self.scan.offset() - from, what);
        Ok(None)
    }

    fn bag_chunk(
        &mut self,
        offset: u64,
        header: &[u8],
        length: u64,
        truncated: bool,
    ) -> io::Result<()> {
        self.settle();
        self.report_orphans();
        self.chunks += 1;
        let packing = field(header, b"compression").and_then(Packing::named);
        let (Some(packing), Some(declared)) = (packing, number(header, b"size")) else {
            // By its length, if a record stands behind it.
            let what = "the chunk's compression or size is not known";
            self.scan.skip(length)?;
            if !is_record(self.scan.peek(64)?) {
                return self.bag_resume(offset, None, what).map(|_| ());
            }
            self.chunk = Chunk {
                offset,
                bytes: self.scan.offset() - offset,
                ..Chunk::default()
            };
            self.lose_of_chunk(what);
            return Ok(());
        };
        let mut record = std::mem::take(&mut self.record);
        let read = self.scan.read(length, &mut record);
        self.record = record;
        read?;
        let mut content = std::mem::take(&mut self.chunk.content);
        let declared = u64::from(declared);
        let limit = room_for(declared, packing, &self.scan, &mut self.unfolded);
        let sizes = (declared, limit);
        let unpacked = self
            .unpacker
            .unpack(packing, &self.record, sizes, &mut content);
        self.chunk = Chunk {
            content,
            offset,
            bytes: self.scan.offset() - offset,
            truncated,
            ..Chunk::default()
        };
        if truncated {
            // A length that lies looks like a cut: what stands behind it is looked for.
            self.scan
                .find(offset + 1..u64::MAX, CHUNK_HEADER, is_chunk)?;
            self.chunk.bytes = self.scan.offset() - offset;
            self.lose_of_chunk("the file ends within a chunk; its readable part is kept");
        } else if let Err(what) = unpacked {
            if packing == Packing::None {
                // Only its size contradicts: its messages are there.
                self.chunk.truncated = true;
            } else {
                // Where it is wrong is not known: none of it is believed.
                self.chunk.content.clear();
            }
            self.lose_of_chunk(what);
        }
        Ok(())
    }

    /// The next record of the chunk.
    pub(super) fn bag_in_chunk(&mut self) -> Option<Found> {
        let content = std::mem::take(&mut self.chunk.content);
        let rest = content.get(self.chunk.at..).unwrap_or_default();
        let mut fields = Fields(rest);
        let parts = (|| Some((fields.counted()?, fields.counted()?)))();
        let done = parts.map(|(header, data)| {
            let end = content.len() - fields.0.len();
            let start = end - data.len();
            self.chunk.at = end;
            match opcode(header) {
                Some(op) => self.bag_content(op, header, data, (start, true)),
                None => Err("a record of the chunk has no kind".to_owned()),
            }
        });
        self.chunk.content = content;
        match done {
            None => {
                self.lose_chunk("a record reaches past the end of its chunk");
                None
            }
            Some(done) => done.unwrap_or_else(|what| {
                self.lose(self.chunk.offset, 0, what);
                None
            }),
        }
    }

    pub(super) fn bag_content(
        &mut self,
        op: u8,
        header: &[u8],
        data: &[u8],
        (start, in_chunk): (usize, bool),
    ) -> Result<Option<Found>, String> {
        let id = || number(header, b"conn").ok_or("a record names no connection");
        match op {
            CONNECTION => {
                let id = id()?;
                let name = |bytes: Option<&[u8]>, what| {
                    let bytes = bytes.ok_or_else(|| format!("connection {id} has no {what}"))?;
                    name_of(bytes, &format!("the {what} of connection {id}"))
                };
                let channel = Channel {
                    topic: name(field(header, b"topic"), "topic")?,
                    type_name: name(field(data, b"type"), "type")?,
                    encoding: Encoding::Ros1,
                    encoding_name: "ros1".to_owned(),
                    definition_language: "ros1msg".to_owned(),
                    metadata: [("md5sum", 64), ("callerid", 1024), ("latching", 8)]
                        .into_iter()
                        .filter_map(|(key, limit)| {
                            let bytes = field(data, key.as_bytes())?;
                            let text = std::str::from_utf8(bytes).ok()?;
                            (text.len() <= limit).then(|| (key.to_owned(), text.to_owned()))
                        })
                        .collect(),
                    definition: self
                        .definition(field(data, b"message_definition").unwrap_or_default())?,
                };
                self.enter(id, channel).map(|()| None)
            }
            MESSAGE => {
                let id = id()?;
                let mut time = Fields(field(header, b"time").unwrap_or_default());
                let (Some(s), Some(ns)) = (time.u32(), time.u32()) else {
                    return Err("a message has no time".to_owned());
                };
                if in_chunk {
                    self.chunk.met += 1;
                }
                if !self.ids.contains_key(&id) {
                    self.bag_spare(id);
                }
                let Some(&channel) = self.ids.get(&id) else {
                    self.orphan(id);
                    return Ok(None);
                };
                let time_ns = u64::from(s) * 1_000_000_000 + u64::from(ns);
                Ok(Some(Found {
                    channel,
                    log_time_ns: time_ns,
                    publish_time_ns: time_ns,
                    sequence: 0,
                    in_chunk,
                    start,
                    end: start + data.len(),
                }))
            }
            _ => Ok(None),
        }
    }
}

/// One small record with its header; whether there is one.
pub(super) fn record(
    scan: &mut Scan,
    header: &mut Vec<u8>,
    data: &mut Vec<u8>,
) -> io::Result<bool> {
    let mut length = Vec::new();
    for part in [header, data] {
        scan.read(4, &mut length)?;
        let Some(length) = Fields(&length).u32() else {
            return Ok(false);
        };
        if !scan.read(length.into(), part)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Does a record begin here, by its header's first field?
fn is_record(bytes: &[u8]) -> bool {
    let mut fields = Fields(bytes);
    let length = fields.u32().unwrap_or(0);
    let first = fields.counted().unwrap_or_default();
    u64::from(length) <= HEADER_LIMIT && first.len() < length as usize && first.contains(&b'=')
}

/// Does a chunk begin here, by all that its header says?
fn is_chunk(bytes: &[u8], left: u64) -> bool {
    let mut fields = Fields(bytes);
    let check = (|| {
        // Cheap: the header of a chunk is short, and its first field too.
        let length = fields
            .u32()
            .filter(|length| CHUNK_FIELDS.contains(length))?;
        let header = fields.bytes(length as usize)?;
        let data = fields.u32()?;
        Some(
            opcode(header) == Some(CHUNK)
                && field(header, b"compression")
                    .and_then(Packing::named)
                    .is_some()
                && number(header, b"size").is_some()
                && u64::from(data) < left,
        )
    })();
    check == Some(true)
}

#[cfg(test)]
mod tests {
    use super::{HEADER_LIMIT, is_chunk, is_record};

    #[test]
    fn a_record_begins_with_a_field_that_has_a_name() {
        let begins = |length: u32, first: &[u8]| {
            let count = u32::try_from(first.len()).unwrap().to_le_bytes();
            is_record(&[&length.to_le_bytes(), &count[..], first].concat())
        };
        let limit = u32::try_from(HEADER_LIMIT).unwrap();
        assert!(begins(10, b"op=\x02") && begins(limit, b"op=\x02") && begins(5, b"op=\x02"));
        assert!(!begins(limit + 1, b"op=\x02"));
        assert!(!begins(4, b"op=\x02") && !begins(3, b"op=\x02"));
        assert!(!begins(10, b"op:\x02") && !begins(10, b""));
        assert!(!is_record(&[10, 0, 0, 0, 40, 0, 0, 0, b'=']) && !is_record(b""));
    }
    #[test]
    fn a_chunk_has_its_packing_its_size_and_room() {
        let begins = |fields: &[&[u8]], data: u32, left: u64| {
            let mut header = Vec::new();
            for field in fields {
                header.extend(u32::try_from(field.len()).unwrap().to_le_bytes());
                header.extend(*field);
            }
            let length = u32::try_from(header.len()).unwrap().to_le_bytes();
            is_chunk(&[&length[..], &header, &data.to_le_bytes()].concat(), left)
        };
        let (op, packing, size) = (&b"op=\x05"[..], &b"compression=lz4"[..], &b"size=1234"[..]);
        assert!(begins(&[op, packing, size], 99, 100));
        assert!(!begins(&[op, packing, size], 100, 100));
        assert!(!begins(&[b"op=\x04", packing, size], 99, 100));
        assert!(!begins(&[op, b"compression=zip", size], 99, 100));
        assert!(!begins(&[op, packing, b"size=123"], 99, 100));
        assert!(!begins(&[op, packing, size, &[b'='; 60]], 99, 200));
        assert!(!begins(&[op], 99, 100));
    }
}
