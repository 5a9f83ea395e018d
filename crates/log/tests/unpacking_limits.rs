//! Small files that unfold, and files that declare more than they should. Memory stays
//! below 64 MiB + twice the file, and no file takes longer than its bytes are worth.

use std::io::Write as _;
use std::time::Duration;

use grouser_log::Survey;

use crate::processor_time::ThreadTime;
use crate::scratch::Folder;
use crate::written::mcap::{MAGIC, counted, message, record};

const MIB: usize = 1 << 20;

fn schema(out: &mut Vec<u8>, id: u16, language: &str, text: &[u8]) {
    let mut content = id.to_le_bytes().to_vec();
    counted(&mut content, b"a/B");
    counted(&mut content, language.as_bytes());
    counted(&mut content, text);
    record(out, 3, &content);
}

fn channel(out: &mut Vec<u8>, id: u16, schema: u16, topic: &str, encoding: &str) {
    let mut content = [id.to_le_bytes(), schema.to_le_bytes()].concat();
    counted(&mut content, topic.as_bytes());
    counted(&mut content, encoding.as_bytes());
    content.extend([0; 4]);
    record(out, 4, &content);
}

/// A file of one chunk, packed by LZ4.
fn packed(records: &[u8]) -> Vec<u8> {
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    encoder.write_all(records).unwrap();
    chunk("lz4", records.len() as u64, &encoder.finish().unwrap())
}

fn chunk(packing: &str, declared: u64, body: &[u8]) -> Vec<u8> {
    let mut content = [0; 16].to_vec();
    content.extend(declared.to_le_bytes());
    content.extend([0; 4]);
    counted(&mut content, packing.as_bytes());
    content.extend((body.len() as u64).to_le_bytes());
    content.extend(body);
    let mut file = MAGIC.to_vec();
    record(&mut file, 6, &content);
    file
}

/// Surveys the file within limits of memory.
fn survey(name: &str, bytes: &[u8]) -> Survey {
    let folder = Folder::new(name);
    let path = folder.file("log", bytes);
    let (mut survey, begin) = (None, ThreadTime::now());
    let memory =
        allocation_counter::measure(|| survey = Some(Survey::read(&path, |_| ()).unwrap()));
    let (most, took) = (memory.bytes_max, begin.elapsed());
    println!(
        "{name}: file {} bytes, memory {most} bytes, {took:?}",
        bytes.len()
    );
    let limit = (64 * MIB + 2 * bytes.len()) as u64;
    assert!(most <= limit, "{name}: {most} bytes, more than {limit}");
    // A program compiled for tests, on a machine that does other things too.
    assert!(took < Duration::from_secs(5), "{name}: {took:?}");
    survey.unwrap()
}

#[test]
fn one_definition_under_many_channels_is_held_once() {
    let mut records = Vec::new();
    let text = "bool a\n".repeat(700);
    schema(&mut records, 1, "ros1msg", text.as_bytes());
    for id in 1..=8000 {
        channel(&mut records, id, 1, &format!("/{id}"), "ros1");
        message(&mut records, id, 1, &[1; 700]);
        message(&mut records, id, 2, &[1; 700]);
    }
    let found = survey("channels", &packed(&records));
    assert_eq!(found.topics.len(), 8000);
    assert!(
        found
            .topics
            .iter()
            .all(|topic| topic.messages == 2 && topic.undecoded == 0)
    );
}

#[test]
fn more_channels_than_the_limit_are_reported() {
    let mut records = Vec::new();
    for id in 1..=u16::MAX {
        channel(&mut records, id, 0, &format!("/{id}"), "json");
    }
    let found = survey("many-channels", &packed(&records));
    assert!(found.damage_count > 0 && found.damages[0].what.contains("limit"));
}

#[test]
fn many_great_definitions_and_names_are_reported() {
    let mut records = Vec::new();
    let text = vec![b'#'; MIB];
    for id in 1..40 {
        schema(&mut records, id, "ros1msg", &text[id.into()..]);
    }
    let found = survey("definitions", &packed(&records));
    assert!(found.damages[0].what.contains("limit"), "{found:?}");
    let mut records = Vec::new();
    for id in 1..40 {
        channel(&mut records, id, 0, &"t".repeat(MIB), "json");
    }
    let found = survey("names", &packed(&records));
    assert!(found.damages[0].what.contains("limit"), "{found:?}");
}

/// All definitions and names of a file together have at most 4 MiB, however many there are and wherever they stand.
#[test]
fn definitions_and_names_share_one_limit() {
    const LIMIT: usize = 4 * MIB;
    let refused = "more than the limit of 4194304";
    // definitions of 64 KiB, names of 1 KiB (the greatest of a name): what a schema's name takes counts too
    let text = vec![b'#'; 64 << 10];
    let cases = [
        (LIMIT / text.len() - 1, 60, true),
        (LIMIT / text.len(), 1, false),
        (0, LIMIT / 1024 - 1, true),
        (0, LIMIT / 1024 + 1, false),
        (LIMIT / text.len() / 2, LIMIT / 2048 + 1, false),
    ];
    for (definitions, names, fits) in cases {
        let mut records = Vec::new();
        for id in 0..definitions {
            let mut one = text.clone();
            one[..8].copy_from_slice(format!("#{id:07}").as_bytes());
            schema(
                &mut records,
                u16::try_from(id + 1).unwrap(),
                "ros1msg",
                &one,
            );
        }
        for id in 0..names {
            let topic = format!("/{id:0>1019}");
            let id = u16::try_from(id + 1).unwrap();
            channel(&mut records, id, 0, &topic, "json");
            message(&mut records, id, 1, b"1");
        }
        let found = survey("shared", &packed(&records));
        let reported = found
            .damages
            .iter()
            .any(|damage| damage.what.contains(refused));
        assert_eq!(
            reported,
            !fits,
            "{definitions} {names}: {:?}",
            found.damages.first()
        );
        if fits {
            assert_eq!(found.topics.len(), names);
        } else {
            assert!(found.topics.len() < names);
        }
    }
}

