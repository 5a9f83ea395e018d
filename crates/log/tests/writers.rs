//! What is written: every field of an MCAP file by a reader of its own, heads of bags, tables to the byte, and what a copy
//! says of itself.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, ErrorKind};
use std::path::Path;

use grouser_log::container::{Channel, Container, Encoding, Event, Format};
use grouser_log::write::{BagWriter, McapWriter, Times, copy, write_table};
use grouser_log::{Error, series};

use crate::scratch::Folder;
use crate::written::mcap;

fn channel(topic: &str, type_name: &str, definition: &str) -> Channel {
    Channel {
        topic: topic.into(),
        type_name: type_name.into(),
        encoding: Encoding::Ros1,
        encoding_name: "ros1".into(),
        definition_language: "ros1msg".into(),
        definition: definition.as_bytes().into(),
        metadata: BTreeMap::new(),
    }
}

/// Fields from the front of some bytes.
struct Front<'a>(&'a [u8]);

impl<'a> Front<'a> {
    fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count);
        self.0 = rest;
        taken
    }

    fn number(&mut self, bytes: usize) -> u64 {
        let number = |sum: u64, byte: &u8| (sum << 8) | u64::from(*byte);
        self.take(bytes).iter().rev().fold(0, number)
    }

    fn place(&mut self, bytes: usize) -> usize {
        usize::try_from(self.number(bytes)).unwrap()
    }

    fn text(&mut self) -> &'a [u8] {
        let count = self.place(4);
        self.take(count)
    }

    /// Opcode and content of a record.
    fn record(&mut self) -> (u8, Front<'a>) {
        let opcode = self.take(1)[0];
        let count = self.place(8);
        (opcode, Front(self.take(count)))
    }
}

