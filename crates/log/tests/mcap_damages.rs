//! MCAP files with one fault: which messages are read, and exactly what is reported.

use std::io::Cursor;

use grouser_log::container::{Container, Event, Format};

use crate::written::mcap::{MAGIC, channel, chunk, counted, message, record, schema};
use crate::written::{Packing, found, read};

fn lost(place: usize, bytes: usize, what: &str) -> (usize, usize, Option<u64>, String) {
    (place, bytes, None, what.to_owned())
}

/// Magic bytes and a channel with the number 1.
fn begin() -> Vec<u8> {
    let mut file = MAGIC.to_vec();
    channel(&mut file, 1, 0, b"/t", b"json");
    file
}

/// A footer without a summary.
fn footer(file: &mut Vec<u8>) {
    record(file, 2, &[0; 20]);
}

fn finish(file: &mut Vec<u8>) {
    footer(file);
    file.extend(MAGIC);
}

/// Messages of these times.
fn content(times: &[u64], data: &[u8]) -> Vec<u8> {
    let mut content = Vec::new();
    for time in times {
        message(&mut content, 1, *time, data);
    }
    content
}

/// A chunk's index with one entry.
fn index(file: &mut Vec<u8>) {
    record(file, 7, &[&[1, 0, 16, 0, 0, 0][..], &[0; 16]].concat());
}

/// A chunk with a message of time 99, to stand in another message's data.
fn inner() -> Vec<u8> {
    let mut inner = Vec::new();
    chunk(&mut inner, Packing::None, &content(&[99], b"inner"));
    inner
}

/// A record that declares more bytes than there are.
fn cut(file: &mut Vec<u8>, opcode: u8) {
    let mut whole = Vec::new();
    record(&mut whole, opcode, &[1; 40]);
    file.extend(&whole[..whole.len() - 3]);
}

const NO_FOOTER: &str = "the file ends without its footer";
const NO_RECORD: &str = "no record begins here";
const SWALLOWED: &str = "a record declares more bytes than it has";
const CUT: &str = "a record declares 40 bytes; 37 are left, the limit is 50331648";

#[test]
fn what_nothing_confirms_is_searched() {
    let inner = inner();
    // first by a record behind it that makes no sense, then by the end
    let mut file = begin();
    message(&mut file, 1, 1, &inner);
    let (at, end) = (file.len() - inner.len(), file.len());
    let swallowed = lost(MAGIC.len(), at - MAGIC.len(), SWALLOWED);
    let expected = vec![swallowed.clone(), lost(end, 0, NO_FOOTER)];
    assert_eq!(found(&file), (vec![1, 99], expected));
    for (opcode, what) in [(5, CUT), (3, NO_RECORD)] {
        let mut file = file.clone();
        cut(&mut file, opcode);
        let expected = vec![swallowed.clone(), lost(end, file.len() - end, what)];
        assert_eq!(found(&file), (vec![1, 99], expected), "{opcode}");
    }
    // one that reaches to the end exactly makes sense
    message(&mut file, 1, 5, b"five");
    assert_eq!(found(&file).0[..2], [1, 5]);
    // an index of the right length confirms the chunk before it, a footer all
    let mut file = begin();
    chunk(&mut file, Packing::None, &content(&[1], &inner));
    index(&mut file);
    let place = file.len();
    cut(&mut file, 5);
    let expected = vec![lost(place, file.len() - place, CUT)];
    assert_eq!(found(&file), (vec![1], expected));
    let mut file = begin();
    message(&mut file, 1, 1, &inner);
    finish(&mut file);
    assert_eq!(found(&file), (vec![1], vec![]));
}

