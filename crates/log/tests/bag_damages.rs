//! Bags with one fault: which messages are read, and exactly what is reported.

use grouser_log::container::{Container, Event};

use crate::written::bag::{MAGIC, bag_header, connection, message, record};
use crate::written::{Packing, found};

/// A chunk of one connection with messages of these times.
fn content(times: &[u64], data: &[u8]) -> Vec<u8> {
    let mut content = Vec::new();
    connection(&mut content, 0, b"/t", b"a/B");
    for time in times {
        message(&mut content, 0, *time, data);
    }
    content
}

fn chunk(out: &mut Vec<u8>, packing: Packing, content: &[u8]) {
    sized_chunk(out, packing, content, content.len());
}

fn sized_chunk(out: &mut Vec<u8>, packing: Packing, content: &[u8], size: usize) {
    let size = u32::try_from(size).unwrap().to_le_bytes();
    let name = packing.names().1.as_bytes();
    let fields: [(&str, &[u8]); 3] = [("op", &[5]), ("compression", name), ("size", &size)];
    record(out, &fields, &packing.pack(content));
}

/// Data of a chunk's index, 12 bytes a message, or of a chunk's information, 8 bytes a connection.
fn counting(out: &mut Vec<u8>, op: u8, count: u32, bytes: usize) {
    let count = count.to_le_bytes();
    let fields: [(&str, &[u8]); 3] = [("op", &[op]), ("conn", &[0; 4]), ("count", &count)];
    record(out, &fields, &vec![0; bytes]);
}

fn begin(index_at: u64, chunks: u32) -> Vec<u8> {
    [MAGIC, &bag_header(index_at, chunks)].concat()
}

const NOT_CLOSED: &str = "the bag was not closed: it has no index";
const NOISE: [u8; 40] = [0xff; 40];
const NO_HEADER: &str = "a header declares 4294967295 bytes, more than the limit of 1048576";

#[test]
fn what_a_count_confirms_is_not_searched() {
    // a chunk that is a message's data, or a definition
    let mut inner = Vec::new();
    chunk(&mut inner, Packing::None, &content(&[99], b"inner"));
    let mut definition = Vec::new();
    let text = [b"message_definition=", &inner[..]].concat();
    for field in [&b"topic=/t"[..], b"type=a/B", &text] {
        definition.extend(u32::try_from(field.len()).unwrap().to_le_bytes());
        definition.extend(field);
    }
    for (count, of_index) in [(1, true), (2, true), (1, false), (2, false)] {
        let mut file = begin(0, 0);
        let suspect = if of_index {
            let suspect = file.len();
            chunk(&mut file, Packing::None, &content(&[1], &inner));
            counting(&mut file, 4, count, 12);
            suspect
        } else {
            let fields: [(&str, &[u8]); 3] = [("op", &[7]), ("conn", &[1; 4]), ("topic", b"/t")];
            record(&mut file, &fields, &definition);
            counting(&mut file, 6, count, 8);
            MAGIC.len()
        };
        let noise = file.len();
        file.extend(NOISE);
        chunk(&mut file, Packing::None, &content(&[2], b"two"));
        let at = file.windows(inner.len()).position(|w| w == inner).unwrap();
        let (times, damages) = found(&file);
        let mut expected = vec![
            (noise, NOISE.len(), None, NO_HEADER.to_owned()),
            (file.len(), 0, None, NOT_CLOSED.to_owned()),
        ];
        let mut expected_times = if of_index { vec![1, 2] } else { vec![2] };
        if count == 2 {
            // the count is not that of the bytes: what stands before may have lied
            expected.insert(0, (suspect, at - suspect, None, NO_HEADER.to_owned()));
            expected_times.insert(expected_times.len() - 1, 99);
        }
        assert_eq!(
            (times, damages),
            (expected_times, expected),
            "{count} {of_index}"
        );
    }
}

#[test]
fn a_closed_bag_has_its_chunks() {
    let file = |index_at: u64, promised: u32| {
        let mut file = begin(index_at, promised);
        chunk(&mut file, Packing::None, &content(&[1], b"one"));
        let end = file.len();
        let (times, mut damages) = found(&file);
        assert_eq!(times, [1]);
        damages.pop().map(|(at, bytes, messages, what)| {
            assert_eq!((at, bytes, messages, damages.len()), (end, 0, None, 0));
            what
        })
    };
    assert_eq!(file(5000, 1), None);
    let promise = "the bag promises 3 chunks, but 1 are there".to_owned();
    assert_eq!(file(5000, 3), Some(promise));
    assert_eq!(file(0, 3).as_deref(), Some(NOT_CLOSED));
    // one behind another is read for itself
    let mut files = begin(0, 0);
    chunk(&mut files, Packing::None, &content(&[1], b"one"));
    let second = files.len();
    files.extend(begin(5000, 2));
    chunk(&mut files, Packing::None, &content(&[2], b"two"));
    chunk(&mut files, Packing::None, &content(&[3], b"three"));
    let expected = vec![(second, 0, None, NOT_CLOSED.to_owned())];
    assert_eq!(found(&files), (vec![1, 2, 3], expected));
}

