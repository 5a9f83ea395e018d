//! ROS 1 bags, from the specification.

use super::{ChunkAt, Plan, TOPICS, Written, body, row, time_ns};

pub(crate) const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

fn header(fields: &[(&str, &[u8])]) -> Vec<u8> {
    let mut out = Vec::new();
    for (name, value) in fields {
        out.extend(
            u32::try_from(name.len() + 1 + value.len())
                .unwrap()
                .to_le_bytes(),
        );
        out.extend(name.as_bytes());
        out.push(b'=');
        out.extend(*value);
    }
    out
}

pub(crate) fn record(out: &mut Vec<u8>, fields: &[(&str, &[u8])], data: &[u8]) {
    super::mcap::counted(out, &header(fields));
    super::mcap::counted(out, data);
}

pub(crate) fn connection(out: &mut Vec<u8>, id: u32, topic: &[u8], type_name: &[u8]) {
    let text: &[u8] = b"uint8[24] numbers\nstring text\n";
    let data = header(&[
        ("topic", topic),
        ("type", type_name),
        ("md5sum", b"0123456789abcdef0123456789abcdef"),
        ("message_definition", text),
    ]);
    let conn = id.to_le_bytes();
    record(
        out,
        &[("op", &[7]), ("conn", &conn), ("topic", topic)],
        &data,
    );
}

pub(crate) fn message(out: &mut Vec<u8>, id: u32, time_ns: u64, data: &[u8]) {
    record(
        out,
        &[
            ("op", &[2]),
            ("conn", &id.to_le_bytes()),
            ("time", &time(time_ns)),
        ],
        data,
    );
}

fn time(ns: u64) -> [u8; 8] {
    let (s, ns) = (ns / 1_000_000_000, ns % 1_000_000_000);
    let (s, ns) = (u32::try_from(s).unwrap(), u32::try_from(ns).unwrap());
    [s.to_le_bytes(), ns.to_le_bytes()]
        .concat()
        .try_into()
        .unwrap()
}

/// The record at the start, of 4096 bytes whatever it says.
pub(crate) fn bag_header(index: u64, chunks: u32) -> Vec<u8> {
    let head = header(&[
        ("op", &[3]),
        ("index_pos", &index.to_le_bytes()),
        ("conn_count", &2_u32.to_le_bytes()),
        ("chunk_count", &chunks.to_le_bytes()),
    ]);
    let mut out = Vec::new();
    super::mcap::counted(&mut out, &head);
    super::mcap::counted(&mut out, &vec![b' '; 4096 - 8 - head.len()]);
    out
}

pub(crate) fn write(plan: Plan) -> Written {
    let mut out = MAGIC.to_vec();
    let header_at = out.len();
    out.extend(bag_header(0, 0));
    let (mut rows, mut chunks) = (Vec::new(), Vec::new());
    while out.len() < plan.bytes {
        let (mut content, mut ends) = (Vec::new(), Vec::new());
        let first = rows.len();
        if first == 0 {
            for (id, (topic, type_name)) in (0..).zip(TOPICS) {
                connection(&mut content, id, topic.as_bytes(), type_name.as_bytes());
            }
        }
        let mut indexes = [Vec::new(), Vec::new()];
        while content.len() < plan.chunk {
            let k = rows.len();
            indexes[k % 2].extend(time(time_ns(k)));
            indexes[k % 2].extend(u32::try_from(content.len()).unwrap().to_le_bytes());
            let id = u32::try_from(k % 2).unwrap();
            message(&mut content, id, time_ns(k), &body(k, plan.alike));
            ends.push(content.len());
            rows.push(row(k, plan.alike));
        }
        let begin = out.len();
        let packed = plan.packing.pack(&content);
        let size = u32::try_from(content.len()).unwrap().to_le_bytes();
        let name = plan.packing.names().1.as_bytes();
        record(
            &mut out,
            &[("op", &[5]), ("compression", name), ("size", &size)],
            &packed,
        );
        let record_end = out.len();
        for (id, index) in (0_u32..).zip(&indexes) {
            let count = u32::try_from(index.len() / 12).unwrap().to_le_bytes();
            let (version, conn) = (1_u32.to_le_bytes(), id.to_le_bytes());
            let fields: [(&str, &[u8]); 4] = [
                ("op", &[4]),
                ("ver", &version),
                ("conn", &conn),
                ("count", &count),
            ];
            record(&mut out, &fields, index);
        }
        chunks.push(ChunkAt {
            record: begin..record_end,
            packed: record_end - packed.len()..record_end,
            with_index: begin..out.len(),
            rows: first..rows.len(),
            ends,
            content_bytes: content.len(),
        });
    }
    let index = bag_header(out.len() as u64, u32::try_from(chunks.len()).unwrap());
    for (id, (topic, type_name)) in (0..).zip(TOPICS) {
        connection(&mut out, id, topic.as_bytes(), type_name.as_bytes());
    }
    for chunk in &chunks {
        let at = (chunk.record.start as u64).to_le_bytes();
        let (first, last) = (
            time(time_ns(chunk.rows.start)),
            time(time_ns(chunk.rows.end - 1)),
        );
        let (version, count) = (1_u32.to_le_bytes(), 2_u32.to_le_bytes());
        let mut counts = Vec::new();
        for id in 0..2 {
            let of = chunk.rows.clone().filter(|k| k % 2 == id).count();
            counts.extend(u32::try_from(id).unwrap().to_le_bytes());
            counts.extend(u32::try_from(of).unwrap().to_le_bytes());
        }
        let fields: [(&str, &[u8]); 6] = [
            ("op", &[6]),
            ("ver", &version),
            ("chunk_pos", &at),
            ("start_time", &first),
            ("end_time", &last),
            ("count", &count),
        ];
        record(&mut out, &fields, &counts);
    }
    out[header_at..header_at + 4096].copy_from_slice(&index);
    Written {
        bytes: out,
        rows,
        chunks,
        packing: plan.packing,
    }
}