#[test]
fn what_is_behind_a_message_that_holds_a_chunk_is_read_once() {
    let inner = inner();
    let mut file = begin();
    let mut places = vec![MAGIC.len()];
    for (time, data) in [
        (1, &inner[..]),
        (2, b"two"),
        (3, &inner),
        (4, b"four"),
        (5, b"five"),
    ] {
        message(&mut file, 1, time, data);
        places.push(file.len());
    }
    let swallowed = |from: usize, to: usize| lost(from, to - inner.len() - from, SWALLOWED);
    let mut expected = vec![
        swallowed(places[0], places[1]),
        swallowed(places[1], places[3]),
        lost(places[5], 0, NO_FOOTER),
    ];
    assert_eq!(
        found(&file),
        (vec![1, 2, 3, 4, 5, 99, 99], expected.clone())
    );
    // before a place that makes no sense, and a chunk behind it
    let mut damaged = file.clone();
    damaged.extend([0; 40]);
    let end = damaged.len();
    chunk(&mut damaged, Packing::None, &content(&[6], b"six"));
    expected.truncate(2);
    for damage in &mut expected {
        NO_RECORD.clone_into(&mut damage.3);
    }
    expected.extend([
        lost(places[5], end - places[5], NO_RECORD),
        lost(damaged.len(), 0, NO_FOOTER),
    ]);
    assert_eq!(found(&damaged), (vec![1, 2, 3, 4, 5, 99, 99, 6], expected));
    // a chunk and two messages that a length hides, and one behind them that it does not
    let mut hidden = begin();
    let place = hidden.len();
    message(&mut hidden, 1, 1, b"one");
    chunk(&mut hidden, Packing::None, &content(&[2], b"two"));
    for time in [3, 4] {
        message(&mut hidden, 1, time, b"later");
    }
    let length = hidden.len() - place - 9;
    hidden[place + 1..place + 9].copy_from_slice(&(length as u64).to_le_bytes());
    message(&mut hidden, 1, 5, b"later");
    assert_eq!(found(&hidden).0, [1, 5, 2, 3, 4]);
}

#[test]
fn records_are_known_by_their_opcode_and_length() {
    let mut rest = Vec::new();
    chunk(&mut rest, Packing::None, &content(&[2], b"two"));
    for (opcode, is_known) in [
        (0, false),
        (15, true),
        (16, false),
        (0x50, false),
        (0x7f, false),
        (0x80, true),
        (0xff, true),
    ] {
        let mut file = begin();
        let place = file.len();
        record(&mut file, opcode, &[0; 4]);
        let next = file.len();
        file.extend(&rest);
        let end = file.len();
        let mut expected = vec![
            lost(place, next - place, NO_RECORD),
            lost(end, 0, NO_FOOTER),
        ];
        if is_known {
            expected.remove(0);
        }
        assert_eq!(found(&file), (vec![2], expected), "{opcode}");
    }
    for (opcode, what) in [(3, NO_RECORD), (9, NO_RECORD), (5, CUT)] {
        let mut file = begin();
        let place = file.len();
        cut(&mut file, opcode);
        let expected = vec![lost(place, file.len() - place, what)];
        assert_eq!(found(&file), (vec![], expected), "{opcode}");
    }
    // a record may end with the file, which then lacks its footer
    let mut file = begin();
    record(&mut file, 9, b"attachment");
    assert_eq!(found(&file), (vec![], vec![lost(file.len(), 0, NO_FOOTER)]));
    // less than a head
    let mut file = begin();
    let place = file.len();
    file.extend([5, 1, 0]);
    let expected = vec![lost(place, 3, "the file ends within a record")];
    assert_eq!(found(&file), (vec![], expected));
    // a message without its numbers, by its length
    let mut file = begin();
    let place = file.len();
    record(&mut file, 5, &[1, 0, 0]);
    message(&mut file, 1, 2, b"two");
    finish(&mut file);
    let expected = vec![lost(place, 12, "a record is too short for its fields")];
    assert_eq!(found(&file), (vec![2], expected));
}

#[test]
fn a_message_has_a_limit() {
    let limit = 48 << 20;
    for (more, is_read) in [(0, true), (1, false)] {
        // its data are a chunk, and an index of all the rest; 22 bytes of a message are its numbers
        let mut data = inner();
        let head = data.len();
        let rest = limit + more - 22 - head - 9;
        data.push(7);
        data.extend((rest as u64).to_le_bytes());
        data.extend([1, 0]);
        data.extend(u32::try_from(rest - 6).unwrap().to_le_bytes());
        data.resize(limit + more - 22, 0);
        let mut file = begin();
        let place = file.len();
        message(&mut file, 1, 1, &data);
        let at = file.len() - data.len();
        let mut container = Container::over("great".as_ref(), Cursor::new(file)).unwrap();
        let (mut lengths, mut damages) = (Vec::new(), Vec::new());
        while let Some(event) = container.next() {
            match event {
                Event::Message(message) => lengths.push((message.log_time_ns, message.data.len())),
                Event::Damage(damage) => damages.push((damage.offset, damage.bytes, damage.what)),
            }
        }
        if is_read {
            assert_eq!(lengths[0], (1, limit - 22));
        } else {
            assert_eq!(lengths, [(99, 5)]);
            let what = "a record declares 50331649 bytes; 50331649 are left, the limit is 50331648";
            // the channel before it was not confirmed
            let expected = (place as u64, (at - place) as u64, what.to_owned());
            assert!(damages.contains(&expected), "{damages:?} {expected:?}");
        }
    }
}

