//! The readers side by side: each counts messages and sums what none may leave out.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use grouser_log::container::{Container, Event};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// What a reader found.
#[derive(Debug, PartialEq, Eq)]
pub struct Found {
    pub messages: u64,
    pub bytes: u64,
    pub times: u64,
    pub ends: u64,
}

impl Found {
    const NOTHING: Self = Self { messages: 0, bytes: 0, times: 0, ends: 0 };

    fn add(&mut self, time: u64, data: &[u8]) {
        self.messages += 1;
        self.bytes += data.len() as u64;
        self.times = self.times.wrapping_add(time);
        let ends = u64::from(data[0]) + u64::from(data[data.len() - 1]);
        self.ends = self.ends.wrapping_mul(31).wrapping_add(ends);
    }
}

pub fn ours(path: &Path) -> Found {
    let mut found = Found::NOTHING;
    let mut container = Container::open(path).expect("a log");
    while let Some(event) = container.next() {
        match event {
            Event::Message(message) => found.add(message.log_time_ns, message.data),
            Event::Damage(damage) => panic!("{damage:?}"),
        }
    }
    found
}

pub fn messages(path: &Path) -> Found {
    let mut found = Found::NOTHING;
    let file = BufReader::new(File::open(path).expect("a file"));
    for message in mcap::io::MessageReader::new(file) {
        let message = message.expect("a message");
        found.add(message.log_time, &message.data);
    }
    found
}

pub fn linear(path: &Path) -> Found {
    by_linear_reader(path, LinearReaderOptions::default())
}

pub fn linear_checked(path: &Path) -> Found {
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_validate_data_section_crc(true);
    by_linear_reader(path, options)
}

fn by_linear_reader(path: &Path, options: LinearReaderOptions) -> Found {
    let mut found = Found::NOTHING;
    let mut file = File::open(path).expect("a file");
    let mut reader = LinearReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.expect("a record") {
            LinearReadEvent::ReadRequest(count) => {
                let count = file.read(reader.insert(count)).expect("read");
                reader.notify_read(count);
            }
            LinearReadEvent::Record { data, opcode } => {
                if opcode == mcap::records::op::MESSAGE {
                    let time = data[6..14].try_into().expect("eight bytes");
                    found.add(u64::from_le_bytes(time), &data[22..]);
                }
            }
        }
    }
    found
}