#[test]
fn a_record_that_swallows_the_end_is_searched() {
    let mut inner = Vec::new();
    chunk(&mut inner, Packing::None, &content(&[2], b"two"));
    let mut file = begin(5000, 1);
    message(&mut file, 9, 1, &inner);
    let (times, damages) = found(&file);
    let at = file.len() - inner.len();
    let what = "a record declares more bytes than it has".to_owned();
    assert_eq!(times, [2]);
    let orphan = (
        0,
        0,
        Some(1),
        "1 messages belong to channel 9, which is not there".to_owned(),
    );
    assert_eq!(
        damages,
        [(MAGIC.len(), at - MAGIC.len(), None, what), orphan]
    );
}

#[test]
fn headers_and_records_have_limits() {
    for (more, is_read) in [(0, true), (1, false)] {
        // 1 MiB with the lengths and the names of its fields
        let padding = vec![b' '; (1 << 20) - (4 + 4) - (4 + 9) - (4 + 8) - (4 + 4) + more];
        let mut file = begin(5000, 0);
        let place = file.len();
        let fields: [(&str, &[u8]); 4] = [
            ("op", &[7]),
            ("conn", &[0; 4]),
            ("topic", b"/t"),
            ("pad", &padding),
        ];
        let mut data = Vec::new();
        connection(&mut data, 0, b"/t", b"a/B");
        // the data of a connection, behind its header
        let header = 4 + u32::from_le_bytes(data[..4].try_into().unwrap()) as usize;
        record(&mut file, &fields, &data[header + 4..]);
        message(&mut file, 0, 5, b"five");
        let (times, damages) = found(&file);
        assert_eq!(times.len(), usize::from(is_read));
        let what = "a header declares 1048577 bytes, more than the limit of 1048576";
        let expected = (place, file.len() - place, None, what.to_owned());
        assert_eq!(damages, if is_read { vec![] } else { vec![expected] });
    }
}

#[test]
fn a_message_has_a_limit() {
    let limit = 48 << 20;
    for (more, is_read) in [(0, true), (1, false)] {
        // its data are a chunk, and an index of all the rest
        let mut data = Vec::new();
        let padding = (0..12).find(|padding| {
            data.clear();
            chunk(&mut data, Packing::None, &content(&[2], &vec![1; *padding]));
            let head = data.len();
            counting(&mut data, 4, 0, 0);
            let rest = limit + more - data.len();
            data.truncate(head);
            counting(&mut data, 4, u32::try_from(rest / 12).unwrap(), rest);
            rest % 12 == 0
        });
        assert_eq!(data.len(), limit + more);
        let mut file = begin(5000, 1);
        connection(&mut file, 0, b"/t", b"a/B");
        let place = file.len();
        message(&mut file, 0, 1, &data);
        let at = file.len() - data.len();
        let mut container = Container::over("great".as_ref(), std::io::Cursor::new(file)).unwrap();
        let (mut lengths, mut damages) = (Vec::new(), Vec::new());
        while let Some(event) = container.next() {
            match event {
                Event::Message(message) => lengths.push((message.log_time_ns, message.data.len())),
                Event::Damage(damage) => damages.push((damage.offset, damage.bytes, damage.what)),
            }
        }
        if is_read {
            assert_eq!(lengths[0], (1, limit));
        } else {
            assert_eq!(lengths, [(2, padding.unwrap())]);
            let what = "a record declares 50331649 bytes; 50331649 are left, the limit is 50331648";
            let expected = (place as u64, (at - place) as u64, what.to_owned());
            assert!(damages.contains(&expected), "{damages:?}");
        }
    }
}

#[test]
fn a_message_that_is_cut_is_not_given() {
    let mut file = begin(5000, 0);
    connection(&mut file, 0, b"/t", b"a/B");
    let place = file.len();
    message(&mut file, 0, 1, b"one two");
    file.truncate(file.len() - 3);
    let what = "a record declares 7 bytes; 4 are left, the limit is 50331648".to_owned();
    // from the first record on whose length nothing confirms
    let expected = vec![(place, file.len() - place, None, what)];
    assert_eq!(found(&file), (vec![], expected));
}

#[test]
fn a_record_of_a_wrong_content_is_passed_over() {
    let mut file = begin(5000, 0);
    connection(&mut file, 0, b"/t", b"a/B");
    let place = file.len();
    record(&mut file, &[("op", &[2]), ("conn", &[0; 4])], b"data");
    let bytes = file.len() - place;
    message(&mut file, 0, 2, b"two");
    let expected = vec![(place, bytes, None, "a message has no time".to_owned())];
    assert_eq!(found(&file), (vec![2], expected));
}