#[test]
fn a_damaged_chunk_loses_the_messages_of_its_indexes() {
    for packing in [Packing::None, Packing::Lz4, Packing::Zstd] {
        let mut file = begin();
        let plain = content(&[1, 2], b"some data");
        let place = file.len();
        chunk(&mut file, packing, &plain);
        let bytes = file.len() - place;
        // another CRC
        file[place + 9 + 24..place + 9 + 28].copy_from_slice(&[1, 2, 3, 4]);
        index(&mut file);
        index(&mut file);
        chunk(&mut file, packing, &content(&[3], b"three"));
        finish(&mut file);
        let crc = crc32fast::hash(&plain);
        let what = format!("the CRC of the chunk is {crc:08x}, but 04030201 is stored");
        let expected = vec![(place, bytes, Some(2), what)];
        assert_eq!(found(&file), (vec![3], expected), "{packing:?}");
        // none is stored
        file[place + 9 + 24..place + 9 + 28].fill(0);
        assert_eq!(found(&file), (vec![1, 2, 3], vec![]));
    }
}

#[test]
fn an_index_has_its_length() {
    let what = "a chunk's index does not have the length that it declares";
    for (index, is_sound) in [
        (&[1, 0, 16, 0, 0, 0][..], true),
        (&[1, 0, 15, 0, 0, 0], false),
        (&[1, 0, 17, 0, 0, 0], false),
    ] {
        let mut file = begin();
        chunk(&mut file, Packing::None, &content(&[1], b"one"));
        let place = file.len();
        record(&mut file, 7, &[index, &[0; 16]].concat());
        let next = file.len();
        chunk(&mut file, Packing::None, &content(&[2], b"two"));
        finish(&mut file);
        let expected = if is_sound {
            vec![]
        } else {
            vec![lost(place, next - place, what)]
        };
        assert_eq!(found(&file), (vec![1, 2], expected), "{index:?}");
    }
}

#[test]
fn an_index_that_one_bit_makes_a_message_is_none() {
    // a message without data, whose number is the length of what follows it
    let mut alike = Vec::new();
    record(
        &mut alike,
        5,
        &[&[1, 0, 16, 0, 0, 0][..], &7_u64.to_le_bytes(), &[0; 8]].concat(),
    );
    let what = "a chunk's index is marked as a message";
    let mut file = begin();
    file.extend(&alike);
    chunk(&mut file, Packing::None, &content(&[1], b"one"));
    let places = [file.len(), file.len() + alike.len()];
    file.extend(alike.repeat(2));
    // a channel, whose bytes are as those of an index
    schema(&mut file, 16, b"a/A", b"");
    chunk(&mut file, Packing::None, &content(&[2], b"two"));
    let mut content = [2_u16.to_le_bytes(), 16_u16.to_le_bytes()].concat();
    counted(&mut content, b"");
    counted(&mut content, b"abcdef");
    counted(&mut content, b"");
    record(&mut file, 4, &content);
    message(&mut file, 2, 3, b"");
    // behind another record a message is one
    file.extend(&alike);
    finish(&mut file);
    let expected = places.map(|place| lost(place, 0, what)).to_vec();
    assert_eq!(found(&file), (vec![7, 1, 2, 3, 7], expected));
    // nor are others that are no index: empty, of half an entry, of another length
    for (number, bytes) in [(0, 16), (24, 24), (32, 16), (16, 32)] {
        let mut file = begin();
        chunk(&mut file, Packing::None, &[]);
        let data = [
            &[1, 0, number, 0, 0, 0][..],
            &7_u64.to_le_bytes(),
            &vec![0; bytes - 8],
        ]
        .concat();
        record(&mut file, 5, &data);
        finish(&mut file);
        assert_eq!(found(&file), (vec![7], vec![]), "{number} {bytes}");
    }
}