#[test]
#[allow(clippy::too_many_lines, reason = "one arm a kind of record")]
fn every_number_of_an_mcap_file_is_that_of_its_place() {
    let mut writer = McapWriter::new(Vec::new(), "ros1").unwrap();
    let all = [
        channel("/a", "a/A", "bool a\n"),
        channel("/b", "a/B", ""),
        channel("/c", "", ""),
    ];
    let ids = all
        .each_ref()
        .map(|channel| writer.channel(channel).unwrap());
    assert_eq!(ids, [0, 1, 2]);
    assert_eq!(writer.channel(&all[1]).unwrap(), 1);
    // chunks of a second: two messages, one, and one of the third channel
    let second = 1_000_000_000;
    let messages = [
        (0, 5 * second, 1),
        (1, 6 * second, 2),
        (0, 7 * second, 3),
        (2, 7 * second + 1, 4),
    ];
    for (channel, time, sequence) in messages {
        let mut times = Times::at(time);
        (times.publish_ns, times.sequence) = (time + 7, sequence);
        writer.message(ids[channel], times, b"data").unwrap();
    }
    let refused = writer.message(3, Times::at(1), b"").unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::InvalidInput);
    let file = writer.finish().unwrap();
    let magic = mcap::MAGIC.len();
    let footer = file.len() - magic - 29;
    let (opcode, mut fields) = Front(&file[footer..]).record();
    let (summary, offsets) = (fields.place(8), fields.place(8));
    assert_eq!(
        (opcode, fields.number(4)),
        (2, u64::from(crc32fast::hash(&file[summary..footer + 25])))
    );
    // the data: chunks with their indexes
    let mut rest = Front(&file[magic..summary]);
    let (mut found, mut chunks, mut before) = (Vec::new(), Vec::new(), Vec::new());
    while !rest.0.is_empty() {
        let at = summary - rest.0.len();
        let (opcode, mut fields) = rest.record();
        match opcode {
            6 => {
                let span = (fields.number(8), fields.number(8));
                let (length, crc) = (fields.place(8), fields.number(4));
                assert_eq!(fields.text(), b"lz4");
                let packed = fields.place(8);
                assert_eq!(fields.0.len(), packed);
                let mut content = Vec::new();
                let mut decoder = lz4_flex::frame::FrameDecoder::new(fields.0);
                std::io::Read::read_to_end(&mut decoder, &mut content).unwrap();
                assert_eq!(
                    (content.len(), u64::from(crc32fast::hash(&content))),
                    (length, crc)
                );
                let next = summary - rest.0.len();
                chunks.push((span, at, next - at, Vec::new(), 0, packed, length));
                before = content;
            }
            7 => {
                let chunk = chunks.last_mut().unwrap();
                let id = fields.number(2);
                chunk.3.push((id, at));
                chunk.4 += summary - rest.0.len() - at;
                let mut places = Front(fields.text());
                while !places.0.is_empty() {
                    let (time, place) = (places.number(8), places.place(8));
                    // there stands the message of this channel and time
                    let (opcode, mut message) = Front(&before[place..]).record();
                    assert_eq!((opcode, message.number(2)), (5, id));
                    let sequence = message.number(4);
                    assert_eq!((message.number(8), message.number(8)), (time, time + 7));
                    assert_eq!(message.0, b"data");
                    found.push((
                        usize::try_from(id).unwrap(),
                        time,
                        u32::try_from(sequence).unwrap(),
                    ));
                }
            }
            15 => assert_eq!(fields.number(4), u64::from(crc32fast::hash(&file[..at]))),
            _ => {}
        }
    }
    assert_eq!(found, messages);
    let spans: Vec<_> = chunks.iter().map(|chunk| chunk.0).collect();
    let last = 7 * second + 1;
    assert_eq!(
        spans,
        [
            (5 * second, 6 * second),
            (7 * second, 7 * second),
            (last, last)
        ]
    );
    // the summary says the same
    let mut rest = Front(&file[summary..footer]);
    let (mut schemas, mut channels, mut indexes, mut groups, mut starts) = (
        Vec::new(),
        Vec::new(),
        Vec::new(),
        Vec::new(),
        BTreeMap::new(),
    );
    while !rest.0.is_empty() {
        let at = footer - rest.0.len();
        let (opcode, mut fields) = rest.record();
        let end = footer - rest.0.len();
        assert_eq!(opcode == 14, at >= offsets);
        if opcode != 14 {
            starts.entry(opcode).or_insert((at, end)).1 = end;
        }
        match opcode {
            3 => schemas.push((fields.number(2), fields.text().to_vec())),
            4 => channels.push((fields.number(2), fields.number(2), fields.text().to_vec())),
            11 => {
                let counts = [8, 2, 4, 4, 4, 4, 8, 8].map(|bytes| fields.number(bytes));
                assert_eq!(
                    counts,
                    [
                        4,
                        2,
                        3,
                        0,
                        0,
                        chunks.len() as u64,
                        5 * second,
                        7 * second + 1
                    ]
                );
                let mut each = Front(fields.text());
                let each: Vec<_> = (0..3).map(|_| (each.number(2), each.number(8))).collect();
                assert_eq!(each, [(0, 2), (1, 1), (2, 1)]);
            }
            8 => {
                let span = (fields.number(8), fields.number(8));
                let (start, length) = (fields.place(8), fields.place(8));
                let mut places = Front(fields.text());
                let mut of = Vec::new();
                while !places.0.is_empty() {
                    of.push((places.number(2), places.place(8)));
                }
                let index = fields.place(8);
                assert_eq!(fields.text(), b"lz4");
                indexes.push((
                    span,
                    start,
                    length,
                    of,
                    index,
                    fields.place(8),
                    fields.place(8),
                ));
            }
            14 => groups.push((fields.take(1)[0], fields.place(8), fields.place(8))),
            _ => panic!("{opcode}"),
        }
    }
    assert_eq!(indexes, chunks);
    assert_eq!(schemas, [(1, b"a/A".to_vec()), (2, b"a/B".to_vec())]);
    assert_eq!(
        channels,
        [
            (0, 1, b"/a".to_vec()),
            (1, 2, b"/b".to_vec()),
            (2, 0, b"/c".to_vec())
        ]
    );
    let expected: Vec<_> = [3, 4, 11, 8]
        .map(|opcode| {
            (
                opcode,
                starts[&opcode].0,
                starts[&opcode].1 - starts[&opcode].0,
            )
        })
        .to_vec();
    assert_eq!(groups, expected);
}

/// How many chunks a bag says it has, and how many bytes the messages of its chunks take.
fn chunks(messages: &[(u64, usize)]) -> u64 {
    let mut writer = BagWriter::new(Cursor::new(Vec::new())).unwrap();
    let id = writer.channel(&channel("/a", "a/A", "")).unwrap();
    for (time, size) in messages {
        writer
            .message(id, Times::at(*time), &vec![0; *size])
            .unwrap();
    }
    let file = writer.finish().unwrap().into_inner();
    let name = b"chunk_count=";
    let at = file
        .windows(name.len())
        .position(|bytes| bytes == name)
        .unwrap();
    Front(&file[at + name.len()..]).number(4)
}