#[test]
fn a_message_of_many_small_values_is_not_unfolded() {
    let mut records = Vec::new();
    let text = format!("C[] c\n===\nMSG: a/C\n{}", "bool b\n".repeat(4000));
    schema(&mut records, 1, "ros1msg", text.as_bytes());
    channel(&mut records, 1, 1, "/t", "ros1");
    let count = 15 * MIB / 4000;
    let mut data = u32::try_from(count).unwrap().to_le_bytes().to_vec();
    data.resize(4 + count * 4000, 1);
    message(&mut records, 1, 1, &data);
    let found = survey("values", &packed(&records));
    assert_eq!(
        (found.topics[0].messages, found.topics[0].undecoded),
        (1, 1)
    );
}

#[test]
fn json_of_many_small_values_is_not_unfolded() {
    for (name, one) in [("json-numbers", "0,"), ("json-objects", "{\"\":0},")] {
        let mut records = Vec::new();
        channel(&mut records, 1, 0, "/t", "json");
        let data = format!("[{}0]", one.repeat(15 * MIB / one.len()));
        message(&mut records, 1, 1, data.as_bytes());
        let found = survey(name, &packed(&records));
        assert_eq!(
            (found.topics[0].messages, found.topics[0].undecoded),
            (1, 1)
        );
    }
}

#[test]
fn json_of_half_a_mebibyte_is_decoded_within_the_memory() {
    let mut records = Vec::new();
    channel(&mut records, 1, 0, "/t", "json");
    let data = format!("[{}0]", "{\"\":0},".repeat(MIB / 2 / 7 - 1));
    message(&mut records, 1, 1, data.as_bytes());
    let found = survey("json-half", &packed(&records));
    assert_eq!(
        found.topics[0].undecoded, 0,
        "{:?}",
        found.topics[0].problem
    );
}

#[test]
fn the_greatest_chunk_and_the_greatest_message_fit() {
    let mut records = Vec::new();
    schema(&mut records, 1, "ros1msg", b"uint8[] d");
    channel(&mut records, 1, 1, "/t", "ros1");
    let body = u32::try_from(15 * MIB).unwrap();
    let mut data = body.to_le_bytes().to_vec();
    data.resize(4 + 15 * MIB, 7);
    message(&mut records, 1, 1, &data);
    let found = survey("great", &packed(&records));
    assert_eq!(
        (found.topics[0].messages, found.topics[0].undecoded),
        (1, 0)
    );
}

#[test]
fn a_window_that_zstd_declares_is_not_believed() {
    for exponent in 0..=31_u8 {
        // The frame's header, then one block that repeats a zero 128 KiB times.
        let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0, exponent << 3];
        frame.extend([3, 0, 0x10, 0]);
        survey("window", &chunk("zstd", 131_072, &frame));
    }
    // A frame of one segment, as great as a chunk may be: zeros are records of no kind and no length.
    let blocks = 16 * MIB / 131_072;
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0xe0];
    frame.extend((16 * MIB as u64).to_le_bytes());
    for block in 1..=blocks {
        frame.extend([2 | u8::from(block == blocks), 0, 0x10, 0]);
    }
    let found = survey("zeros", &chunk("zstd", 16 * MIB as u64, &frame));
    assert!(!found.damages[0].what.contains("decompressed"), "{found:?}");
    // The same many times.
    let one = chunk("zstd", 16 * MIB as u64, &frame);
    let mut file = MAGIC.to_vec();
    while file.len() < MIB / 4 {
        file.extend(&one[MAGIC.len()..]);
    }
    let found = survey("many-zeros", &file);
    let reported = found
        .damages
        .iter()
        .any(|damage| damage.what.contains("limit"));
    assert!(reported, "{found:?}");
    // A frame of one segment that declares a content of 2^40 bytes.
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0xe0];
    frame.extend((1_u64 << 40).to_le_bytes());
    frame.extend([3, 0, 0x10, 0]);
    survey("segment", &chunk("zstd", 131_072, &frame));
}

#[test]
fn times_at_the_end_of_the_clock_are_taken() {
    let mut records = Vec::new();
    channel(&mut records, 1, 0, "/t", "json");
    for time in [0, u64::MAX, u64::MAX - 1, 1 << 63, u64::MAX] {
        message(&mut records, 1, time, b"0");
    }
    let found = survey("times", &packed(&records));
    assert_eq!((found.topics[0].messages, found.topics[0].jumps), (5, 1));
}