#[test]
fn behind_the_end_of_the_data_there_are_no_messages() {
    for (length, is_end) in [(4, true), (5, false)] {
        let mut file = begin();
        record(&mut file, 15, &vec![0; length]);
        let place = file.len();
        message(&mut file, 1, 1, b"one");
        channel(&mut file, 2, 0, b"/u", b"json");
        finish(&mut file);
        let damage = lost(place, 0, "a message follows the end of the data");
        let expected = if is_end {
            (vec![], vec![damage])
        } else {
            (vec![1], vec![])
        };
        assert_eq!(found(&file), expected);
    }
}

#[test]
fn checks_of_the_whole_are_made() {
    let mut file = begin();
    message(&mut file, 1, 1, b"one");
    let crc = crc32fast::hash(&file);
    let place = file.len();
    let with = |stored: u32, messages: u64| {
        let mut file = file.clone();
        record(&mut file, 15, &stored.to_le_bytes());
        record(
            &mut file,
            11,
            &[&messages.to_le_bytes()[..], &[0; 38]].concat(),
        );
        finish(&mut file);
        found(&file).1
    };
    assert_eq!(with(crc, 1), []);
    assert_eq!(with(0, 1), []);
    let what = format!(
        "the CRC of the data is {crc:08x}, but {:08x} is stored",
        crc ^ 1
    );
    assert_eq!(with(crc ^ 1, 1), [lost(place, 0, &what)]);
    let what = "the file says 3 messages, but 1 were read";
    assert_eq!(with(crc, 3), [lost(place + 13, 0, what)]);
}

#[test]
fn a_footer_is_followed_by_magic_bytes() {
    let mut file = begin();
    let place = file.len();
    footer(&mut file);
    let next = file.len();
    chunk(&mut file, Packing::None, &content(&[2], b"two"));
    let what = "the footer is not followed by the magic bytes";
    let expected = vec![lost(place, 0, what)];
    assert_eq!(found(&file), (vec![2], expected.clone()));
    // they may stand behind others
    file.truncate(next);
    file.extend([0x50; 16]);
    file.extend(MAGIC);
    let expected = [expected, vec![lost(next, 16, NO_RECORD)]].concat();
    assert_eq!(found(&file), (vec![], expected));
}

#[test]
fn a_profile_is_short_and_attachments_are_counted() {
    let file = |length: usize| {
        let mut header = Vec::new();
        counted(&mut header, b"ros1");
        counted(&mut header, &vec![b' '; length - 12]);
        let mut file = MAGIC.to_vec();
        record(&mut file, 1, &header);
        for opcode in [9, 10, 12, 13, 9] {
            record(&mut file, opcode, b"something");
        }
        finish(&mut file);
        let mut container = Container::over("header".as_ref(), Cursor::new(file)).unwrap();
        assert_eq!(container.next(), None);
        assert_eq!(container.attached(), 3);
        container.profile().to_owned()
    };
    assert_eq!([file(1024), file(1025)], ["ros1", ""]);
    assert_eq!(
        [Format::Mcap.name(), Format::Bag.name()],
        ["MCAP", "ROS 1 bag"]
    );
}

#[test]
fn a_chunk_does_not_swallow_its_neighbours() {
    for wrong_crc in [false, true] {
        let mut file = begin();
        let place = file.len();
        chunk(&mut file, Packing::None, &content(&[1], b"one"));
        let next = file.len();
        message(&mut file, 1, 2, b"two");
        // up to the end of the message behind it
        let length = (file.len() - place - 9) as u64;
        file[place + 1..place + 9].copy_from_slice(&length.to_le_bytes());
        message(&mut file, 1, 3, b"three");
        finish(&mut file);
        if wrong_crc {
            file[place + 9 + 24] ^= 1;
            let (times, damages) = found(&file);
            assert_eq!((times, damages.len()), (vec![2, 3], 1));
            assert_eq!((damages[0].0, damages[0].1), (place, next - place));
        } else {
            assert_eq!(found(&file), (vec![1, 2, 3], vec![]));
        }
    }
}

