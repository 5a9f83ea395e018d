//! MCAP files and ROS 1 bags written from their specifications, with every place known.

pub(crate) mod bag;
pub(crate) mod mcap;

use std::io::{Cursor, Write as _};
use std::ops::Range;
use std::path::Path;

use grouser_log::Error;
use grouser_log::container::{Container, Damage, Event};

/// Topic, type, time of recording, bytes.
pub(crate) type Row = (String, String, u64, Vec<u8>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    None,
    Lz4,
    Zstd,
    Bz2,
}

impl Packing {
    /// By its name in MCAP and in bags.
    pub(crate) fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::None => ("", "none"),
            Self::Lz4 => ("lz4", "lz4"),
            Self::Zstd => ("zstd", "zstd"),
            Self::Bz2 => ("bz2", "bz2"),
        }
    }

    pub(crate) fn pack(self, content: &[u8]) -> Vec<u8> {
        match self {
            Self::None => content.to_vec(),
            Self::Lz4 => {
                let info = lz4_flex::frame::FrameInfo::new()
                    .block_size(lz4_flex::frame::BlockSize::Max64KB)
                    .block_mode(lz4_flex::frame::BlockMode::Independent)
                    .content_checksum(true);
                let mut encoder = lz4_flex::frame::FrameEncoder::with_frame_info(info, Vec::new());
                encoder.write_all(content).unwrap();
                encoder.finish().unwrap()
            }
            Self::Zstd => ruzstd::encoding::compress_to_vec(
                content,
                ruzstd::encoding::CompressionLevel::Fastest,
            ),
            Self::Bz2 => {
                let mut encoder =
                    bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
                encoder.write_all(content).unwrap();
                encoder.finish().unwrap()
            }
        }
    }

    /// How much of the content the first bytes of `packed` give, whole blocks only: by the heads of the blocks.
    pub(crate) fn readable(self, packed: &[u8], whole: usize) -> usize {
        let at = |at: usize, count: usize| {
            let bytes = packed.get(at..at + count)?;
            let number = |sum: u64, byte: &u8| (sum << 8) | u64::from(*byte);
            usize::try_from(bytes.iter().rev().fold(0, number)).ok()
        };
        match self {
            Self::None => packed.len().min(whole),
            // 100 kB at the least: the tests' chunks are one block.
            Self::Bz2 => 0,
            Self::Lz4 => {
                // Magic, flags, block size, header's checksum; then each block after its length.
                let (mut place, mut blocks) = (7, 0);
                while let Some(length) = at(place, 4).map(|length| length & 0x7fff_ffff) {
                    if length == 0 || place + 4 + length > packed.len() {
                        break;
                    }
                    place += 4 + length;
                    blocks += 1;
                }
                (blocks << 16).min(whole)
            }
            Self::Zstd => {
                let Some(descriptor) = at(4, 1) else { return 0 };
                let size = [usize::from(descriptor & 0x20 != 0), 2, 4, 8][descriptor >> 6];
                let mut place = 5 + usize::from(descriptor & 0x20 == 0) + size;
                let mut blocks = 0;
                while let Some(head) = at(place, 3) {
                    let length = if (head >> 1) & 3 == 1 { 1 } else { head >> 3 };
                    if place + 3 + length > packed.len() {
                        break;
                    }
                    place += 3 + length;
                    blocks += 1;
                }
                (blocks << 17).min(whole)
            }
        }
    }
}

/// Where one chunk stands, and what is in it.
pub(crate) struct ChunkAt {
    /// Its record.
    pub(crate) record: Range<usize>,
    /// Its packed content.
    pub(crate) packed: Range<usize>,
    /// The record with the indexes behind it.
    pub(crate) with_index: Range<usize>,
    /// Its messages among all.
    pub(crate) rows: Range<usize>,
    /// Where in its content each message ends.
    pub(crate) ends: Vec<usize>,
    pub(crate) content_bytes: usize,
}