#[test]
fn a_chunk_is_closed_after_a_second_or_a_mebibyte() {
    let second = 1_000_000_000;
    assert_eq!(
        chunks(&[(5, 4), (second + 4, 4), (second + 5, 4), (second + 6, 4)]),
        2
    );
    assert_eq!(chunks(&[(5, 4), (second + 4, 4), (second + 4, 4)]), 1);
    // the connection and the head of a message stand before the data
    let (id, time, op) = (4 + 9, 4 + 13, 4 + 4);
    let head = 4 + op + id + time + 4;
    let connection = (4 + op + id + 4 + 8) + 4 + (4 + 8) + (4 + 8) + (4 + 8) + (4 + 19);
    let room = (1 << 20) - connection - head;
    assert_eq!(chunks(&[(5, room - 1), (5, 4)]), 1);
    assert_eq!(chunks(&[(5, room), (5, 4)]), 2);
}

#[test]
fn a_bag_has_a_sum_for_every_connection_and_its_channels_alone() {
    let mut writer = BagWriter::new(Cursor::new(Vec::new())).unwrap();
    let mut said = channel("/b", "a/B", "");
    said.metadata =
        BTreeMap::from(["md5sum", "callerid", "other"].map(|key| (key.to_owned(), key.to_owned())));
    let ids = [channel("/a", "a/A", ""), said]
        .each_ref()
        .map(|channel| writer.channel(channel).unwrap());
    for id in ids {
        writer.message(id, Times::at(5), b"").unwrap();
    }
    let refused = writer.message(2, Times::at(5), b"").unwrap_err();
    assert_eq!(refused.kind(), ErrorKind::InvalidInput);
    let mut json = channel("/c", "", "");
    json.encoding = Encoding::Json;
    assert_eq!(
        writer.channel(&json).unwrap_err().kind(),
        ErrorKind::InvalidInput
    );
    let file = writer.finish().unwrap();
    let mut container = Container::over("bag".as_ref(), file).unwrap();
    while container.next().is_some() {}
    let metadata: Vec<_> = container
        .channels()
        .iter()
        .map(|channel| channel.metadata.clone())
        .collect();
    let of = |pairs: &[(&str, &str)]| {
        pairs
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
            .collect()
    };
    assert_eq!(
        metadata,
        [
            of(&[("md5sum", "*")]),
            of(&[("md5sum", "md5sum"), ("callerid", "callerid")])
        ]
    );
}

/// Messages of JSON at these times on the topic `/a`, and one on `/b` before them.
fn json(messages: &[(u64, &str)]) -> Vec<u8> {
    let mut file = mcap::MAGIC.to_vec();
    mcap::channel(&mut file, 1, 0, b"/b", b"json");
    mcap::message(&mut file, 1, 1, b"{\"z\":1}");
    mcap::channel(&mut file, 2, 0, b"/a", b"json");
    for (time, text) in messages {
        mcap::message(&mut file, 2, *time, text.as_bytes());
    }
    file
}

/// The table of topic `/a`, with rows, columns and values without one.
fn table(file: &[u8]) -> (String, [u64; 3]) {
    let folder = Folder::new("table");
    let (mut out, mut seen) = (Vec::new(), 0);
    let path = folder.file("log.mcap", file);
    let done = write_table(&path, "/a", &mut out, |offset| seen = offset).unwrap();
    assert_eq!(seen, file.len() as u64);
    (
        String::from_utf8(out).unwrap(),
        [done.rows, done.columns as u64, done.without_column],
    )
}

#[test]
fn a_table_has_every_number_and_text_by_its_path() {
    let file = json(&[
        (
            5,
            "{\"a\":1,\"b\":{\"c\":-2,\"d\":[true,null,0.5]},\"e\":\"x, y\"}",
        ),
        (6, "{\"e\":\"z\",\"a\":3,\"f\":[7,8,9]}"),
        (7, "{}"),
    ]);
    let expected =
        "time_ns,a,b.c,b.d[0],b.d[1],b.d[2],e\n5,1,-2,1,,0.5,\"x, y\"\n6,3,,,,,z\n7,,,,,,\n";
    assert_eq!(table(&file), (expected.to_owned(), [3, 7, 3]));
    // of arrays of bytes the length; what is no finite number is empty
    let mut file = mcap::MAGIC.to_vec();
    mcap::schema(&mut file, 1, b"a/A", b"uint8[] a\nfloat64[3] b\nuint64 c\n");
    mcap::channel(&mut file, 1, 1, b"/a", b"ros1");
    let numbers = [f64::NAN, f64::INFINITY, -0.25]
        .map(f64::to_le_bytes)
        .concat();
    mcap::message(
        &mut file,
        1,
        5,
        &[&[2, 0, 0, 0, 7, 7][..], &numbers, &[0xff; 8]].concat(),
    );
    let expected = "time_ns,a.length,b[0],b[1],b[2],c\n5,2,,,-0.25,18446744073709551615\n";
    assert_eq!(table(&file), (expected.to_owned(), [1, 6, 0]));
    // no more columns than 4096 beside the time
    let array = |count: usize| format!("[{}]", vec!["1"; count].join(","));
    for (count, columns) in [(4095, 4096), (4096, 4097), (4097, 4097)] {
        assert_eq!(
            table(&json(&[(5, &format!("{{\"a\":{}}}", array(count)))])).1,
            [1, columns, 0]
        );
    }
}