#[test]
fn only_a_damaged_chunk_is_searched_for_another() {
    let inner = inner();
    let mut file = begin();
    let place = file.len();
    chunk(&mut file, Packing::None, &content(&[1], &inner));
    let at = file.len() - inner.len();
    finish(&mut file);
    assert_eq!(found(&file), (vec![1], vec![]));
    file[place + 9 + 24] ^= 1;
    let (times, damages) = found(&file);
    assert_eq!((times, damages.len()), (vec![99], 1));
    assert_eq!((damages[0].0, damages[0].1), (place, at - place));
    assert!(damages[0].3.contains("the CRC of the chunk"));
}

#[test]
fn a_chunk_that_makes_no_sense_goes_by_its_length_or_by_the_next_one() {
    let short = (vec![0; 20], "the chunk is too short for its head");
    let named = |name: &[u8], packed: u64| {
        let mut head = vec![0; 28];
        counted(&mut head, name);
        head.extend(packed.to_le_bytes());
        head.extend(b"content");
        head
    };
    let unknown = (
        named(b"zip", 7),
        "the chunk is compressed as `zip`, which is not known",
    );
    let long = (named(b"", 8), "the chunk holds 7 bytes, but declares 8");
    let mut next = Vec::new();
    chunk(&mut next, Packing::None, &content(&[2], b"two"));
    finish(&mut next);
    for (bytes, what) in [short, unknown, long] {
        let mut file = begin();
        let place = file.len();
        record(&mut file, 6, &bytes);
        let end = file.len();
        // with the messages of its index
        let mut indexed = file.clone();
        index(&mut indexed);
        index(&mut indexed);
        indexed.extend(&next);
        let expected = vec![(place, end - place, Some(2), what.to_owned())];
        assert_eq!(found(&indexed), (vec![2], expected));
        // or a record that is none, or longer than the file
        let left = 9 + next.len() as u64;
        for (opcode, length, is_sound) in [
            (0, 0, false),
            (16, 0, false),
            (9, left, false),
            (9, left - 1, true),
        ] {
            let mut file = file.clone();
            file.push(opcode);
            file.extend(u64::to_le_bytes(length));
            let noise = file.len() - end;
            file.extend(&next);
            let (times, damages) = found(&file);
            assert_eq!(times, [2]);
            let lost_bytes = end - place + if is_sound { 0 } else { noise };
            assert_eq!(
                damages[0],
                lost(place, lost_bytes, what),
                "{opcode} {length}"
            );
            assert_eq!(damages.len(), if is_sound { 2 } else { 1 }, "{damages:?}");
        }
    }
}

#[test]
fn a_chunk_that_ends_in_a_record_keeps_the_others() {
    let mut plain = content(&[1, 2, 3], b"some data");
    plain.truncate(plain.len() - 1);
    let mut file = begin();
    let place = file.len();
    chunk(&mut file, Packing::Lz4, &plain);
    let bytes = file.len() - place;
    (0..3).for_each(|_| index(&mut file));
    finish(&mut file);
    let what = "a record reaches past the end of its chunk".to_owned();
    assert_eq!(
        found(&file),
        (vec![1, 2], vec![(place, bytes, Some(1), what)])
    );
    // not so much as a head
    plain.truncate(plain.len() - 22 - 8 - 1);
    let mut file = begin();
    chunk(&mut file, Packing::Lz4, &plain);
    finish(&mut file);
    let (times, damages) = found(&file);
    assert_eq!((times, damages.len(), damages[0].2), (vec![1, 2], 1, None));
}

#[test]
fn a_schema_is_one_by_name_and_text() {
    for (name, text, is_another) in [
        (&b"a/A"[..], &b"bool a\n"[..], false),
        (b"a/B", b"bool a\n", true),
        (b"a/A", b"bool b\n", true),
    ] {
        let mut file = MAGIC.to_vec();
        schema(&mut file, 1, b"a/A", b"bool a\n");
        let place = file.len();
        schema(&mut file, 1, name, text);
        let bytes = file.len() - place;
        finish(&mut file);
        let what = "schema 1 is declared again as another: the first is kept";
        let expected = if is_another {
            vec![lost(place, bytes, what)]
        } else {
            vec![]
        };
        assert_eq!(found(&file), (vec![], expected));
    }
    let mut file = MAGIC.to_vec();
    for id in 0..8193 {
        schema(&mut file, id, b"a", b"");
    }
    finish(&mut file);
    let (_, damages) = found(&file);
    assert_eq!(damages.len(), 1);
    assert_eq!(
        damages[0].3,
        "there are more schemas than the limit of 8192"
    );
}