#[test]
fn a_chunk_of_an_unknown_packing_goes_by_its_length_or_by_the_next_one() {
    let what = "the chunk's compression or size is not known";
    for is_record_behind in [true, false] {
        let mut file = begin(5000, 2);
        let place = file.len();
        let fields: [(&str, &[u8]); 3] = [("op", &[5]), ("compression", b"zip"), ("size", &[9; 4])];
        record(&mut file, &fields, b"whatever it is");
        let mut bytes = file.len() - place;
        if is_record_behind {
            counting(&mut file, 4, 2, 24);
            counting(&mut file, 4, 3, 36);
        } else {
            file.extend(NOISE);
            bytes += NOISE.len();
        }
        chunk(&mut file, Packing::None, &content(&[2], b"two"));
        let messages = is_record_behind.then_some(5);
        let expected = vec![(place, bytes, messages, what.to_owned())];
        let promise = "the bag promises 2 chunks, but 1 are there";
        let (times, mut damages) = found(&file);
        damages.retain(|damage| damage.3 != promise);
        assert_eq!((times, damages), (vec![2], expected), "{is_record_behind}");
    }
}

#[test]
fn a_chunk_whose_size_is_wrong_is_reported_with_its_messages() {
    let plain = content(&[1, 2], b"data of a message");
    let size = plain.len();
    for (packing, declared, times, what) in [
        (
            Packing::None,
            size + 5,
            vec![1, 2, 3],
            format!("the chunk holds {size} bytes, but declares {}", size + 5),
        ),
        (
            Packing::None,
            size - 5,
            vec![1, 3],
            format!(
                "the chunk holds more than the {} bytes that it declares",
                size - 5
            ),
        ),
        (
            Packing::Lz4,
            size + 5,
            vec![3],
            format!("the chunk holds {size} bytes, but declares {}", size + 5),
        ),
        (
            Packing::Lz4,
            size - 5,
            vec![3],
            format!(
                "the chunk holds more than the {} bytes that it declares",
                size - 5
            ),
        ),
    ] {
        let mut file = begin(5000, 2);
        let place = file.len();
        sized_chunk(&mut file, packing, &plain, declared);
        let bytes = file.len() - place;
        counting(&mut file, 4, 2, 24);
        chunk(&mut file, packing, &content(&[3], b"three"));
        let lost = 3 - times.len() as u64;
        let expected = vec![(place, bytes, Some(lost), what)];
        assert_eq!(found(&file), (times, expected), "{packing:?} {declared}");
    }
}

#[test]
fn a_chunk_that_declares_more_than_the_file_has_ends_at_the_next_one() {
    let mut file = begin(5000, 2);
    let place = file.len();
    chunk(&mut file, Packing::None, &content(&[1], b"one"));
    let next = file.len();
    let data = next - content(&[1], b"one").len();
    file[data - 4..data].copy_from_slice(&100_000_u32.to_le_bytes());
    chunk(&mut file, Packing::None, &content(&[2], b"two"));
    let what = "the file ends within a chunk; its readable part is kept".to_owned();
    assert_eq!(
        found(&file),
        (vec![1, 2], vec![(place, next - place, None, what)])
    );
}

#[test]
fn what_a_connection_says_besides_is_short() {
    for (length, is_kept) in [(1024, true), (1025, false)] {
        let mut data = Vec::new();
        let caller = "c".repeat(length);
        let fields = [
            "topic=/t",
            "type=a/B",
            "md5sum=0123",
            "latching=1",
            &format!("callerid={caller}"),
            "message_definition=",
        ];
        for field in fields {
            data.extend(u32::try_from(field.len()).unwrap().to_le_bytes());
            data.extend(field.as_bytes());
        }
        let mut file = begin(5000, 0);
        record(
            &mut file,
            &[("op", &[7]), ("conn", &[0; 4]), ("topic", b"/t")],
            &data,
        );
        message(&mut file, 0, 1, b"");
        let mut container = Container::over("said".as_ref(), std::io::Cursor::new(file)).unwrap();
        let Some(Event::Message(message)) = container.next() else {
            panic!("one message")
        };
        let said = &message.of.metadata;
        assert_eq!(
            (said["md5sum"].as_str(), said["latching"].as_str()),
            ("0123", "1")
        );
        assert_eq!(said.get("callerid"), is_kept.then_some(&caller));
    }
}

#[test]
fn an_index_declares_what_is_missing() {
    let limit = 4 << 20;
    for (more, is_declared) in [(0, true), (1, false)] {
        // 4 MiB are held
        let mut needed = Vec::new();
        connection(&mut needed, 1, b"/t", b"a/B");
        let mut other = Vec::new();
        let fields: [(&str, &[u8]); 2] = [("op", &[7]), ("conn", &[0; 4])];
        record(&mut other, &fields, &[]);
        let padding = vec![0; limit - (other.len() - 8) - (needed.len() - 8) + more];
        other.clear();
        record(&mut other, &fields, &padding);
        let mut messages = Vec::new();
        message(&mut messages, 1, 1, b"one");
        let index_at = begin(0, 0).len() + messages.len();
        let mut file = begin(index_at as u64, 0);
        file.extend(&messages);
        file.extend(&other);
        file.extend(&needed);
        let (times, _) = found(&file);
        assert_eq!(times.len(), usize::from(is_declared));
    }
}
