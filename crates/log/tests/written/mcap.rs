//! MCAP, from the specification.

use super::{ChunkAt, Packing, Plan, TOPICS, Written, body, row, time_ns};

pub(crate) const MAGIC: &[u8] = b"\x89MCAP0\r\n";

pub(crate) fn counted(out: &mut Vec<u8>, bytes: &[u8]) {
    out.extend(u32::try_from(bytes.len()).unwrap().to_le_bytes());
    out.extend(bytes);
}

pub(crate) fn record(out: &mut Vec<u8>, opcode: u8, content: &[u8]) {
    out.push(opcode);
    out.extend((content.len() as u64).to_le_bytes());
    out.extend(content);
}

pub(crate) fn schema(out: &mut Vec<u8>, id: u16, name: &[u8], text: &[u8]) {
    let mut content = id.to_le_bytes().to_vec();
    counted(&mut content, name);
    counted(&mut content, b"ros1msg");
    counted(&mut content, text);
    record(out, 3, &content);
}

pub(crate) fn channel(out: &mut Vec<u8>, id: u16, schema: u16, topic: &[u8], encoding: &[u8]) {
    let mut content = [id.to_le_bytes(), schema.to_le_bytes()].concat();
    counted(&mut content, topic);
    counted(&mut content, encoding);
    content.extend([0; 4]);
    record(out, 4, &content);
}

pub(crate) fn message(out: &mut Vec<u8>, channel: u16, time_ns: u64, data: &[u8]) {
    let mut content = channel.to_le_bytes().to_vec();
    content.extend([0; 4]);
    content.extend(time_ns.to_le_bytes());
    content.extend(time_ns.to_le_bytes());
    content.extend(data);
    record(out, 5, &content);
}

/// A chunk's record; where its packed content begins in it.
pub(crate) fn chunk(out: &mut Vec<u8>, packing: Packing, content: &[u8]) -> usize {
    let mut record_content = [0; 16].to_vec();
    record_content.extend((content.len() as u64).to_le_bytes());
    record_content.extend(crc32fast::hash(content).to_le_bytes());
    counted(&mut record_content, packing.names().0.as_bytes());
    let packed = packing.pack(content);
    record_content.extend((packed.len() as u64).to_le_bytes());
    let start = out.len() + 9 + record_content.len();
    record_content.extend(packed);
    record(out, 6, &record_content);
    start
}

/// Schemas and channels of both topics.
pub(crate) fn declare(out: &mut Vec<u8>) {
    for (k, (topic, type_name)) in TOPICS.iter().enumerate() {
        let id = u16::try_from(k + 1).unwrap();
        schema(
            out,
            id,
            type_name.as_bytes(),
            b"uint8[24] numbers\nstring text\n",
        );
        channel(out, id, id, topic.as_bytes(), b"ros1");
    }
}

/// From here to the end: data end, summary, footer.
pub(crate) fn finish(out: &mut Vec<u8>, messages: usize) {
    let crc = crc32fast::hash(out);
    record(out, 15, &crc.to_le_bytes());
    let start = out.len();
    declare(out);
    let mut statistics = (messages as u64).to_le_bytes().to_vec();
    statistics.extend([0; 34]);
    record(out, 11, &statistics);
    let mut footer = vec![2];
    footer.extend(20_u64.to_le_bytes());
    footer.extend((start as u64).to_le_bytes());
    footer.extend([0; 8]);
    out.extend(footer);
    let crc = crc32fast::hash(&out[start..]);
    out.extend(crc.to_le_bytes());
    out.extend(MAGIC);
}

pub(crate) fn write(plan: Plan) -> Written {
    let mut out = MAGIC.to_vec();
    let mut header = Vec::new();
    counted(&mut header, b"ros1");
    counted(&mut header, b"a test");
    record(&mut out, 1, &header);
    let (mut rows, mut chunks) = (Vec::new(), Vec::new());
    while out.len() < plan.bytes {
        let (mut content, mut ends) = (Vec::new(), Vec::new());
        let first = rows.len();
        if first == 0 {
            declare(&mut content);
        }
        let mut indexes = [Vec::new(), Vec::new()];
        while content.len() < plan.chunk {
            let k = rows.len();
            indexes[k % 2].extend(time_ns(k).to_le_bytes());
            indexes[k % 2].extend((content.len() as u64).to_le_bytes());
            let id = u16::try_from(k % 2 + 1).unwrap();
            message(&mut content, id, time_ns(k), &body(k, plan.alike));
            ends.push(content.len());
            rows.push(row(k, plan.alike));
        }
        let begin = out.len();
        let packed = chunk(&mut out, plan.packing, &content);
        let record_end = out.len();
        for (k, index) in indexes.iter().enumerate() {
            let mut entry = u16::try_from(k + 1).unwrap().to_le_bytes().to_vec();
            counted(&mut entry, index);
            record(&mut out, 7, &entry);
        }
        chunks.push(ChunkAt {
            record: begin..record_end,
            packed: packed..record_end,
            with_index: begin..out.len(),
            rows: first..rows.len(),
            ends,
            content_bytes: content.len(),
        });
    }
    finish(&mut out, rows.len());
    Written {
        bytes: out,
        rows,
        chunks,
        packing: plan.packing,
    }
}