#[test]
fn a_channel_without_a_schema_has_none_of_the_summarys() {
    let mut file = begin();
    message(&mut file, 1, 1, b"one");
    record(&mut file, 15, &[0; 4]);
    let start = file.len() as u64;
    schema(&mut file, 0, b"a/A", b"");
    record(&mut file, 2, &[&start.to_le_bytes()[..], &[0; 12]].concat());
    file.extend(MAGIC);
    let (rows, damages) = read(file).unwrap();
    assert_eq!((rows[0].1.as_str(), damages), ("", vec![]));
}

#[test]
fn metadata_are_short_texts() {
    let (fits, long) = (vec![b'a'; 1 << 16], vec![b'b'; (1 << 16) + 1]);
    let mut pairs = Vec::new();
    for text in [
        &b"key"[..],
        b"value",
        &fits,
        b"1",
        b"2",
        &fits,
        &long,
        b"3",
        b"4",
        &long,
        b"\xff",
        b"5",
        b"6",
        b"\xff",
    ] {
        counted(&mut pairs, text);
    }
    let mut content = [1, 0, 0, 0].to_vec();
    counted(&mut content, b"/t");
    counted(&mut content, b"json");
    counted(&mut content, &pairs);
    let mut file = MAGIC.to_vec();
    record(&mut file, 4, &content);
    message(&mut file, 1, 1, b"one");
    finish(&mut file);
    let mut container = Container::over("metadata".as_ref(), Cursor::new(file)).unwrap();
    let Some(Event::Message(message)) = container.next() else {
        panic!("one message")
    };
    let fits = String::from_utf8(fits).unwrap();
    let expected = [("key", "value"), (&fits, "1"), ("2", &fits)];
    let expected = expected.map(|(key, value)| (key.to_owned(), value.to_owned()));
    assert_eq!(message.of.metadata, expected.into());
}

#[test]
fn a_head_is_a_chunks_where_its_content_has_room() {
    let noise = [0x50; 20];
    for (packing, more, is_chunk) in [("", 0, true), ("", 1, false), ("zip", 0, false)] {
        let mut head = vec![0; 28];
        counted(&mut head, packing.as_bytes());
        // all that is left but one byte
        let left = 9 + head.len() + 8 + 50;
        head.extend((left as u64 - 1 + more).to_le_bytes());
        let mut file = begin();
        let place = file.len();
        file.extend(noise);
        let at = file.len();
        file.push(6);
        file.extend((head.len() as u64 + left as u64 - 1 + more).to_le_bytes());
        file.extend(&head);
        file.extend([0x50; 50]);
        assert_eq!(file.len() - at, left);
        let cut = "the file ends within a chunk; its readable part is kept";
        let expected = if is_chunk {
            vec![lost(place, noise.len(), NO_RECORD), lost(at, left, cut)]
        } else {
            vec![lost(place, file.len() - place, NO_RECORD)]
        };
        assert_eq!(found(&file), (vec![], expected), "{packing} {more}");
    }
}

const TOO_MANY: &str = "there are more channels than the limit of 8192";

/// Channels of these numbers, each of a topic of its own.
fn numbered(file: &mut Vec<u8>, ids: std::ops::Range<u16>) {
    for id in ids {
        channel(file, id, 0, format!("/{id}").as_bytes(), b"json");
    }
}

#[test]
fn channels_have_a_limit() {
    for is_same in [true, false] {
        let mut file = MAGIC.to_vec();
        let mut place = 0;
        for id in 0..8193 {
            place = file.len();
            if is_same {
                channel(&mut file, id, 0, b"/t", b"json");
            } else {
                numbered(&mut file, id..id + 1);
            }
        }
        let bytes = file.len() - place;
        message(&mut file, 8191, 5, b"");
        finish(&mut file);
        let expected = vec![lost(place, bytes, TOO_MANY)];
        assert_eq!(found(&file), (vec![5], expected));
    }
}