/// A file, and what it says.
pub(crate) struct Written {
    pub(crate) bytes: Vec<u8>,
    pub(crate) rows: Vec<Row>,
    pub(crate) chunks: Vec<ChunkAt>,
    pub(crate) packing: Packing,
}

impl Written {
    /// How many messages a file that is cut there must still give, at the least and at the most.
    pub(crate) fn readable(&self, cut: usize) -> (usize, usize) {
        for chunk in &self.chunks {
            if chunk.record.end > cut {
                let begun = cut.saturating_sub(chunk.packed.start);
                let packed = &self.bytes[chunk.packed.start..chunk.packed.start + begun];
                let content = self.packing.readable(packed, chunk.content_bytes);
                let whole = chunk.ends.iter().filter(|end| **end <= content).count();
                let least = chunk.rows.start + whole;
                // Of bzip2 only the end of its stream can be missing.
                let open = self.packing == Packing::Bz2 && chunk.record.end - cut < 12;
                return (least, if open { chunk.rows.end } else { least });
            }
        }
        (self.rows.len(), self.rows.len())
    }
}

/// How great a file is to be.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    pub(crate) packing: Packing,
    /// Bytes of the file, about.
    pub(crate) bytes: usize,
    /// Bytes of a chunk's content, about.
    pub(crate) chunk: usize,
    /// Of each message's bytes this many repeat those of the one before.
    pub(crate) alike: usize,
}

/// The bytes of message `k`: numbers that do not repeat, and text that does.
pub(crate) fn body(k: usize, alike: usize) -> Vec<u8> {
    let mut state = k as u64 ^ 0x9e37_79b9_7f4a_7c15;
    let mut bytes: Vec<u8> = (0..24)
        .map(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(k as u64 | 1);
            state.to_be_bytes()[0]
        })
        .collect();
    bytes.extend(b"wheel_left wheel_right ".iter().cycle().take(alike));
    bytes
}

pub(crate) const TOPICS: [(&str, &str); 2] = [("/wheels", "a/Wheels"), ("/imu", "a/Imu")];

pub(crate) fn time_ns(k: usize) -> u64 {
    1_700_000_000_000_000_000 + 10_000_000 * k as u64
}

pub(crate) fn row(k: usize, alike: usize) -> Row {
    let (topic, type_name) = TOPICS[k % 2];
    (topic.into(), type_name.into(), time_ns(k), body(k, alike))
}

/// Every message, and every damage.
pub(crate) fn read(bytes: Vec<u8>) -> Result<(Vec<Row>, Vec<Damage>), Error> {
    let mut container = Container::over(Path::new("bytes"), Cursor::new(bytes))?;
    let (mut rows, mut damages) = (Vec::new(), Vec::new());
    while let Some(event) = container.next() {
        match event {
            Event::Message(message) => rows.push((
                message.of.topic.clone(),
                message.of.type_name.clone(),
                message.log_time_ns,
                message.data.to_vec(),
            )),
            Event::Damage(damage) => damages.push(damage),
        }
    }
    Ok((rows, damages))
}

/// Which of `count` cases are run: all with `GROUSER_DENSE=all` (`just dense`), else about one in `step`,
/// with an odd stride so that every byte and every bit of a byte has its turn.
pub(crate) fn cases(count: usize, step: usize) -> impl Iterator<Item = usize> {
    let all = std::env::var_os("GROUSER_DENSE").is_some_and(|value| value == "all");
    let step = if all { 1 } else { step | 1 };
    (0..count).step_by(step)
}

/// Times of the messages that are read, and each damage: where, how many bytes and messages, why.
pub(crate) type Found = (Vec<u64>, Vec<(usize, usize, Option<u64>, String)>);

pub(crate) fn found(bytes: &[u8]) -> Found {
    let (rows, damages) = read(bytes.to_vec()).unwrap();
    let damages = damages.into_iter().map(|damage| {
        let place = usize::try_from(damage.offset).unwrap();
        let bytes = usize::try_from(damage.bytes).unwrap();
        (place, bytes, damage.messages, damage.what)
    });
    (rows.iter().map(|row| row.2).collect(), damages.collect())
}