#[test]
fn a_number_over_time() {
    let folder = Folder::new("series");
    let file = json(&[
        (500_000_000, "{\"a\":[1,2]}"),
        (1_250_000_000, "{\"a\":[3,4]}"),
    ]);
    let path = folder.file("log.mcap", &file);
    let found = series(&path, "/a", "a[1]").unwrap();
    assert_eq!(
        (found.start_ns, found.samples),
        (500_000_000, vec![(0.0, 2.0), (0.75, 4.0)])
    );
    let error = series(&path, "/a", "b").unwrap_err();
    assert!(matches!(error, Error::NoField { .. }), "{error}");
    // the name that was meant is one that is declared late
    let file = [json(&[]), json(&[(5, "{}")])[mcap::MAGIC.len()..].to_vec()].concat();
    let path = folder.file("late.mcap", &file);
    for error in [
        series(&path, "/aa", "a").unwrap_err(),
        write_table(&path, "/aa", &mut Vec::new(), |_| ()).unwrap_err(),
    ] {
        assert_eq!(error.hint().as_deref(), Some("did you mean `/a`?"));
    }
}

#[test]
fn a_copy_says_what_it_holds_and_lacks() {
    let folder = Folder::new("copied");
    let copied = |file: &[u8]| {
        let path = folder.file("log.mcap", file);
        let copied = copy(&path, Cursor::new(Vec::new()), Format::Mcap, |_| ()).unwrap();
        let partial = copied.is_partial();
        (
            copied.messages,
            copied.damage_count,
            copied.bytes_lost,
            copied.messages_lost,
            copied.attached,
            partial,
        )
    };
    let finish = |file: &mut Vec<u8>| {
        mcap::record(file, 2, &[0; 20]);
        file.extend(mcap::MAGIC);
    };
    let mut whole = json(&[(5, "1"), (6, "2")]);
    let mut attached = whole.clone();
    finish(&mut whole);
    assert_eq!(copied(&whole), (3, 0, 0, 0, 0, false));
    mcap::record(&mut attached, 9, b"photograph");
    finish(&mut attached);
    assert_eq!(copied(&attached), (3, 0, 0, 0, 1, true));
    // two chunks with a wrong CRC, of three and two messages by their indexes, and a message without its numbers
    let mut damaged = json(&[(5, "1")]);
    let mut lost = 0;
    for entries in [3_u8, 2] {
        let at = damaged.len();
        mcap::chunk(&mut damaged, crate::written::Packing::None, b"");
        damaged[at + 9 + 24] = 1;
        lost += damaged.len() - at;
        let index = [
            &[1, 0, 16 * entries, 0, 0, 0][..],
            &vec![0; 16 * usize::from(entries)],
        ]
        .concat();
        mcap::record(&mut damaged, 7, &index);
    }
    mcap::record(&mut damaged, 5, b"x");
    finish(&mut damaged);
    assert_eq!(copied(&damaged), (2, 3, lost as u64 + 10, 5, 0, true));
    let path = folder.file("log.mcap", &damaged);
    let done = copy(&path, Cursor::new(Vec::new()), Format::Mcap, |_| ()).unwrap();
    let names = ["/b", "/a"].map(|topic| (topic.to_owned(), String::new(), 1));
    assert_eq!((done.channels, done.damages.len()), (names.to_vec(), 3));
    // a thousand damages are kept
    let mut many = json(&[]);
    for _ in 0..1001 {
        mcap::record(&mut many, 5, b"x");
    }
    finish(&mut many);
    let path = folder.file("log.mcap", &many);
    let done = copy(
        Path::new(&path),
        Cursor::new(Vec::new()),
        Format::Mcap,
        |_| (),
    )
    .unwrap();
    assert_eq!((done.damage_count, done.damages.len()), (1001, 1000));
    fs::remove_file(path).unwrap();
    let mut container = Container::over("copied".as_ref(), Cursor::new(whole)).unwrap();
    assert!(matches!(container.next(), Some(Event::Message(_))));
}