#[test]
fn names_are_counted_with_their_metadata() {
    let mut pairs = Vec::new();
    for number in 0..64 {
        counted(&mut pairs, format!("key{number:02}").as_bytes());
        counted(&mut pairs, &vec![b'a'; 1 << 16]);
    }
    let mut content = [1, 0, 1, 0].to_vec();
    counted(&mut content, b"/topic");
    counted(&mut content, b"json");
    counted(&mut content, &pairs);
    let mut file = MAGIC.to_vec();
    schema(&mut file, 1, b"a/Type", b"definition");
    record(&mut file, 4, &content);
    finish(&mut file);
    let names = "/topic".len() + "json".len() + "a/Type".len() + "ros1msg".len();
    let sum = names + "definition".len() + 64 * ((1 << 16) + 5);
    let what = format!("definitions and names have {sum} bytes, more than the limit of 4194304");
    assert_eq!(found(&file).1[0].3, what);
}

#[test]
fn chunks_unfold_to_so_much_and_no_more() {
    // a chunk may unfold to 32 MiB and half the file
    let mut file = begin();
    let place = file.len();
    chunk(&mut file, Packing::Zstd, &content(&[1], b"one"));
    let bytes = file.len() - place;
    finish(&mut file);
    let limit = (32 << 20) + file.len() / 2;
    for (declared, what) in [
        (
            limit,
            format!("the chunk holds 34 bytes, but declares {limit}"),
        ),
        (
            limit + 1,
            format!(
                "the chunk declares {} bytes, more than the limit of {limit}",
                limit + 1
            ),
        ),
    ] {
        file[place + 9 + 16..place + 9 + 24].copy_from_slice(&(declared as u64).to_le_bytes());
        assert_eq!(found(&file), (vec![], vec![lost(place, bytes, &what)]));
    }
}

/// A chunk of a message of zeros that unfolds to 32 MiB: a frame of zstd (RFC 8878) with its size, whose blocks are the
/// record's head as it is, then a repeated byte.
fn zeros() -> Vec<u8> {
    let size = 32_u32 << 20;
    let mut head = Vec::new();
    message(&mut head, 1, 7, b"");
    head[1..9].copy_from_slice(&u64::from(size - 9).to_le_bytes());
    let mut frame = [&[0x28, 0xb5, 0x2f, 0xfd, 0xa0][..], &size.to_le_bytes()].concat();
    let mut block = |is_last: bool, kind: u32, count: u32, bytes: &[u8]| {
        let block = (count << 3) | (kind << 1) | u32::from(is_last);
        frame.extend(&block.to_le_bytes()[..3]);
        frame.extend(bytes);
    };
    let head_bytes = u32::try_from(head.len()).unwrap();
    block(false, 0, head_bytes, &head);
    for _ in 1..256 {
        block(false, 1, 1 << 17, &[0]);
    }
    block(true, 1, (1 << 17) - head_bytes, &[0]);
    let mut content = vec![0; 16];
    content.extend(u64::from(size).to_le_bytes());
    content.extend([0; 4]);
    counted(&mut content, b"zstd");
    content.extend((frame.len() as u64).to_le_bytes());
    content.extend(frame);
    let mut chunk = Vec::new();
    record(&mut chunk, 6, &content);
    chunk
}

#[test]
fn all_chunks_unfold_to_so_much_and_no_more() {
    // 64 MiB, and 256 times what was read
    let packed = zeros();
    let mut great = Vec::new();
    chunk(&mut great, Packing::Zstd, b"");
    let mut file = begin();
    // one that is refused does not count
    great[9 + 16..9 + 24].copy_from_slice(&(40_u64 << 20).to_le_bytes());
    file.extend(&great);
    file.extend(packed.repeat(2));
    let place = file.len();
    great[9 + 16..9 + 24].copy_from_slice(&(2_u64 << 20).to_le_bytes());
    file.extend(&great);
    let end = file.len();
    finish(&mut file);
    let (times, damages) = found(&file);
    assert_eq!((times, damages.len()), (vec![7, 7], 2));
    let what = format!(
        "the chunk declares 2097152 bytes, more than the limit of {}",
        256 * end
    );
    assert_eq!(damages[1], lost(place, end - place, &what));
}

