//! Logs written by code that is not ours (`interop/write.py`), whole and broken.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use grouser_log::Error;
use grouser_log::container::{Container, Damage, Event};
use grouser_log::message::{Decoder, View};

use crate::scratch::Folder;

const COUNT: usize = 40;
const FILES: [&str; 6] = [
    "joints_none.mcap",
    "joints_lz4.mcap",
    "joints_zstd.mcap",
    "joints_none.bag",
    "joints_bz2.bag",
    "joints_lz4.bag",
];

type Row = (u64, Vec<u8>);

/// A file that others wrote, as it ships.
pub(crate) fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/interop")
        .join(name)
}

/// Every message with its time, and every damage.
fn read(path: &Path) -> Result<(Vec<Row>, Vec<Damage>), Error> {
    Container::open(path).map(read_over)
}

/// The same of bytes in memory.
fn read_bytes(bytes: Vec<u8>) -> Result<(Vec<Row>, Vec<Damage>), Error> {
    Container::over(Path::new("bytes"), Cursor::new(bytes)).map(read_over)
}

fn read_over(mut container: Container) -> (Vec<Row>, Vec<Damage>) {
    let (mut rows, mut damages) = (Vec::new(), Vec::new());
    while let Some(event) = container.next() {
        match event {
            Event::Message(message) => rows.push((message.log_time_ns, message.data.to_vec())),
            Event::Damage(damage) => damages.push(damage),
        }
    }
    (rows, damages)
}

#[test]
fn values_of_python_writers_are_equal_to_the_bit() {
    for name in FILES {
        let mut container = Container::open(&shipped(name)).unwrap();
        let mut count = 0_usize;
        let mut decoder = None;
        loop {
            if decoder.is_none()
                && let Some(channel) = container.channels().first()
            {
                assert_eq!(channel.topic, "/joint_states", "{name}");
                decoder = Some(Decoder::new(channel).unwrap());
            }
            let (data, time) = match container.next() {
                None => break,
                Some(Event::Damage(damage)) => panic!("{name}: {damage:?}"),
                Some(Event::Message(message)) => (message.data.to_vec(), message.log_time_ns),
            };
            let channel = &container.channels()[0];
            let decoder = decoder.get_or_insert_with(|| Decoder::new(channel).unwrap());
            let value = decoder.decode(&data).unwrap();
            let k = count as f64;
            let stamp = 1_700_000_000_000_000_000 + 20_000_000 * count as u64;
            assert_eq!(time, stamp, "{name}");
            assert_eq!(
                value.at("header.stamp").unwrap().time_ns(),
                i64::try_from(stamp).ok()
            );
            assert_eq!(value.at("header.frame_id").unwrap().text(), Some("base"));
            let Some(View::JointState(joints)) = View::new("sensor_msgs/msg/JointState", &value)
            else {
                panic!("{name}: {value:?}")
            };
            assert!(joints.names.iter().eq(["left", "right"]), "{name}");
            let position = [k.sqrt(), -1.0 / (k + 1.0)];
            assert!(joints.position.iter().eq(position), "{name}");
            assert!(joints.velocity.iter().eq([0.1 * k]), "{name}");
            assert!(joints.effort.is_empty(), "{name}");
            count += 1;
        }
        assert_eq!(count, COUNT, "{name}");
    }
}

#[test]
fn a_cut_at_every_17th_byte_loses_only_what_is_behind_it() {
    for name in FILES {
        let bytes = std::fs::read(shipped(name)).unwrap();
        let (whole, _) = read(&shipped(name)).unwrap();
        let mut before = 0;
        for cut in (16..bytes.len()).step_by(17) {
            let (rows, damages) = read_bytes(bytes[..cut].to_vec()).unwrap();
            assert_eq!(rows, whole[..rows.len()], "{name} cut at {cut}");
            assert!(
                rows.len() == COUNT || !damages.is_empty(),
                "{name} cut at {cut}: silent"
            );
            assert!(
                damages.iter().all(|d| d.offset + d.bytes <= cut as u64),
                "{name} cut at {cut}: {damages:?}"
            );
            assert!(
                rows.len() >= before,
                "{name}: {cut} bytes give less than fewer do"
            );
            before = rows.len();
        }
        assert_eq!(before, COUNT, "{name}");
    }
}

/// Most messages in a chunk of these files (their message indexes say 6, 9, 9, 9 and 7).
const LARGEST_CHUNK: usize = 9;

#[test]
fn every_5th_bit_flipped_gives_the_same_data_or_is_reported() {
    for name in &FILES[..3] {
        let bytes = std::fs::read(shipped(name)).unwrap();
        let (whole, _) = read(&shipped(name)).unwrap();
        let length = |at: usize| usize::from(u16::from_le_bytes([bytes[at + 1], bytes[at + 2]]));
        let first = 8 + 9 + length(8);
        assert_eq!(bytes[first], 6, "a chunk");
        let first_end = first + 9 + length(first);
        for bit in (0..bytes.len() * 8).step_by(5) {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let Ok((rows, damages)) = read_bytes(flipped) else {
                continue;
            };
            assert!(
                rows == whole || !damages.is_empty(),
                "{name}: bit {bit} changes data and nothing is reported"
            );
            // The first chunk declares the channel: without it no message has a meaning. A flip in a chunk's
            // declared length may take the chunk behind it along.
            let lost = COUNT.saturating_sub(rows.len());
            assert!(
                bit / 8 < first_end || lost <= 2 * LARGEST_CHUNK,
                "{name}: bit {bit} loses {lost}: {damages:?}"
            );
        }
    }
}

#[test]
fn every_97th_bit_of_a_bag_flipped_ends_without_panic() {
    for name in &FILES[3..] {
        let bytes = std::fs::read(shipped(name)).unwrap();
        for bit in (0..bytes.len() * 8).step_by(97) {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            // A bag has no checksums: what is read may differ, but no more is read than was written.
            if let Ok((rows, _)) = read_bytes(flipped) {
                assert!(rows.len() <= COUNT, "{name}: bit {bit}");
            }
        }
    }
}

#[test]
fn a_declared_length_is_not_believed() {
    let folder = Folder::new("lies");
    let mut bytes = b"\x89MCAP0\r\n".to_vec();
    bytes.push(5);
    bytes.extend(u64::MAX.to_le_bytes());
    bytes.extend([0; 64]);
    let path = folder.file("lies", &bytes);
    let memory = allocation_counter::measure(|| {
        let (rows, damages) = read(&path).unwrap();
        assert!(rows.is_empty() && damages[0].offset == 8, "{damages:?}");
    });
    assert!(memory.bytes_max < 1 << 20, "{} bytes", memory.bytes_max);
}

#[test]
fn files_behind_each_other_are_both_read() {
    let folder = Folder::new("twice");
    for name in FILES {
        let bytes = std::fs::read(shipped(name)).unwrap();
        let (rows, _) = read(&folder.file("twice", &bytes.repeat(2))).unwrap();
        assert_eq!(rows.len(), 2 * COUNT, "{name}");
    }
}

#[test]
fn another_version_is_refused_by_number() {
    let folder = Folder::new("version");
    for (bytes, number) in [
        (&b"\x89MCAP1\r\n...."[..], "1"),
        (b"#ROSBAG V1.2\n....", "1.2"),
    ] {
        let refused = read(&folder.file("v", bytes)).unwrap_err();
        assert!(
            matches!(&refused, Error::Version { found, .. } if found == number),
            "{refused}"
        );
    }
}
