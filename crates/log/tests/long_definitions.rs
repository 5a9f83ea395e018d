//! Definitions as long as a file may declare them: read in time and memory that their length bounds.

use std::fmt::Write as _;
use std::io::Cursor;
use std::sync::Arc;
use std::time::Duration;

use grouser_log::container::{Channel, Encoding};
use grouser_log::message::Definition;
use grouser_log::write::{McapWriter, Times};
use grouser_log::{Clock, LeftOut, Messages};

use crate::processor_time::ThreadTime;

/// 4 MiB of types that name each other, the last one first.
fn long() -> String {
    let types = 4000;
    let mut text = String::new();
    for k in 0..types {
        let _ = writeln!(text, "===\nMSG: p/T{k}");
        while k + 1 < types && text.len() < (k + 1) * 1040 {
            let _ = writeln!(text, "p/T{} a", types - 1);
        }
        if k + 1 == types {
            text.push_str("bool a\n");
        }
    }
    text
}

#[test]
fn a_long_definition_takes_neither_long_nor_much() {
    let text = long();
    assert!(text.len() < 4 << 20 && text.len() > 4_000_000);
    let start = ThreadTime::now();
    let used = allocation_counter::measure(|| {
        let _ = Definition::parse("p/M", &text);
    });
    assert!(
        start.elapsed() < Duration::from_secs(1),
        "{:?}",
        start.elapsed()
    );
    assert!(used.bytes_max < 16 << 20, "{}", used.bytes_max);
}

#[test]
fn channels_of_one_definition_share_its_decoder() {
    let text = format!("bool a\n{}", "# nothing to read\n".repeat(30_000));
    let definition: Arc<[u8]> = text.into_bytes().into();
    let mut writer = McapWriter::new(Cursor::new(Vec::new()), "ros2").unwrap();
    for k in 0..2000_u64 {
        let channel = writer.channel(&Channel {
            topic: format!("/t{k}"),
            type_name: "p/msg/M".into(),
            encoding: Encoding::Cdr,
            encoding_name: "cdr".into(),
            definition_language: "ros2msg".into(),
            definition: Arc::clone(&definition),
            metadata: std::collections::BTreeMap::new(),
        });
        let data = [0, 1, 0, 0, 1];
        writer
            .message(channel.unwrap(), Times::at(k), &data)
            .unwrap();
    }
    let file = std::env::temp_dir().join(format!("grouser-long-{}.mcap", std::process::id()));
    std::fs::write(&file, writer.finish().unwrap().into_inner()).unwrap();
    let start = ThreadTime::now();
    let mut messages = Messages::open(&file, Clock::Header, |_| true).unwrap();
    assert_eq!(messages.by_ref().count(), 2000);
    assert_eq!(messages.left_out(), &LeftOut::default());
    // Read for each channel it would be a gigabyte of text.
    let took = start.elapsed();
    std::fs::remove_file(&file).unwrap();
    assert!(took < Duration::from_secs(2), "{took:?}");
}