#[test]
fn names_and_definitions_are_short() {
    for (more, is_read) in [(0, true), (1, false), (2, false)] {
        let mut file = MAGIC.to_vec();
        let place = file.len();
        channel(&mut file, 1, 0, &vec![b'a'; 1024 + more], b"json");
        let bytes = file.len() - place;
        finish(&mut file);
        let what = format!(
            "a topic has {} bytes, more than the limit of 1024 for a name",
            1024 + more
        );
        let expected = if is_read {
            vec![]
        } else {
            vec![lost(place, bytes, &what)]
        };
        assert_eq!(found(&file), (vec![], expected));
        // 4 MiB of definitions and names
        let mut file = MAGIC.to_vec();
        let place = file.len();
        let text = vec![b' '; (4 << 20) + more];
        schema(&mut file, 1, b"a/A", &text);
        let bytes = file.len() - place;
        finish(&mut file);
        let what = format!(
            "definitions and names have {} bytes, more than the limit of 4194304",
            text.len()
        );
        let expected = if is_read {
            vec![]
        } else {
            vec![lost(place, bytes, &what)]
        };
        assert_eq!(found(&file), (vec![], expected));
    }
}

/// Reads a message of channel 1, which only the summary declares, if the summary is believed.
fn is_believed(summary: &[u8], start: Option<usize>, crc: impl Fn(u32) -> u32) -> bool {
    let mut file = MAGIC.to_vec();
    message(&mut file, 1, 1, b"one");
    let start = start.unwrap_or(file.len());
    file.extend(summary);
    file.push(2);
    file.extend(20_u64.to_le_bytes());
    file.extend((start as u64).to_le_bytes());
    file.extend([0; 8]);
    let stored = crc(crc32fast::hash(file.get(start..).unwrap_or_default()));
    file.extend(stored.to_le_bytes());
    file.extend(MAGIC);
    let (times, damages) = found(&file);
    let orphan = "1 messages belong to channel 1, which is not there";
    let reported = damages.iter().any(|damage| damage.3 == orphan);
    assert_eq!(times.is_empty(), reported, "{damages:?}");
    !reported
}

#[test]
fn a_summary_is_believed_where_it_is_whole() {
    let mut declared = Vec::new();
    channel(&mut declared, 1, 0, b"/t", b"json");
    let same = |crc| crc;
    assert!(is_believed(&declared, None, same));
    assert!(is_believed(&declared, None, |_| 0));
    assert!(!is_believed(&declared, None, |crc| crc ^ 1));
    // from somewhere else
    for start in [0, 3, 1 << 20] {
        assert!(!is_believed(&declared, Some(start), |_| 0), "{start}");
    }
    // other records stand in it, but no chunk, none that is unknown and none that is longer than all
    for (opcode, is_known) in [
        (3, true),
        (11, true),
        (15, true),
        (1, false),
        (6, false),
        (0x50, false),
    ] {
        let mut summary = Vec::new();
        record(
            &mut summary,
            opcode,
            &[9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        );
        summary.extend(&declared);
        assert_eq!(is_believed(&summary, None, same), is_known, "{opcode}");
        assert_eq!(is_believed(&summary, None, |_| 0), is_known, "{opcode}");
    }
    let mut cut_short = declared.clone();
    cut(&mut cut_short, 11);
    assert!(!is_believed(&cut_short, None, |_| 0));
    // 4 MiB are held
    for more in [0, 1] {
        let mut summary = Vec::new();
        let padding = vec![0; (4 << 20) - (declared.len() - 9) - 2 + more];
        record(&mut summary, 3, &[&[9, 0][..], &padding].concat());
        summary.extend(&declared);
        assert_eq!(is_believed(&summary, None, same), more == 0);
    }
}

#[test]
fn a_chunk_that_declares_all_the_room_takes_it() {
    // three chunks without content: each declares as much as one may, which is more than what is left for the last
    let mut great = Vec::new();
    chunk(&mut great, Packing::Zstd, b"");
    let length = begin().len() + 3 * great.len() + 9 + 20 + MAGIC.len();
    let most = (32 << 20) + length / 2;
    let mut file = begin();
    great[9 + 16..9 + 24].copy_from_slice(&(most as u64).to_le_bytes());
    file.extend(great.repeat(3));
    let end = file.len();
    finish(&mut file);
    assert_eq!(file.len(), length);
    let damages = found(&file).1;
    let left = (64 << 20) + 256 * end - 2 * most;
    assert_eq!(
        damages[1].3,
        format!("the chunk holds 0 bytes, but declares {most}")
    );
    assert_eq!(
        damages[2].3,
        format!("the chunk declares {most} bytes, more than the limit of {left}")
    );
}
